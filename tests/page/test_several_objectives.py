"""Three objectives on the page: limits on each, the plane of two, and what is said of a tour."""

import json
import re
from collections.abc import Iterator
from xml.etree import ElementTree

import numpy as np
import pytest
from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.helpers.browsing import (
    DESK,
    PHONE,
    SVG,
    copied,
    needs_chromium,
    number_in,
    open_files,
    open_link,
    open_unplanned,
    saved,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium

N = 14
LEAST_TRACK = 150  # pixels
ROUNDED = 0.005  # relative: what the page says to three digits


def request() -> str:
    """Stops in Helsinki under distance, and two matrices."""
    rng = np.random.default_rng(2)
    stops = [
        {"id": f"#{1001 + k}", "location": [24.9 + x / 20, 60.15 + y / 30]}
        for k, (x, y) in enumerate(rng.random((N, 2)).tolist())
    ]
    objectives = [
        {"name": "way", "from": "great_circle"},
        {"name": "people passed", "unit": "people", "matrix": (9 * rng.random((N, N))).tolist()},
        {"name": "climb", "unit": "m", "matrix": (30 * rng.random((N, N))).tolist()},
    ]
    return json.dumps({"stops": stops, "objectives": objectives, "time_limit": 0.1})


@pytest.fixture(scope="module")
def planned(browser: Browser, released: str) -> Iterator[Page]:
    """The page with a front of three objectives."""
    with open_unplanned(browser, released) as page:
        open_files(page, {"three.json": request()})
        plan(page)
        yield page


@pytest.fixture
def page(planned: Page) -> Page:
    """The same without limits."""
    for name in ("Way", "People passed", "Climb"):
        limit(planned, name).press("Escape")
    return planned


def plan(page: Page) -> None:
    """Plan, and wait for the end of that, not for the one before."""
    with page.expect_response(lambda answer: answer.request.method == "POST"):
        page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)


def climb_more(route: Route) -> None:
    """Answer with the front that was asked for, whose tours climb a thousand times as much."""
    answer = route.fetch()
    found = answer.json()
    for tour in found.get("front", []):
        tour["lengths"][2] *= 1000
    route.fulfill(response=answer, json=found)


def limit(page: Page, name: str) -> Locator:
    return page.get_by_role("slider", name=name, exact=True)


def limit_widely(page: Page, name: str) -> None:
    """Set a limit so that any front has tours within it, and others beyond it."""
    slider = limit(page, name)
    least, most = (float(slider.get_attribute(end) or 0) for end in ("min", "max"))
    slider.fill(str(least + 0.7 * (most - least)))


def front_of(page: Page) -> np.ndarray:
    """The lengths of all tours, from what the page saves."""
    return np.array([tour["lengths"] for tour in json.loads(saved(page, "json"))["front"]])


def shown(page: Page) -> list[float]:
    """The lengths of the tour that is shown, once it is drawn."""
    wait_for_next_frame(page)
    cells = page.locator("#comparison tbody td:nth-child(2)").all_inner_texts()
    return [number_in(text) for text in cells]


def test_three_objectives_are_asked_for_shown_and_named(page: Page) -> None:
    names = ["First objective", "Second objective", "Third objective"]
    for name, value in zip(names, ["way", "people passed", "climb"], strict=True):
        expect(page.get_by_label(name, exact=True)).to_have_value(value)
    expect(page.locator("#several")).to_be_visible()
    for hidden in (".plot", "#balance", "#budget"):
        expect(page.locator(hidden)).to_be_hidden()
    label = page.locator("#scatter").get_attribute("aria-label") or ""
    assert re.match(r"A choice of \d+ tours: way from .* to .*, people passed from", label)
    rows = page.locator("#comparison tbody th").all_inner_texts()
    assert rows == ["Way", "People passed", "Climb"]


def test_without_limits_the_tour_in_the_middle_is_shown(page: Page) -> None:
    lengths = front_of(page)
    least, most = lengths.min(axis=0), lengths.max(axis=0)
    middle = lengths[((lengths - least) / (most - least)).sum(axis=1).argmin()]
    assert shown(page) == pytest.approx(middle, rel=ROUNDED)
    expect(page.locator("#caps-said")).to_contain_text("No limits")


def test_limits_leave_the_best_of_what_they_allow(page: Page) -> None:
    lengths = front_of(page)
    limit(page, "Way").press("Home")
    near_the_least = lengths[lengths[:, 0] <= float(limit(page, "Way").input_value()) + 1e-9]
    found = shown(page)
    assert any(found == pytest.approx(each, rel=ROUNDED) for each in near_the_least.tolist())
    for _ in range(3):
        limit(page, "Way").press("ArrowRight")
    said = limit(page, "Way").get_attribute("aria-valuetext") or ""
    assert said.startswith("at most ")
    expect(page.locator("#caps-said")).to_contain_text(" are within the limits.")
    said_in_full = "outputs => outputs.every(each => each.scrollWidth <= each.clientWidth)"
    assert page.locator("#caps output").evaluate_all(said_in_full)
    most = float(limit(page, "Way").input_value())
    limit(page, "Climb").press("Home")
    least = lengths[lengths[:, 0] <= most + 1e-9, 2].min()
    assert shown(page)[2] == pytest.approx(least, rel=ROUNDED)
    assert shown(page)[0] <= most * (1 + ROUNDED)


def test_pictures_show_the_limits_and_grey_what_is_beyond(page: Page) -> None:
    limit(page, "Way").press("Home")
    for _ in range(3):
        limit(page, "Way").press("ArrowRight")
    limit(page, "Climb").press("Home")
    wait_for_next_frame(page)
    within, of_all = re.findall(r"\d+", page.locator("#caps-said").inner_text())
    drawing = ElementTree.fromstring(saved(page, "SVG"))
    [said] = [each.text for each in drawing.iter(f"{SVG}text") if "≤" in (each.text or "")]
    assert re.fullmatch(r"way ≤ [\d,.]+ k?m, climb ≤ [\d,.]+ m", said or "")
    assert len(list(drawing.iter(f"{SVG}line"))) == 1  # of the two objectives that are drawn
    grey = page.evaluate("getComputedStyle(document.documentElement).getPropertyValue('--edge')")
    beyond = [each for each in drawing.iter(f"{SVG}circle") if each.get("fill") == grey]
    assert len(beyond) == int(of_all) - int(within)


def test_limits_leave_a_chosen_tour_selected_that_is_within_them(page: Page) -> None:
    lengths = front_of(page)
    page.get_by_role("button", name="Least way within the limits").click()
    shortest = shown(page)
    assert shortest[0] == pytest.approx(lengths[:, 0].min(), rel=ROUNDED)
    limit(page, "Way").press("ArrowLeft")
    assert shown(page) == shortest
    page.get_by_role("button", name="Least climb within the limits").click()
    least = lengths[lengths[:, 0] <= float(limit(page, "Way").input_value()) + 1e-9, 2].min()
    assert shown(page)[2] == pytest.approx(least, rel=ROUNDED)


def test_limits_stay_when_the_front_is_planned_again(page: Page) -> None:
    for name in ("Way", "Climb"):
        limit_widely(page, name)
    limits = [float(limit(page, name).input_value()) for name in ("Way", "Climb")]
    plan(page)
    kept = [float(limit(page, name).input_value()) for name in ("Way", "Climb")]
    assert kept == pytest.approx(limits, rel=0.01)


def test_a_limit_that_another_front_cannot_keep_is_lifted_and_that_is_said(page: Page) -> None:
    limit_widely(page, "Way")
    limit_widely(page, "Climb")
    climb = limit(page, "Climb").get_attribute("aria-valuetext") or ""
    page.route("**/front/*", climb_more)
    plan(page)
    said = climb.partition(";")[0]
    expect(page.locator("#caps-said")).to_contain_text(
        f"Lifted, as nothing is within all limits: climb {said}."
    )
    page.unroute_all()
    expect(limit(page, "Climb")).to_have_attribute("aria-valuetext", re.compile("^no limit"))
    plan(page)
    expect(page.locator("#caps-said")).not_to_contain_text("Lifted")


@pytest.mark.parametrize("width", [DESK, PHONE])
def test_a_slider_keeps_its_width_while_a_limit_is_set(page: Page, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    slider = limit(page, "Way")
    widths = []
    for key in ("Escape", "Home"):
        slider.press(key)
        box = slider.bounding_box()
        assert box is not None
        widths.append(box["width"])
    assert widths[0] == widths[1] >= LEAST_TRACK
    page.set_viewport_size({"width": DESK, "height": 900})


def test_a_limit_stops_where_the_others_leave_nothing(page: Page) -> None:
    limit(page, "Way").press("Home")
    limit(page, "Climb").press("Home")
    limit(page, "People passed").press("Home")
    lengths = front_of(page)
    assert shown(page)[0] == pytest.approx(lengths[:, 0].min(), rel=ROUNDED)


def test_a_dot_that_is_clicked_is_selected_and_lifts_limits_that_it_breaks(page: Page) -> None:
    limit(page, "Way").press("Home")
    page.locator("#scatter").scroll_into_view_if_needed()
    every = page.locator("#scatter circle.beyond")
    places = [float(each.get_attribute("cx") or 0) for each in every.all()]
    box = every.nth(places.index(max(places))).bounding_box()  # far from the one within
    assert box is not None
    before = shown(page)
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.move(0, 0)
    expect(page.locator("#caps-said")).to_contain_text("No limits")
    assert shown(page) != before


def test_the_objectives_across_up_and_of_the_colour_are_chosen(page: Page) -> None:
    across, up, colour = (
        page.get_by_label(name, exact=True) for name in ("Across", "Up", "Colour")
    )
    places = page.locator("#scatter circle").first.get_attribute("cx")
    across.select_option("Climb")
    expect(colour).to_have_value("0")
    expect(up).to_have_value("1")
    expect(page.locator("#scatter svg")).to_contain_text("Climb")
    assert page.locator("#scatter circle").first.get_attribute("cx") != places
    across.select_option("Way")


def test_a_tour_is_said_beside_the_least_of_each(page: Page) -> None:
    limit(page, "Way").press("Home")
    choice = page.locator("#choice")
    expect(choice).to_have_text(
        re.compile(r"^The least way of all; .*more people passed.* and .*more climb.*of each\.$")
    )


def test_two_tours_are_compared(page: Page) -> None:
    limit(page, "Way").press("Home")
    page.get_by_role("button", name="Keep to compare").click()
    limit(page, "Way").press("End")
    limit(page, "Climb").press("Home")
    differences = page.locator("#comparison tbody td:nth-child(4)")
    expect(differences.nth(0)).to_have_text(re.compile(r"^\+"))
    expect(differences.nth(2)).to_have_text(re.compile("^\N{MINUS SIGN}"))
    page.get_by_role("button", name="Stop comparing").click()


def test_a_link_carries_the_limits_and_the_tour(page: Page, other: Page) -> None:
    for _ in range(3):
        limit(page, "Way").press("ArrowLeft")
    page.get_by_role("button", name="Fewest people passed within the limits").click()
    most, tour = limit(page, "Way").input_value(), shown(page)
    said = page.locator("#caps-said").inner_text()
    open_link(other, copied(page, "link"))
    expect(other.locator("#caps-said")).to_have_text(said)
    assert limit(other, "Way").input_value() == most
    assert shown(other) == tour
    limit(other, "Climb").press("Home")  # which that tour is beyond
    assert shown(other) != tour


def test_what_is_taken_along_has_all_three(page: Page) -> None:
    lines = saved(page, "csv").decode().splitlines()
    assert lines[0] == "way (m),people passed (people),climb (m),tour,selected"
    assert len(lines) == 1 + len(front_of(page))
    assert "choose(knee=True)" in copied(page, "as Python")
    svg = saved(page, "svg").decode()
    assert ">Way<" in svg
    assert ">People passed<" in svg


def test_the_next_front_of_two_has_its_own_chart(page: Page) -> None:
    page.get_by_label("Example", exact=True).select_option("City deliveries")
    wait_until_planned(page)
    expect(page.locator("#several")).to_be_hidden()
    expect(page.locator("#balance")).to_be_visible()
