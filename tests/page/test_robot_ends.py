"""Where a robot's tour starts and ends on the page: placed and moved by click, drag and keys."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from service.coverage.frame import MapFrame
from tests.helpers.browsing import (
    FREE,
    copied,
    curl_body,
    needs_chromium,
    open_files,
    open_page,
    open_unplanned,
    select_last,
    show_unplanned,
    shown_front,
    wait_until_planned,
)
from tests.helpers.touch import slide_finger, tap, touched

pytestmark = needs_chromium

ROWS, COLUMNS = 8, 12
WALL = [[int(column == 6 and row > 0) for column in range(COLUMNS)] for row in range(ROWS)]
PLACES = [[0, 0], [7, 11], [0, 11], [7, 0]]
TURNED = [-3.0, 2.0, 0.4]
OFFICE: dict[str, Any] = {
    "grid": WALL,
    "cell_size": 0.5,
    "places": PLACES,
    "cost_layer": [[1] * COLUMNS] * ROWS,
    "time_limit": 0.1,
}
Cell = tuple[int, int]


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all of these tests, each of which opens its own request."""
    with open_unplanned(browser, released) as page:
        page.set_viewport_size({"width": 1440, "height": 1200})
        yield page


def open_office(page: Page, **members: Any) -> None:
    asked = {name: value for name, value in {**OFFICE, **members}.items() if value is not None}
    open_files(page, {"office.json": json.dumps(asked)})
    expect(page.locator("#ends")).to_be_visible()


def pixel(page: Page, cell: Cell) -> tuple[float, float]:
    """Return where the middle of a cell is in the window."""
    page.locator("#grid").scroll_into_view_if_needed()
    box = page.locator("#grid img.cells").bounding_box()
    assert box
    row, column = cell
    return (
        box["x"] + (column + 0.5) / COLUMNS * box["width"],
        box["y"] + (row + 0.5) / ROWS * box["height"],
    )


def shown_cell(page: Page, ring: str) -> Cell:
    """Return the cell in which a ring is drawn."""
    box = page.locator(f"#grid .ring.{ring}").bounding_box()
    whole = page.locator("#grid img.cells").bounding_box()
    assert box
    assert whole
    x, y = box["x"] + box["width"] / 2 - whole["x"], box["y"] + box["height"] / 2 - whole["y"]
    return int(y / whole["height"] * ROWS), int(x / whole["width"] * COLUMNS)


def drag(page: Page, from_cell: Cell, to_cell: Cell, *, drop: bool = True) -> None:
    page.mouse.move(*pixel(page, from_cell))
    page.mouse.down()
    page.mouse.move(*pixel(page, to_cell), steps=4)
    if drop:
        page.mouse.up()


def status(page: Page) -> str:
    return page.locator("#status").inner_text()


def cell_of_pose(pose: list[float], origin: list[float]) -> Cell:
    return MapFrame(origin=origin, cell_size=0.5, rows=ROWS).cell(pose[0], pose[1])


def plan(page: Page) -> Any:
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    return shown_front(page)


def test_a_start_is_dragged_to_a_place_and_to_any_free_cell(opened: Page) -> None:
    open_office(opened, origin=TURNED)
    assert shown_cell(opened, "start") == (0, 0)
    expect(opened.locator("#grid-legend .start")).to_be_visible()
    expect(opened.locator("#grid-legend .end")).to_be_hidden()
    drag(opened, (0, 0), (0, 11))
    body = curl_body(opened, "coverage")
    assert body["start"] == 2
    assert "start_pose" not in body
    assert "row 1, column 12" in opened.locator("#ends-help").inner_text()
    drag(opened, (0, 11), (3, 4))
    body = curl_body(opened, "coverage")
    assert "start" not in body
    assert cell_of_pose(body["start_pose"], TURNED) == (3, 4)
    assert repr(body["start_pose"]) in copied(opened, "as Python")
    answer = plan(opened)
    assert answer["places"][answer["front"][0]["tour"][0]] == [3, 4]
    assert answer["front"][0]["path"]["cells"][0] == [3, 4]
    assert shown_cell(opened, "start") == (3, 4)


def test_a_map_without_an_origin_gets_one_with_a_pose(opened: Page) -> None:
    open_office(opened)
    assert "origin" not in curl_body(opened, "coverage")
    drag(opened, (0, 0), (5, 2))
    body = curl_body(opened, "coverage")
    assert body["origin"] == [0, 0, 0]
    assert cell_of_pose(body["start_pose"], body["origin"]) == (5, 2)
    opened.get_by_label("Start", exact=True).fill("2.25, 0.25")
    opened.get_by_label("Start", exact=True).press("Tab")
    assert shown_cell(opened, "start") == (7, 4)


UNKNOWN = [[int(column > 9) for column in range(COLUMNS)] for _ in range(ROWS)]


@pytest.mark.parametrize(
    ("members", "cell", "said"),
    [
        ({}, (4, 6), "Row 5, column 7 is an obstacle: the start stays where it was."),
        ({"robot_radius": 0.6}, (4, 5), "within 0.6 m of an obstacle"),
        ({"unknownCells": UNKNOWN, "grid": UNKNOWN, "places": [[0, 0]]}, (2, 10), "is unknown"),
        (
            {"cost_layer": None, "second_coordinates": [[0, 0], [1, 2], [3, 1], [2, 2]]},
            (1, 1),
            "is not a place, and costs are known between places alone",
        ),
        ({"closed": False, "end": 1}, (7, 11), "is where the tour ends"),
    ],
)
def test_where_a_start_cannot_be_it_stays_and_the_page_says_why(
    opened: Page, members: dict[str, Any], cell: Cell, said: str
) -> None:
    open_office(opened, **members)
    before = curl_body(opened, "coverage")
    drag(opened, (0, 0), cell, drop=False)
    expect(opened.locator("#grid .ring.forbidden")).to_be_visible()
    opened.mouse.up()
    assert said in status(opened)
    assert shown_cell(opened, "start") == (0, 0)
    assert curl_body(opened, "coverage") == before


def test_escape_gives_up_a_drag_and_a_placing(opened: Page) -> None:
    open_office(opened)
    before = curl_body(opened, "coverage")
    drag(opened, (0, 0), (3, 3), drop=False)
    assert shown_cell(opened, "start") == (3, 3)
    opened.keyboard.press("Escape")
    opened.mouse.up()
    assert shown_cell(opened, "start") == (0, 0)
    assert curl_body(opened, "coverage") == before
    placing = opened.get_by_role("button", name="Place it")
    placing.click()
    expect(placing).to_have_attribute("aria-pressed", "true")
    opened.keyboard.press("Escape")
    expect(placing).to_have_attribute("aria-pressed", "false")
    opened.mouse.click(*pixel(opened, (3, 3)))
    assert curl_body(opened, "coverage") == before


def test_a_moved_start_is_taken_back(opened: Page) -> None:
    open_office(opened)
    before = curl_body(opened, "coverage")
    drag(opened, (0, 0), (3, 3))
    assert shown_cell(opened, "start") == (3, 3)
    opened.get_by_role("button", name="Undo").click()
    assert shown_cell(opened, "start") == (0, 0)
    assert curl_body(opened, "coverage") == before


def test_an_end_is_placed_by_a_click_moved_by_keys_and_taken_away(opened: Page) -> None:
    open_office(opened, spacing=1.5, places=None)
    opened.get_by_label("Start or end to place").select_option("End")
    placing = opened.get_by_role("button", name="Place it")
    placing.click()
    opened.mouse.click(*pixel(opened, (4, 6)))
    assert "is an obstacle: the end is not placed" in status(opened)
    expect(placing).to_have_attribute("aria-pressed", "true")
    opened.mouse.click(*pixel(opened, (4, 9)))
    body = curl_body(opened, "coverage")
    assert cell_of_pose(body["end_pose"], body["origin"]) == (4, 9)
    assert body["closed"] is False
    expect(opened.locator("#grid-legend .end")).to_be_visible()
    for key in ("Shift+ArrowRight", "Shift+ArrowUp"):
        opened.locator("#grid").press(key)
    body = curl_body(opened, "coverage")
    assert cell_of_pose(body["end_pose"], body["origin"]) == (3, 10)
    answer = plan(opened)
    assert answer["front"][0]["path"]["cells"][-1] == [3, 10]
    opened.locator("#grid").press("Delete")
    assert "end_pose" not in curl_body(opened, "coverage")
    expect(opened.locator("#grid .ring.end")).to_have_count(0)


def test_keys_alone_place_a_start_that_was_left_open(opened: Page) -> None:
    open_office(opened, spacing=1.5, places=None)
    expect(opened.locator("#grid .ring.start")).to_have_count(0)
    opened.get_by_role("button", name="Place it").press("Enter")
    opened.keyboard.press("Enter")
    expect(opened.locator("#grid .ring.start")).to_have_count(1)
    row, column = shown_cell(opened, "start")
    assert not WALL[row][column]
    for _ in range(3):
        opened.keyboard.press("ArrowLeft")
    body = curl_body(opened, "coverage")
    assert cell_of_pose(body["start_pose"], body["origin"]) == shown_cell(opened, "start")
    assert shown_cell(opened, "start")[1] < column
    for _ in range(COLUMNS):
        opened.locator("#grid").press("ArrowLeft")
    assert "is not on the map" in status(opened)
    assert shown_cell(opened, "start") == (row, 0)


def test_the_start_of_each_robot_is_moved(opened: Page) -> None:
    robots = [{"id": "left", "start": 0}, {"id": "right", "start": 1}]
    open_office(opened, cost_layer=None, robots=robots)
    drag(opened, (7, 11), (0, 11))
    drag(opened, (0, 0), (2, 3))
    body = curl_body(opened, "coverage")
    assert [robot["id"] for robot in body["robots"]] == ["left", "right"]
    assert body["robots"][1] == {"id": "right", "start": 2}
    assert cell_of_pose(body["robots"][0]["start_pose"], body["origin"]) == (2, 3)
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    starts = {route["robot"]: route["path"]["cells"][0] for route in select_last(opened)["routes"]}
    assert starts.items() <= {"left": [2, 3], "right": [0, 11]}.items()
    assert starts


def test_poses_of_an_opened_request_are_drawn_and_sent_again(opened: Page) -> None:
    poses = {"start_pose": [-2.5, 3.5], "end_pose": [0.5, 3.0], "closed": False}
    open_office(opened, origin=TURNED, **poses)
    body = curl_body(opened, "coverage")
    assert {name: body[name] for name in poses} == poses
    assert "start" not in body
    for ring, name in (("start", "start_pose"), ("end", "end_pose")):
        assert shown_cell(opened, ring) == cell_of_pose(poses[name], TURNED)  # type: ignore[arg-type]


def test_an_end_that_no_path_leads_to_is_refused_at_its_field(opened: Page) -> None:
    closed = [[int(column == 6) for column in range(COLUMNS)] for _ in range(ROWS)]
    open_office(opened, grid=closed, spacing=1.5, places=None)
    opened.get_by_label("End elsewhere").fill("5.25, 1.25")
    opened.get_by_label("Start", exact=True).fill("0.25, 0.25")
    opened.get_by_role("button", name="Plan", exact=True).click()
    fault = opened.locator("#end-fault")
    expect(fault).to_contain_text("End elsewhere must be reachable from start")
    expect(opened.get_by_label("End elsewhere")).to_have_attribute("aria-invalid", "true")


def test_a_radius_that_is_typed_holds_for_ends_at_once(opened: Page) -> None:
    open_office(opened)
    opened.locator("#robot_radius").fill("0.6")
    opened.locator("#robot_radius").press("Tab")
    drag(opened, (0, 0), (4, 5))
    assert "within 0.6 m of an obstacle" in status(opened)
    assert shown_cell(opened, "start") == (0, 0)


def test_a_finger_moves_the_start_that_it_has_chosen(browser: Browser, released: str) -> None:
    with open_page(browser, released + FREE) as page, touched(page):
        show_unplanned(page, released)
        page.set_viewport_size({"width": 1440, "height": 1200})
        open_office(page)
        begin, end = pixel(page, (0, 0)), pixel(page, (2, 3))
        slide_finger(page, begin, end)
        assert shown_cell(page, "start") == (0, 0)  # it scrolls
        page.locator("#grid").scroll_into_view_if_needed()
        begin, end = pixel(page, (0, 0)), pixel(page, (2, 3))
        tap(page, begin)
        slide_finger(page, begin, end)
        assert shown_cell(page, "start") == (2, 3)


def test_on_a_large_map_an_end_is_moved_by_one_cell(opened: Page) -> None:
    side = 600  # a cell is less than a pixel
    open_office(
        opened,
        grid=np.zeros((side, side), int).tolist(),
        cost_layer=None,
        second_coordinates=None,
        second_matrix=None,
        places=None,
        spacing=200,
        robots=[{"id": "one", "start_pose": [200.25, 200.25]}],
        origin=[0, 0, 0],
    )
    opened.locator("#grid").press("Enter")
    for step in range(1, 4):
        opened.locator("#grid").press("Shift+ArrowRight")
        [robot] = curl_body(opened, "coverage")["robots"]
        assert robot["start_pose"] == [200.25 + step / 2, 200.25]
