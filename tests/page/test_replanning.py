"""Replanning on the page: what changes on the way, and the tours before and after."""

from playwright.sync_api import Page, expect

from tests.helpers.accessibility import unfold
from tests.helpers.browsing import (
    copied,
    curl_body,
    needs_chromium,
    open_files,
    open_link,
    wait_until_planned,
)

pytestmark = needs_chromium


def test_the_rest_of_a_tour_is_planned_from_the_vehicle_with_other_stops(
    page: Page, other: Page
) -> None:
    page.locator("#order > summary").click()
    *before, back = order(page)
    assert back == before[0]
    page.get_by_text("Replan on the way").click()
    page.get_by_label("Visited up to").fill(before[2])
    page.get_by_label("Stops to drop").fill(before[10])
    page.get_by_label("Name of a new stop").fill("school")
    click_on_both_maps(page, "Click where the new stop is", (150, 120))
    click_on_both_maps(page, "Click where the vehicle is", (170, 150))
    expect(page.locator("#replan-help")).to_contain_text("school at")
    page.get_by_role("button", name="Replan").click()
    expect(page.locator("#choice")).to_contain_text("% of the stops still to visit come after")
    expect(page.locator("#choice")).to_be_in_viewport(ratio=1)
    expect(page.locator("#choice")).to_contain_text("less risk")  # objectives keep their names
    expect(page.locator("#legend .before")).to_be_visible()
    expect(page.locator("#plane-1 canvas.pinned")).to_be_visible()
    after = order(page)
    assert after[0] == "vehicle"
    assert after[-1] == before[0]
    assert sorted([*after[1:-1], *before[1:3], before[10]]) == sorted([*before[1:], "school"])
    assert order_of_link(other, copied(page, "link")) == after
    page.get_by_label("Stops to drop").fill(before[10])
    page.get_by_role("button", name="Replan").click()
    expect(page.locator("#replan-fault")).to_contain_text("no stop")
    assert order(page) == after
    page.get_by_label("Stops to drop").fill("school")
    page.get_by_role("button", name="Replan").click()
    expect(page.locator("#order li", has_text="school")).to_have_count(0)
    assert sorted(order(page)) == sorted(set(after) - {"school"})


def test_only_stops_of_which_costs_are_measured_can_be_added_on_the_way(page: Page) -> None:
    open_files(page, {"costs.json": '{"matrices": [[[0, 1], [1, 0]], [[0, 2], [2, 0]]]}'})
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    assert "matrices" in curl_body(page)
    page.get_by_text("Replan on the way").click()
    expect(page.get_by_label("Visited up to")).to_be_visible()
    expect(page.get_by_role("button", name="Click where the vehicle is")).to_be_hidden()


def order_of_link(other: Page, link: str) -> list[str]:
    open_link(other, link)
    unfold(other)
    expect(other.locator("#choice")).to_contain_text("less risk")
    return order(other)


def order(page: Page) -> list[str]:
    """Return the stops of the selected tour by name, which are written once their list is open."""
    stops = page.locator("#order li")
    expect(stops.nth(1)).to_be_visible()
    return stops.all_inner_texts()


def click_on_both_maps(page: Page, name: str, place: tuple[float, float]) -> None:
    page.get_by_role("button", name=name).click()
    for plane in ("#plane-1", "#plane-2"):
        page.locator(plane).click(position={"x": place[0], "y": place[1]})
