"""Stops on the maps of the page: dragged by mouse and by finger, moved and deleted by keys."""

import json
import math
import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    DESK,
    FREE,
    curl_body,
    needs_chromium,
    open_files,
    open_page,
    show_unplanned,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.sampled import few
from tests.helpers.touch import Place, slide_finger, tap, touched

pytestmark = needs_chromium

PLANES = "name,x,y,u,v\ndepot,0,0,5,5\nshop,3,1,9,1\nschool,5,2,2,8\n"
ON_EARTH = "id,lon,lat,risk\ndepot,24.94,60.17,1\nshop,24.95,60.18,2\nschool,24.93,60.16,3\n"


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page on a screen that can be touched, for tests that open stops of their own."""
    with open_page(browser, released + FREE) as page, touched(page):
        show_unplanned(page, released)
        page.set_viewport_size({"width": DESK, "height": 1400})
        yield page


def test_a_stop_is_dragged_by_the_mouse_on_either_plane(opened: Page) -> None:
    open_files(opened, {"stops.csv": PLANES})
    for plane, columns in enumerate(("x₁ y₁", "x₂ y₂")):
        before = numbers(opened, "shop", columns)
        others = curl_body(opened)["objectives"][1 - plane]
        x, y = place_of_stop(opened, 2, f"#plane-{plane + 1}")
        opened.mouse.move(x, y)
        opened.mouse.down()
        opened.mouse.move(x - 30, y - 20, steps=3)
        opened.mouse.up()
        after = numbers(opened, "shop", columns)
        assert after[0] < before[0]
        assert after[1] > before[1]
        assert curl_body(opened)["objectives"][1 - plane] == others
        moved = place_of_stop(opened, 2, f"#plane-{plane + 1}")
        assert moved == pytest.approx((x - 30, y - 20), abs=2)
    expect(opened.locator("#count")).to_have_text("3 stops")


def test_stops_on_the_earth_have_a_second_map_where_the_second_objective_has_a_plane(
    opened: Page,
) -> None:
    rows = "id,lon,lat,x,y\ndepot,24.94,60.17,0,5\nshop,24.95,60.18,3,1\nschool,24.93,60.16,9,2\n"
    open_files(opened, {"stops.csv": rows})
    expect(opened.locator("#plane-1-title")).to_have_text("Map")
    expect(opened.locator("#plane-2-title")).to_have_text("Second length")
    opened.get_by_label("Second objective", exact=True).fill("effort")
    opened.get_by_label("Second objective", exact=True).press("Tab")
    expect(opened.locator("#plane-2-title")).to_have_text("Effort")
    before = curl_body(opened)
    x, y = place_of_stop(opened, 2, "#plane-2")
    opened.mouse.move(x, y)
    opened.mouse.down()
    opened.mouse.move(x + 20, y + 10, steps=3)
    opened.mouse.up()
    after = curl_body(opened)
    assert after["stops"] == before["stops"]
    plane = [each["objectives"][1]["coordinates"] for each in (before, after)]
    assert plane[1][1][0] > plane[0][1][0]
    assert plane[1][1][1] < plane[0][1][1]
    assert plane[1][::2] == plane[0][::2]
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    for plane_map in ("#plane-1", "#plane-2"):
        expect(opened.locator(f"{plane_map} canvas.selected")).to_be_visible()
    open_files(opened, {"stops.csv": ON_EARTH})
    expect(opened.locator("#plane-2")).to_be_hidden()


def test_the_page_says_why_no_stop_can_be_added(opened: Page) -> None:
    open_files(opened, {"stops.csv": ON_EARTH})  # with their risk, costs are a matrix
    reason = opened.get_by_text("No stop can be added: its costs to the other stops are not known.")
    expect(reason).to_be_visible()
    for name in ("Add", "Add on the map"):
        button = opened.locator(".row").get_by_role("button", name=name, exact=True).first
        expect(button).to_be_disabled()
        expect(button).to_have_accessible_description(re.compile("No stop can be added"))
    open_files(opened, {"stops.csv": PLANES})
    expect(reason).to_be_hidden()
    button = opened.get_by_role("button", name="Add on the map")
    expect(button).to_be_enabled()
    expect(button).to_have_accessible_description("")


@pytest.mark.parametrize("kind", few(1, ["fleet", "tour"]))
def test_the_map_follows_a_place_that_is_corrected_in_the_table(opened: Page, kind: str) -> None:
    # The school is in the desert: its longitude and latitude are swapped.
    rows = {"depot": (24.94, 60.17), "shop": (24.95, 60.18), "school": (60.16, 24.93)}
    if kind == "tour":
        lines = [f"{name},{lon},{lat}" for name, (lon, lat) in rows.items()]
        open_files(opened, {"stops.csv": "\n".join(["id,lon,lat", *lines])})
    else:
        asked = {
            "stops": [{"id": name, "location": place} for name, place in rows.items()],
            "vehicles": [{"id": "van", "count": 2, "start": "depot", "end": "depot"}],
            "objectives": [
                {"name": "distance", "from": "great_circle"},
                {"name": "longest", "from": "great_circle", "over": "max"},
            ],
        }
        open_files(opened, {"fleet.json": json.dumps(asked)})
    expect(opened.get_by_label("Name of stop 3")).to_have_value("school")
    assert math.dist(*[place_of_stop(opened, stop) for stop in (1, 2)]) < 5
    for column, value in (("Longitude", "24.93"), ("Latitude", "60.16")):
        opened.get_by_label(f"{column} of school").fill(value)
        opened.get_by_label(f"{column} of school").press("Tab")
    before = place_of_stop(opened, 1)
    assert math.dist(before, place_of_stop(opened, 2)) > 50
    # It stays for a small change, and for a stop that is dragged.
    opened.get_by_label("Latitude of school").fill("60.161")
    opened.get_by_label("Latitude of school").press("Tab")
    assert place_of_stop(opened, 1) == pytest.approx(before, abs=1)
    x, y = place_of_stop(opened, 2)
    opened.mouse.move(x, y)
    opened.mouse.down()
    opened.mouse.move((x + 3 * before[0]) / 4, (y + 3 * before[1]) / 4, steps=3)
    opened.mouse.up()
    assert place_of_stop(opened, 1) == pytest.approx(before, abs=1)


def test_keys_choose_move_and_delete_a_stop(opened: Page) -> None:
    open_files(opened, {"stops.csv": ON_EARTH})
    column = "Longitude Latitude"
    before = numbers(opened, "shop", column)
    x, y = place_of_stop(opened, 2)
    for key in ("ArrowRight", "ArrowRight", "Shift+ArrowDown"):
        opened.keyboard.press(key)
    expect(opened.locator("#stop-help")).to_contain_text("shop is chosen.")
    after = numbers(opened, "shop", column)
    assert after[0] > before[0]
    assert after[1] < before[1]
    assert place_of_stop(opened, 2) == pytest.approx((x + 20, y + 1), abs=1)
    # Its risk on the way was written into a matrix when the file was read.
    expect(opened.locator("#status")).to_contain_text("Costs given as a matrix did not change")
    opened.keyboard.press("Delete")
    expect(opened.locator("#count")).to_have_text("2 stops")
    assert [stop["id"] for stop in curl_body(opened)["stops"]] == ["depot", "school"]
    opened.locator("#plane-1").press("Delete")  # none is chosen
    opened.locator("#plane-1").press("Enter")
    opened.keyboard.press("Escape")
    expect(opened.get_by_role("button", name="Delete it")).to_be_hidden()
    expect(opened.locator("#count")).to_have_text("2 stops")


def test_a_finger_scrolls_past_stops_and_moves_the_one_it_has_chosen(opened: Page) -> None:
    opened.get_by_label("Example").select_option("City deliveries")
    expect(opened.locator("#count")).to_have_text("61 stops")
    before = curl_body(opened)["coordinates"]
    start = place_of_stop(opened, 1)
    opened.keyboard.press("Escape")
    slide_finger(opened, start, (start[0] + 24, start[1] + 30))
    assert curl_body(opened)["coordinates"] == before
    start = place_of_stop(opened, 1)
    opened.keyboard.press("Escape")
    tap(opened, start)
    expect(opened.locator("#stop-help")).to_contain_text("stop 1 is chosen.")
    slide_finger(opened, start, (start[0] + 24, start[1] + 30))
    after = curl_body(opened)["coordinates"]
    assert [
        row for row, (one, two) in enumerate(zip(before, after, strict=True)) if one != two
    ] == [0]
    assert after[0][0] > before[0][0]
    assert after[0][2:] == before[0][2:]
    opened.get_by_role("button", name="Delete it").click()
    expect(opened.locator("#count")).to_have_text("60 stops")


def test_a_place_that_is_clicked_on_the_first_of_two_maps_is_seen_at_once(opened: Page) -> None:
    open_files(opened, {"stops.csv": PLANES})
    opened.get_by_role("button", name="Add on the map").click()
    opened.locator("#plane-1").click(position={"x": 90, "y": 60})
    expect(opened.locator("#plane-1 .ring.waiting")).to_be_visible()
    expect(opened.locator("#plane-2 .ring.waiting")).to_have_count(0)
    opened.locator("#plane-2").click(position={"x": 90, "y": 60})
    expect(opened.locator("#count")).to_have_text("4 stops")
    expect(opened.locator(".ring.waiting")).to_have_count(0)
    opened.get_by_role("button", name="Add on the map").click()


def place_of_stop(page: Page, number: int, plane: str = "#plane-1") -> Place:
    """Choose the stop of this number by keys, and return its place on a map."""
    page.locator(plane).press("Escape")
    for _ in range(number):
        page.keyboard.press("Enter")
    # The line that names the stop may leave the map less room, which it takes in the next frame.
    for _ in range(2):
        wait_for_next_frame(page)
    ring = page.locator(f"{plane} .ring.highlight").bounding_box()
    assert ring is not None
    return ring["x"] + ring["width"] / 2, ring["y"] + ring["height"] / 2


def numbers(page: Page, name: str, columns: str) -> list[float]:
    """Return what the table says of a stop in these columns."""
    return [float(page.get_by_label(f"{each} of {name}").input_value()) for each in columns.split()]
