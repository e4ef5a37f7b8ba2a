"""The paths that the page saves for robots: as messages of ROS, and as rows in metres."""

import csv
import io
import json
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    needs_chromium,
    open_files,
    saved,
    select_last,
    wait_until_planned,
)

pytestmark = needs_chromium

OFFICE: dict[str, Any] = {
    "grid": [[0, 0, 0, 0], [0, 1, 1, 0], [0, 0, 0, 0]],
    "cell_size": 0.5,
    "origin": [-2.0, 1.0, 0.25],
    "places": [[0, 0], [2, 0], [2, 3], [0, 2]],
    "time_limit": 0.1,
}
LAYER = {"cost_layer": [[1, 1, 1, 1], [0, 0, 0, 9], [0, 0, 0, 1]]}
ROBOTS = {"robots": [{"id": "far, left"}, {"id": "right", "start": 2}]}


def positions(message: dict[str, Any]) -> list[list[float]]:
    assert message["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "map"}
    places = [pose["pose"]["position"] for pose in message["poses"]]
    return [[place["x"], place["y"]] for place in places]


@pytest.mark.parametrize("kind", [LAYER, ROBOTS], ids=["tour", "plan"])
def test_the_selected_paths_are_saved_for_robots(window: Page, kind: dict[str, Any]) -> None:
    open_files(window, {"stops.csv": "1,2,3,4\n5,6,7,8\n"})
    expect(window.get_by_role("button", name="Save the path (CSV)")).to_be_hidden()
    open_files(window, {"office.json": json.dumps({**OFFICE, **kind})})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    item = select_last(window)
    routes = item.get("routes") or [{**item, "robot": None}]
    messages = json.loads(saved(window, "the path for ROS (JSON)"))
    by_robot = messages if kind is ROBOTS else {None: messages}
    rows = list(csv.DictReader(io.StringIO(saved(window, "the path (CSV)").decode())))
    assert by_robot.keys() == {route["robot"] for route in routes}
    for route in routes:
        path = route["path"]
        assert positions(by_robot[route["robot"]]) == path["points"]
        mine = [row for row in rows if row.get("robot") == route["robot"]]
        assert [float(row["yaw"]) for row in mine] == path["yaws"]
        assert [[float(row["x"]), float(row["y"])] for row in mine] == path["points"]
        visited = [int(row["place"]) for row in mine if row["place"]]
        assert visited == [place for _, place in path["visits"]]


def test_a_map_without_an_origin_has_no_poses_to_save(window: Page) -> None:
    plain = {name: value for name, value in OFFICE.items() if name != "origin"}
    open_files(window, {"office.json": json.dumps({**plain, **LAYER})})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    window.get_by_role("button", name="Save the path (CSV)").click()
    expect(window.locator("#link-help")).to_contain_text("its map has no origin")
