"""The page, used as people use it: in Debian's Chromium, against the service as it is shipped."""

import json
import re
import time

import httpx
import pytest
from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.helpers.browsing import (
    DESK,
    PHONE,
    curl_body,
    metres,
    needs_chromium,
    number_in,
    open_files,
    open_page,
    saved,
    shown_front,
    stops_as_text,
    tours_of_front,
    wait_for_next_frame,
    wait_until_planned,
)

CITIES = "0, 0, 5, 5\n3.1, 0.4, 9, 1\n5.2, 2, 2, 8\n4, 5.5, 7, 7\n1, 4.2, 1, 2\n2.5, 2.5, 6, 0"

pytestmark = needs_chromium


@pytest.mark.parametrize("width", [DESK, PHONE])
def test_the_page_opens_with_stops_by_road_and_their_front(
    browser: Browser, released: str, width: int
) -> None:
    with open_page(browser, released, width) as page:
        wait_until_planned(page)
        expect(page.locator("#count")).to_have_text("60 stops")
        expect(page.locator("#about", has_text="OpenStreetMap contributors (ODbL)")).to_be_visible()
        expect(row(page, "People passed")).to_be_visible()
        first, second = page.locator(".plane").all()
        expect(first).to_be_visible()
        expect(second).to_be_hidden()
        check_that_a_phone_has_the_result_above_the_form(page, width)
        body = curl_body(page)
        assert body["stops"][0]["id"] == "depot"


def check_that_a_phone_has_the_result_above_the_form(page: Page, width: int) -> None:
    result = page.locator("#result").bounding_box()
    form = page.locator("#request").bounding_box()
    assert result is not None
    assert form is not None
    assert (result["y"] + result["height"] <= form["y"]) == (width == PHONE)
    expect(page.locator("#waiting")).to_be_visible(visible=width == PHONE)


def test_an_example_shows_its_front(planned: Page) -> None:
    shown = planned.get_by_label(re.compile(r"A choice of \d+ tours: distance from"))
    expect(shown).to_be_visible()
    expect(planned.locator("#figures")).to_contain_text("Network alone")


def test_a_front_that_is_done_before_its_stream_says_so_is_shown(page: Page) -> None:
    def answer_once_done(route: Route) -> None:
        front = route.request.url.removesuffix("/events")
        while httpx.get(front).json()["status"] != "done":
            time.sleep(0.1)
        time.sleep(0.5)  # longer than the page waits from one look at the front to the next
        progress = {"status": "running", "hypervolume": 0.5, "seconds": 0.1}
        body = f"event: progress\ndata: {json.dumps(progress)}\n\n"
        route.fulfill(content_type="text/event-stream", body=body)

    page.route("**/front/*/events", answer_once_done)
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).not_to_contain_text("Done")
    wait_until_planned(page)
    expect(page.locator("#figures")).to_contain_text("found")


def test_the_slider_and_the_chart_select_the_tour_that_is_shown(page: Page) -> None:
    slider = page.get_by_role("slider", name="Balance")
    slider.press("Home")
    shortest = figure(page, "Distance")
    slider.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile(r"tour (\d+) of \1:"))
    assert figure(page, "Distance") > shortest
    count = tours_of_front(page)
    slider.press("ArrowLeft")
    expect(slider).to_have_attribute("aria-valuetext", re.compile(f"tour {count - 1} of {count}"))
    wait_for_next_frame(page)
    marker = page.locator("#front-chart .marker.selected").bounding_box()
    slider.press("Home")
    page.mouse.click(marker["x"] + marker["width"] / 2, marker["y"] + marker["height"] / 2)
    expect(slider).to_have_attribute("aria-valuetext", re.compile(f"tour {count - 1} of {count}"))


def test_the_slider_stands_at_the_balance_of_the_selected_tour(window: Page) -> None:
    rows = "id,lon,lat,x,y\na,24.941,60.171,0,1\nb,24.952,60.169,5,2\nc,24.933,60.165,2,9\n"
    open_files(window, {"stops.csv": f"{rows}d,24.925,60.18,8,8\ne,24.96,60.175,3,3\n"})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    assert [tour["balance"] for tour in shown_front(window)["front"]] == [0, 1]
    slider = window.get_by_role("slider", name="Balance")
    assert slider.input_value() == "0"
    window.get_by_role("button", name="least second length").click()
    assert slider.input_value() == "1"


def test_the_page_says_what_a_tour_gives_up_and_what_it_gains(planned: Page) -> None:
    front = [item["lengths"] for item in shown_front(planned)["front"]]
    slider, choice = planned.get_by_role("slider", name="Balance"), planned.locator("#choice")
    slider.press("Home")
    expect(choice).to_contain_text("The least distance.")
    (shortest, most), (longest, least) = front[0], front[-1]
    slider.press("End")
    cost, gain = (f"{100 * share:.0f}" for share in (longest / shortest - 1, 1 - least / most))
    expect(choice).to_have_text(
        re.compile(f"^{cost} % more distance .* than the least, for {gain} % less risk: the least")
    )


def test_a_name_on_the_chart_previews_its_tour_and_selects_it(planned: Page) -> None:
    slider, drawn = (
        planned.get_by_role("slider", name="Balance"),
        planned.locator("canvas.selected"),
    )
    slider.press("End")
    wait_for_next_frame(planned)
    last = drawn.first.evaluate("canvas => canvas.toDataURL()")
    name = planned.get_by_role("button", name="least distance")
    name.focus()
    expect(planned.locator("#choice")).to_contain_text("The least distance.")
    expect(planned.locator("#front-chart .marker.previewed")).to_be_visible()
    assert drawn.first.evaluate("canvas => canvas.toDataURL()") != last
    planned.get_by_label("Seconds of planning").focus()
    expect(planned.locator("#choice")).to_contain_text("the least of all tours found")
    wait_for_next_frame(planned)
    assert drawn.first.evaluate("canvas => canvas.toDataURL()") == last
    planned.get_by_role("button", name="compromise").click()
    knee = httpx.get(
        f"{planned.url.partition('#')[0]}tour",
        params={"knee": "", "front": shown_front(planned)["id"]},
    )
    place = f"distance {metres(knee.json()['lengths'][0])}"
    expect(slider).to_have_attribute("aria-valuetext", re.compile(place))
    wait_for_next_frame(planned)
    marker = planned.locator("#front-chart .marker.selected").bounding_box()
    label = planned.get_by_role("button", name="compromise").bounding_box()
    # Its name stands on one side of its point.
    middle = marker["x"] + marker["width"] / 2
    assert min(abs(label["x"] + label["width"] - middle), abs(label["x"] - middle)) < 10
    slider.press("Home")
    planned.mouse.move(marker["x"] + marker["width"] / 2, marker["y"] + marker["height"] / 2)
    expect(planned.locator("#choice")).to_contain_text("more distance")
    planned.mouse.move(0, 0)
    expect(planned.locator("#choice")).to_contain_text("The least distance.")


def test_a_pinned_tour_stays_beside_the_selected_one(planned: Page) -> None:
    slider = planned.get_by_role("slider", name="Balance")
    slider.press("Home")
    wait_for_next_frame(planned)
    planned.get_by_role("button", name="Keep to compare").click()
    slider.press("End")
    wait_for_next_frame(planned)
    selected, pinned, difference = row(planned, "Risk").get_by_role("cell").all()
    assert number(selected) < number(pinned)
    expect(difference).to_contain_text("\N{MINUS SIGN}")
    planned.get_by_role("button", name="Stop comparing").click()
    expect(row(planned, "Risk").get_by_role("cell")).to_have_count(1)


def test_what_was_found_stays_when_the_search_is_stopped(page: Page) -> None:
    page.get_by_label("Seconds of planning").fill("50")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).to_contain_text("improving")
    page.get_by_role("button", name="Stop", exact=True).click()
    expect(page.locator("#status")).to_contain_text("Stopped: ")
    expect(page.get_by_label(re.compile("A choice of [0-9]+ tours"))).to_be_visible()
    expect(page.get_by_role("button", name="Plan", exact=True)).to_be_enabled()


def test_the_search_is_stopped_before_the_service_has_taken_it(page: Page) -> None:
    def hold(route: Route) -> None:
        if "prefer" not in route.request.headers:
            route.continue_()

    page.route("**/front", hold)
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).to_contain_text("improving")
    page.get_by_role("button", name="Stop", exact=True).click()
    expect(page.locator("#status")).to_contain_text("Stopped: ")
    expect(page.get_by_role("button", name="Plan", exact=True)).to_be_enabled()


def test_open_routes_lead_from_the_start_to_the_end(page: Page) -> None:
    page.get_by_label("End elsewhere").fill("8")
    page.get_by_label("Seconds of planning").fill("0.2")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).to_contain_text("Done")
    body = curl_body(page)
    assert (body["closed"], body["start"], body["end"]) == (False, 0, 7)
    page.locator("#order > summary").click()
    expect(page.locator("#order li").first).to_have_text("1")
    expect(page.locator("#order li").last).to_have_text("8")
    page.get_by_label("End elsewhere").fill("")
    assert "closed" not in curl_body(page)
    page.get_by_label("Open route").check()
    page.get_by_label("Start", exact=True).fill("")
    assert curl_body(page)["start"] is None


def test_what_the_service_refuses_is_said_at_the_field(page: Page) -> None:
    page.get_by_label("Seconds of planning").fill("soon")
    page.get_by_role("button", name="Plan", exact=True).click()
    fault = page.locator("#time_limit-fault")
    expect(fault).to_have_text('Seconds of planning must be a valid number, got "soon".')
    expect(page.get_by_label("Seconds of planning")).to_be_focused()
    expect(page.locator("#waiting")).to_have_text(fault.inner_text())
    stops_as_text(page).fill("1, 2, 3, 4\n1, 2, 3\n")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#cities-fault")).to_contain_text("Stop 2 must have 4 items")


def test_refusals_count_stops_as_people_do(page: Page) -> None:
    for name, label, typed, said in (
        ("end", "End elsewhere", "99", "End elsewhere must be a stop, 1 to 61, got 99."),
        ("end", "End elsewhere", "1", "End elsewhere must not be the start"),
        ("end", "End elsewhere", "shop", "End elsewhere must be the number of a stop"),
        ("start", "Start", "62", "Start must be a stop, 1 to 61, got 62."),
    ):
        field = page.get_by_label(label, exact=True)
        before = field.input_value()
        field.fill(typed)
        page.get_by_role("button", name="Plan", exact=True).click()
        expect(page.locator(f"#{name}-fault")).to_contain_text(said)
        field.fill(before)


def test_a_plan_of_no_stops_is_refused_in_words_of_the_page(page: Page) -> None:
    page.get_by_role("button", name="Clear").click()
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#cities-fault")).to_contain_text("There must be a stop: open a file")


def test_cities_are_clicked_into_place_plane_by_plane(page: Page) -> None:
    page.get_by_role("button", name="Clear").click()
    page.get_by_role("button", name="Add on the map").click()
    for x, y in [(100, 160), (190, 130), (130, 90)]:
        page.locator("#plane-1").click(position={"x": x, "y": y})
        page.locator("#plane-2").click(position={"x": y, "y": x})
    expect(page.locator("#count")).to_have_text("3 stops")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).to_have_text("Done: 1 tour found.")


def test_the_keyboard_is_enough(page: Page) -> None:
    stops_as_text(page).fill(CITIES)
    page.get_by_label("Seconds of planning").focus()
    page.keyboard.press("Control+a")
    page.keyboard.type("0.1")
    page.keyboard.press("Enter")
    expect(page.locator("#status")).to_contain_text("Done")
    slider = page.get_by_role("slider", name="Balance")
    for _ in range(20):
        if slider.evaluate("slider => slider === document.activeElement"):
            break
        page.keyboard.press("Tab")
    page.keyboard.press("End")
    expect(slider).to_have_attribute("aria-valuetext", re.compile("tour 5 of 5"))


def test_the_front_can_be_taken_along(planned: Page, released: str) -> None:
    answer = shown_front(planned)
    assert answer == httpx.get(f"{released}/front/{answer['id']}").json()
    head, *lines = saved(planned, "CSV").decode().splitlines()
    assert head == "angle,distance (m),risk (accidents per million drives),tour,selected"
    assert len(lines) == len(answer["front"])
    asked = curl_body(planned)
    found = httpx.post(f"{released}/front", json={**asked, "time_limit": 0}).json()
    assert found["cities"] == 61


def figure(page: Page, name: str) -> float:
    wait_for_next_frame(page)
    return number(row(page, name).get_by_role("cell").first)


def row(page: Page, name: str) -> Locator:
    """Return the row of a length beside the selected tour; the table of stops has others."""
    return page.locator("#comparison").get_by_role("row", name=name)


def number(cell: Locator) -> float:
    return number_in(cell.inner_text())
