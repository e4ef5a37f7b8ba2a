"""Links that the page copies: they open the same front in another window."""

import base64
import json
import re
import zlib
from typing import Any

import httpx
import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    copied,
    follow,
    needs_chromium,
    note_texts,
    noted_texts,
    open_files,
    open_link,
    open_page,
    plan_by_network_alone,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.node import Node
from tests.helpers.sampled import at_night, few

pytestmark = needs_chromium


def test_a_link_opens_the_same_front_with_its_cities(planned: Page, browser: Browser) -> None:
    link = copied(planned, "link")
    front = planned.locator("#front-chart").get_attribute("aria-label")
    with open_page(browser, link) as other:
        expect(other.locator("#count")).to_have_text("61 stops")
        expect(other.locator("#front-chart")).to_have_attribute("aria-label", front or "")
        other.get_by_text("Details", exact=True).click()
        expect(other.get_by_text("is drawn here while a search runs")).to_be_visible()
        other.goto(planned.url.partition("#")[0] + "#front=none")
        for told in ("#request-fault", "#waiting"):
            expect(other.locator(told)).to_contain_text("no longer has the result of this link")
        assert other.get_by_label("Example").evaluate("choice => choice.selectedIndex") == 0


def test_a_copy_button_says_for_a_moment_that_it_copied_however_often_it_is_pressed(
    planned: Page,
) -> None:
    button = planned.get_by_role("button", name="Copy link")
    expect(button).not_to_have_text("Copied")  # as it has for a moment after the test before
    label = button.inner_text()
    note_texts(button)
    assert copied(planned, "link") == copied(planned, "link")
    expect(button).to_have_text(label)
    assert set(noted_texts(button)) == {"Copied", label}


def test_a_link_to_a_front_of_an_example_names_the_example(window: Page, other: Page) -> None:
    window.get_by_label("Example").select_option("Helsinki deliveries")
    wait_until_planned(window)
    slider = window.get_by_role("slider", name="Balance")
    slider.press("Home")
    slider.press("ArrowRight")
    selected = slider.get_attribute("aria-valuetext") or ""
    link = copied(window, "link")
    assert link.endswith("&example=helsinki-deliveries.json")
    open_link(other, link)
    expect(other.locator("#count")).to_have_text("60 stops")
    expect(other.get_by_label("Example")).to_have_value("helsinki-deliveries.json")
    expect(other.locator("#plane-1 canvas.streets")).to_be_visible()
    expect(other.get_by_role("slider", name="Balance")).to_have_attribute(
        "aria-valuetext", selected
    )
    window.get_by_label("Seconds of planning").fill("0")
    copied(window, "link")
    expect(window).to_have_url(re.compile("&asked="))


def test_a_link_to_the_networks_front_calls_it_that(page: Page, other: Page) -> None:
    page.get_by_label("Seconds of planning").fill("0")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    open_link(other, copied(page, "link"))
    for shown in (page, other):
        expect(shown.locator("#legend .alone")).to_be_visible()
        expect(shown.locator("#legend .improved")).to_be_hidden()


def test_a_link_that_would_be_too_long_opens_the_front_without_its_maps(
    window: Page, other: Page
) -> None:
    matrices = np.random.default_rng(0).random((2, 60, 60)).tolist()
    open_files(window, {"costs.json": json.dumps({"matrices": matrices, "time_limit": 0})})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    link = copied(window, "link")
    expect(window.get_by_text("This link opens the result without its maps")).to_be_visible()
    assert len(link) < 1000
    open_link(other, link)
    expect(other.get_by_text("The link only names a result")).to_be_visible()
    expect(other.locator("#plane-1")).to_be_hidden()
    expect(other.get_by_label("A choice of")).to_be_visible()


SHORT = 2000  # characters of a link to a tour of 60 stops, at most
KEPT = "The service no longer keeps this result. This is the {} that was chosen"
rng = np.random.default_rng(5)


def stops(**members: Any) -> list[dict[str, Any]]:
    """Sixty stops in Helsinki, with further members of each but the first."""
    places = np.column_stack([24.9 + rng.random(60) / 10, 60.15 + rng.random(60) / 20]).round(5)
    return [
        {"id": f"order-{k}", "location": place, **(members if k else {})}
        for k, place in enumerate(places.tolist())
    ]


def under(count: int) -> list[dict[str, Any]]:
    """So many objectives: one measured on the earth, the others in a plane each."""
    planes = [(100 * rng.random((60, 2))).astype(int).tolist() for _ in range(count - 1)]
    further = [{"name": f"cost {k}", "coordinates": plane} for k, plane in enumerate(planes)]
    return [{"name": "way", "from": "great_circle"}, *further]


VANS = [{"id": "van", "count": 3, "capacity": [25], "start": "order-0", "end": "order-0"}]
REQUESTS = {
    "two": {"stops": stops(), "objectives": under(2), "time_limit": 0},
    "three": {"stops": stops(), "objectives": under(3), "time_limit": 0.1},
    "fleet": {
        "stops": stops(demand=[1]),
        "vehicles": VANS,
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "longest", "from": "great_circle", "over": "max"},
        ],
        "time_limit": 0,
    },
}


def select_another(page: Page) -> None:
    """Select a tour or plan that the page does not select by itself."""
    if page.locator("#several").is_visible():
        page.get_by_role("slider", name="Way", exact=True).press("Home")
    else:
        page.get_by_role("slider", name="Balance").press("Home")
    wait_for_next_frame(page)


def on_screen(page: Page) -> list[str]:
    """The selected tour or plan as the page shows it: its lengths and its stops in their order."""
    page.locator("#order").evaluate("details => details.open = true")
    wait_for_next_frame(page)
    lengths = page.locator("#comparison tbody:not(.measures) td:nth-child(2)").all_inner_texts()
    listed = "#order li" if page.locator("#order").is_visible() else "#fleet-stops > li"
    return [*lengths, *page.locator(listed).all_text_contents()]


def open_and_plan(page: Page, request: dict[str, Any]) -> None:
    open_files(page, {"request.json": json.dumps(request)})
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)


@pytest.mark.parametrize("name", few(2, ["fleet", "three", "two"]))
def test_a_link_keeps_the_tour_that_was_chosen(
    window: Page, other: Page, released: str, name: str
) -> None:
    open_and_plan(window, REQUESTS[name])
    before = on_screen(window)
    select_another(window)
    chosen = on_screen(window)
    assert chosen != before
    link = copied(window, "link")
    assert len(link) < SHORT
    open_link(other, link)
    assert on_screen(other) == chosen
    front = re.findall("front=([0-9a-f]+)", link)[0]
    assert httpx.delete(f"{released}/front/{front}").is_success
    noun = "plan" if name == "fleet" else "tour"
    follow(other, link)
    expect(other.locator("#choice")).to_contain_text(KEPT.format(noun))
    expect(other.locator("#status")).to_have_text(f"This is the {noun} of the link.")
    expect(other.locator("#count")).to_have_text("60 stops")
    assert on_screen(other) == chosen
    others = other.locator("#legend .alone")
    expect(others).to_have_count(1)
    assert others.is_visible() == (name != "three")
    expect(other.get_by_role("button", name="Save GeoJSON")).to_be_disabled()
    assert copied(other, "link") == link
    other.get_by_role("button", name="Plan again").click()
    wait_until_planned(other)
    expect(other.get_by_role("button", name="Plan again")).to_be_hidden()
    expect(other.locator("#choice")).not_to_contain_text("no longer keeps")


@pytest.mark.parametrize(
    "example",
    [pytest.param("warehouse-cleaning.json", marks=at_night), "warehouse-robots.json"],
)
def test_a_link_keeps_what_was_chosen_on_a_map(window: Page, other: Page, example: str) -> None:
    plan_by_network_alone(window, "coverage")
    window.get_by_label("Example").select_option(example)
    expect(window.locator("#brought")).to_contain_text("grid")
    wait_until_planned(window)
    window.unroute_all()
    select_another(window)
    chosen = on_screen(window)
    link = re.sub("front=[0-9a-f]+", "front=" + 32 * "0", copied(window, "link"))
    follow(other, link)
    expect(other.locator("#status")).to_have_text("This is the plan of the link.")
    expect(other.locator("#choice")).to_contain_text("The service no longer keeps this result.")
    assert on_screen(other) == chosen
    expect(other.locator("#grid")).to_be_visible()


ITEM = {"lengths": [1, 2], "balance": 0, "tour": [2, 0, 1]}
ROUTE = {"vehicle": "van", "stops": ["order-0", "order-1"], "lengths": [1, 1]}
PLAN = {"lengths": [1, 2], "balance": 0, "routes": [ROUTE]}
SOUND = {
    "two": {"kind": "front", "item": ITEM},
    "three": {"kind": "front", "item": {**ITEM, "lengths": [1, 2, 3], "losses": [0, 0, 1]}},
    "fleet": {"kind": "fleet", "item": PLAN},
}


@pytest.mark.parametrize(
    ("name", "kind", "item"),
    [
        ("two", "front", {**ITEM, "lengths": ["<b>", 2]}),
        ("two", "front", {**ITEM, "lengths": [1, 2, 3]}),
        ("two", "front", {**ITEM, "tour": [0, 60]}),  # there are 60 stops
        ("two", "front", {**ITEM, "tour": {"length": 3}}),
        ("two", "front", {**ITEM, "angle": "up"}),
        ("two", "front", {**ITEM, "balance": None}),
        ("two", "front", {**ITEM, "times": "late"}),
        ("two", "fleet", ITEM),
        ("two", "coverage", ITEM),
        ("two", "toString", ITEM),
        ("two", "front", None),
        ("three", "front", {**ITEM, "lengths": [1, 2, 3]}),  # without losses
        ("fleet", "fleet", {**PLAN, "routes": [{**ROUTE, "stops": ["nowhere"]}]}),
        ("fleet", "fleet", {**PLAN, "routes": [{**ROUTE, "arrivals": ["soon", 1]}]}),
        ("fleet", "fleet", {**PLAN, "routes": [{**ROUTE, "lengths": [1]}]}),
        ("fleet", "fleet", {**PLAN, "routes": [None]}),
        ("fleet", "fleet", {**PLAN, "measures": {"driving": "far"}}),
        ("fleet", "fleet", {**PLAN, "unassigned": [1]}),
    ],
)
def test_a_tour_in_a_link_that_does_not_fit_its_request_is_refused(
    node: Node, name: str, kind: str, item: Any
) -> None:
    """Links come from anywhere."""
    request = REQUESTS[name]
    assert kept(node, request, SOUND[name])
    assert not kept(node, request, {"kind": kind, "item": item})


def kept(node: Node, request: dict[str, Any], chosen: dict[str, Any]) -> bool:
    """Whether the page would show the tour of a link to a front that is gone."""
    link = {"id": 32 * "0", "asked": {"chosen": chosen, "objectives": request["objectives"]}}
    ids = [stop["id"] for stop in request["stops"]]
    return node.call("result/chosen.js", "keptAnswer", link, request, ids) is not None


def test_a_link_carries_thirty_points_of_a_front_with_both_ends(node: Node) -> None:
    def carried(front: list[dict[str, list[float]]]) -> Any:
        return node.call("result/chosen.js", "pointsOf", front)

    front = [{"lengths": [1000 / 3 + k, 200 - k]} for k in range(100)]
    points = carried(front)
    assert len(points) == 30
    assert (points[0], points[-1]) == ([333.33, 200], [432.33, 101])
    assert carried(front[:3]) == [[333.33, 200], [334.33, 199], [335.33, 198]]
    assert carried(front[:1]) is None
    assert carried([{"lengths": [1, 2, 3]}] * 2) is None
    request = REQUESTS["two"]
    for points, fits in (([[1, 2], [3, 4]], True), ([[1, "x"], [3, 4]], False), ([[1]], False)):
        chosen = {**SOUND["two"], "points": points}
        link = {"id": 32 * "0", "asked": {"chosen": chosen, "objectives": request["objectives"]}}
        ids = [stop["id"] for stop in request["stops"]]
        answer = node.call("result/chosen.js", "keptAnswer", link, request, ids)
        assert ("among" in answer) == fits


def test_a_front_is_planned_again_where_the_tour_of_the_link_does_not_fit(window: Page) -> None:
    chosen = {"kind": "front", "item": {**ITEM, "tour": [0, 60]}}
    request = REQUESTS["two"]
    asked = {"request": request, "objectives": request["objectives"], "chosen": chosen}
    deflated = zlib.compress(json.dumps(asked).encode(), wbits=-15)
    text = base64.urlsafe_b64encode(deflated).decode().rstrip("=")
    open_link(window, f"#front={32 * '0'}&asked={text}")
    expect(window.locator("#choice")).not_to_contain_text("no longer keeps")
