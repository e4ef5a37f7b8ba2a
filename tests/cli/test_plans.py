"""Files and options become a plan."""

import json
from pathlib import Path

import numpy as np
import pytest

from service.cli.errors import UsageError
from service.cli.plans import plan_cities, plan_map


def test_options_stand_over_the_file_where_they_are_given(tmp_path: Path) -> None:
    file = tmp_path / "a.json"
    file.write_text('{"coordinates": [[1, 2, 3, 4]], "seed": 3, "size": 5}')
    plan, _ = plan_cities([file], angles="10,45.5", options={"seed": 4, "size": None})
    assert plan.path == "/front"
    assert plan.request == {
        "coordinates": [[1, 2, 3, 4]],
        "preferences": [10.0, 45.5],
        "seed": 4,
        "size": 5,
    }


def test_any_start_is_null_in_the_request(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("1,2,3,4\n")
    plan, _ = plan_cities(
        [tmp_path / "a.csv"], options={"start": "any", "closed": False, "end": "2"}
    )
    assert plan.request == {
        "coordinates": [[1, 2, 3, 4]],
        "start": None,
        "end": 2,
        "closed": False,
    }


def test_two_files_are_one_plan(tmp_path: Path) -> None:
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("0,1,2\n3,0,4\n5,6,0\n")
    plan, _ = plan_cities([tmp_path / "a.csv", tmp_path / "b.csv"], options={})
    assert plan.file is not None
    assert plan.file.part == "matrices"


def test_angles_must_be_numbers(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("1,2,3,4\n")
    with pytest.raises(UsageError, match="--angles must be numbers with commas between, got '1,b'"):
        plan_cities([tmp_path / "a.csv"], angles="1,b", options={})


def test_a_map_is_a_file_beside_its_options_and_costs(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"PNG")
    (tmp_path / "costs.csv").write_text("1,2\n3,4\n")
    options = {"cell_size": 1.0, "spacing": 2.0, "paths": None}
    plan, _ = plan_map(tmp_path / "map.png", [tmp_path / "costs.csv"], options)
    assert plan.file is not None
    assert (plan.path, plan.file.content) == ("/coverage", b"PNG")
    np.testing.assert_array_equal(plan.request["cost_layer"], [[1, 2], [3, 4]])
    assert json.loads(plan.json).keys() == {"cell_size", "spacing", "cost_layer"}


def test_everything_that_a_map_lacks_is_named_at_once(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"PNG")
    with pytest.raises(UsageError, match=r"without --cell-size, --spacing .*, --cost-layer"):
        plan_map(tmp_path / "map.png", [], {"spacing": None})
    (tmp_path / "map.json").write_text('{"grid": [[0]], "places": [[0, 0]], "cell_size": 1}')
    with pytest.raises(UsageError, match="without --cost-layer"):
        plan_map(tmp_path / "map.json", [], {})


def test_a_message_lacks_no_cell_size(tmp_path: Path) -> None:
    (tmp_path / "map.json").write_text('{"info": {}, "data": [0]}')
    poses = {"start_pose": "-1,2.5", "end_pose": None}
    options = {"spacing": 2.0, "unknown": None, "cell_size": None, **poses}
    (tmp_path / "costs.csv").write_text("1\n")
    plan, _ = plan_map(tmp_path / "map.json", [tmp_path / "costs.csv"], options)
    assert plan.request.keys() == {"occupancy_grid", "spacing", "cost_layer", "start_pose"}
    assert plan.request["occupancy_grid"] == {"info": {}, "data": [0]}
    assert plan.request["start_pose"] == [-1.0, 2.5]


def test_robots_share_a_map_without_a_second_objective(tmp_path: Path) -> None:
    (tmp_path / "map.png").write_bytes(b"PNG")
    options = {"cell_size": 1.0, "spacing": 2.0}
    plan, _ = plan_map(tmp_path / "map.png", [], options, robots=["-1,2.5", "3,4,1.57"])
    assert plan.request["robots"] == [
        {"id": "robot-1", "start_pose": [-1.0, 2.5]},
        {"id": "robot-2", "start_pose": [3.0, 4.0, 1.57]},
    ]
    with pytest.raises(UsageError, match="--robot must be numbers with commas between, got '1;2'"):
        plan_map(tmp_path / "map.png", [], options, robots=["1;2"])


def test_ids_of_cities_come_beside_the_plan(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("depot,1,2,3,4\nb,5,6,7,8\n")
    assert plan_cities([tmp_path / "a.csv"], options={})[1] == ("depot", "b")


@pytest.mark.parametrize(
    ("given", "start"), [("2", 2), ("b", 1), ("5", 0), (None, None), ("x", "x")]
)
def test_a_start_is_an_index_or_an_id(tmp_path: Path, given: str | None, start: object) -> None:
    file = tmp_path / "a.csv"
    file.write_text("id,x1,y1,x2,y2\n5,1,2,3,4\nb,1,2,3,4\nc,1,2,3,5\n")
    plan, _ = plan_cities([file], options={"start": given})
    assert plan.request.get("start") == start


def test_a_request_with_stops_is_a_plan(tmp_path: Path) -> None:
    request = {"stops": [{"id": "depot"}], "objectives": [{"name": "a"}, {"name": "b"}]}
    (tmp_path / "stops.json").write_text(json.dumps(request))
    plan, ids = plan_cities([tmp_path / "stops.json"], options={"start": "depot"})
    assert ids == ("depot",)
    assert json.loads(plan.json) == {**request, "start": 0}
