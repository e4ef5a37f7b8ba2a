"""The JSON of planners and routing engines that is not read: it is refused by its name."""

import json
from typing import Any

import pytest
from pydantic_core import to_json

from service.files.planners.others import refuse_others
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Source, UnreadableFile
from tests.files.test_examples import EARTH, FOLDER, OTHERS, read

PLACE = {"lat": 60.17, "lon": 24.94}
OTHER_JSON: list[tuple[str, dict[str, Any]]] = [
    ("Timefold's", {"modelInput": {"vehicles": [], "visits": []}, "config": {}}),
    ("Timefold's", {"name": "demo", "vehicles": [{"id": "1"}], "visits": [{"id": "1"}]}),
    (
        "Timefold's",
        {"southWestCorner": [1, 2], "northEastCorner": [3, 4], "customers": [], "depots": []},
    ),
    (
        "GraphHopper's",
        {
            "vehicles": [{"vehicle_id": "v", "start_address": {"location_id": "d", **PLACE}}],
            "services": [{"id": "s", "address": {"location_id": "s", **PLACE}}],
        },
    ),
    ("GraphHopper's", {"vehicle_types": [{"type_id": "t"}], "shipments": [], "vehicles": []}),
    (
        "Routific's",
        {
            "visits": {"order_1": {"location": {"name": "a", "lat": 60.17, "lng": 24.94}}},
            "fleet": {"vehicle_1": {"start_location": {"id": "depot"}}},
        },
    ),
    ("Routific's", {"routeScenario": {"stops": [], "vehicles": []}}),
    (
        "Google Route Optimization's",
        {"model": {"shipments": [{"deliveries": []}], "vehicles": [{}]}, "timeout": "5s"},
    ),
    ("OptimoRoute's", {"orders": [{"operation": "CREATE", "orderNo": "1", "duration": 5}]}),
    ("HERE Tour Planning's", {"fleet": {"types": []}, "plan": {"jobs": []}}),
    ("cuOpt's", {"cost_matrix_data": {}, "fleet_data": {}, "task_data": {}}),
    ("Geoapify's", {"mode": "drive", "agents": [{}], "jobs": [{}]}),
    ("Mapbox's", {"version": 1, "locations": [{}], "vehicles": [{}], "services": [{}]}),
    ("NextBillion's", {"locations": {"location": ["1,2|3,4"]}, "vehicles": [{}], "jobs": [{}]}),
    ("OR-Tools'", {"distance_matrix": [[0, 1], [1, 0]], "num_vehicles": 1, "depot": 0}),
    ("OR-Tools'", {"time_matrix": [[0, 1], [1, 0]], "time_windows": [[0, 5]], "num_vehicles": 1}),
    (
        "a routing engine's matrix",
        {"code": "Ok", "durations": [[0, 1], [1, 0]], "sources": [{}], "destinations": [{}]},
    ),
    ("a routing engine's request", {"locations": [PLACE, PLACE], "costing": "auto"}),
    ("a routing engine's request", {"locations": [[24.9, 60.1]], "metrics": ["distance"]}),
    ("a routing engine's request", {"sources": [PLACE], "targets": [PLACE], "costing": "auto"}),
    (
        "Openrouteservice's directions",
        {"coordinates": [[24.9, 60.1], [24.8, 60.2]], "elevation": True},
    ),
    ("VROOM's answer", {"code": 0, "summary": {}, "routes": [], "unassigned": []}),
]


@pytest.mark.parametrize(("name", "value"), OTHER_JSON)
def test_another_planner_is_named_with_what_to_do(name: str, value: dict[str, Any]) -> None:
    with pytest.raises(UnreadableFile) as refused:
        read_files([NamedFile("a.json", json.dumps(value).encode())], Bounds(), wanted=None)
    assert f"got {name} JSON, which is not read: " in str(refused.value)
    assert str(refused.value).rpartition(": ")[2].startswith(("write its", "bring the"))


@pytest.mark.parametrize("names", sorted({*EARTH, *OTHERS}))
def test_no_request_is_taken_for_that_of_another_planner(names: str) -> None:
    request = read(names).request
    refuse_others(Source(NamedFile("a.json", b""), Bounds()), json.loads(to_json(request)))


def test_a_problem_of_openrouteservice_is_that_of_vroom() -> None:
    value = json.loads((FOLDER / "vroom.json").read_text())
    value["options"] = {"g": True}
    reading = read_files([NamedFile("a.json", json.dumps(value).encode())], Bounds(), wanted=None)
    assert reading.kind == "fleet"
    assert any("options of the problem" in note.text for note in reading.notes)
