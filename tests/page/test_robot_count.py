"""How many robots share a map, and where each starts: by click, in metres or as a cell."""
# ruff: noqa: E501  a table

import json
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.helpers.browsing import curl_body, needs_chromium, open_files
from tests.helpers.node import Node
from tests.page.test_robot_ends import OFFICE

MAP: dict[str, Any] = {"grid": [[0, 0, 0], [0, 0, 1]], "cell_size": 0.5, "spacing": 1}
PROPOSED = {"names": [{"name": "distance"}, {"name": "nearness to walls"}], "cost_layer": [[1]]}
LAYERS = {"cost_layers": [{"name": "people", "layer": [[1]]}]}
TWO = [{"id": "a", "start": 1}, {"id": "robot 1"}]


@pytest.mark.parametrize(
    ("request_", "count", "expected"),
    [
        (PROPOSED, 2, {"robots": [{"id": "robot 1"}, {"id": "robot 2"}]}),
        ({"cost_layer": [[1]]}, 2, {"cost_layer": [[1]], "robots": [{"id": "robot 1"}, {"id": "robot 2"}]}),
        ({**LAYERS, "start_pose": [1, 1], "detours": True}, 2, {"robots": [{"id": "robot 1", "start_pose": [1, 1]}, {"id": "robot 2"}]}),
        ({"closed": False, "start": None, "end": 3}, 2, {"closed": False, "robots": [{"id": "robot 1", "end": 3}, {"id": "robot 2"}]}),
        ({"robots": TWO, "over": ["sum", "max"]}, 3, {"over": ["sum", "max"], "robots": [*TWO, {"id": "robot 2"}]}),
        ({"robots": TWO}, 1, {"start": 1}),
        (LAYERS, 1, LAYERS),
    ],
)  # fmt: skip
def test_a_map_is_for_another_number_of_robots(
    node: Node, request_: dict[str, Any], count: int, expected: dict[str, Any]
) -> None:
    found = node.call("inputs/robots.js", "withRobots", {**MAP, **request_}, count)
    if count == 1 and "robots" in request_:  # one robot needs costs
        assert found.pop("names")[1]["name"] == "nearness to walls"
        assert len(found.pop("cost_layer")) == 2
    assert found == {**MAP, **expected}


@pytest.mark.parametrize(
    ("text", "cell"),
    [
        ("0.1, 0.1", [1, 0]),
        ("1.4 0.9", [0, 2]),
        ("row 2, column 3", [1, 2]),
        (" Row 2 col 1 ", [1, 0]),
        ("row 2", None),
        ("3", None),
        ("here", None),
    ],
)
def test_a_cell_is_said_in_metres_or_by_its_row_and_column(
    node: Node, text: str, cell: list[int] | None
) -> None:
    assert node.call("inputs/map_ends.js", "cellIn", MAP, text) == cell


@needs_chromium
def test_robots_have_their_number_and_their_starts(window: Page) -> None:
    window.set_viewport_size({"width": 1440, "height": 1200})
    open_files(window, {"office.json": json.dumps(OFFICE)})
    count = window.get_by_label("Robots", exact=True)
    count.fill("0")
    count.press("Tab")
    expect(window.locator("#robots-fault")).to_contain_text("from 1 to 100")
    count.fill("2")
    count.press("Tab")
    expect(window.locator("#robots-fault")).to_be_empty()
    window.locator("#end-of").select_option(label="Start of robot 2")
    at = window.get_by_label("or at")
    at.fill("somewhere")
    at.press("Enter")
    expect(window.locator("#status")).to_contain_text("neither x and y in metres nor a row")
    at.fill("row 2, column 7")
    at.press("Enter")
    expect(window.locator("#status")).to_contain_text("is an obstacle")
    at.fill("row 8, column 12")
    at.press("Enter")
    expect(window.locator("#ends-help")).to_contain_text("row 8, column 12")
    body = curl_body(window, "coverage")
    assert body["robots"] == [{"id": "robot 1", "start": 0}, {"id": "robot 2", "start": 1}]
    count.fill("1")
    count.press("Tab")
    expect(window.locator("#end-of option")).to_have_text(["Start", "End"])
