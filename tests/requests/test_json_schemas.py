"""The schemas of requests, as OpenAPI has them: which members go together, under which limits."""

from dataclasses import replace
from functools import cache
from typing import Any

import jsonschema_rs
import pytest

from service.api.request_bodies import request_schemas
from tests.helpers.serving import LIMITS

CITIES = {"coordinates": [[0, 0, 0, 0]] * 2}
MATRICES = {"matrices": [[[0, 1], [1, 0]]] * 2}
WAY = {"name": "way", "from": "great_circle"}
MATRIX = {"name": "risk", "matrix": [[0, 1], [1, 0]]}
IN_A_FILE = {"name": "risk", "unit": "%"}
STOPS = {"stops": [{"id": "a"}, {"id": "b"}], "objectives": [WAY, MATRIX]}
ONLY_STOPS = {"stops": STOPS["stops"]}


@cache
def schemas(traffic: bool = False) -> dict[str, Any]:
    """The components of the OpenAPI document."""
    return request_schemas(replace(LIMITS, roads=traffic, traffic=traffic), ["pa-one"])


def fits(name: str, value: Any, traffic: bool = False) -> bool:
    """Whether a value fits a component of the OpenAPI document."""
    document = {"$ref": f"#/components/schemas/{name}", "components": {"schemas": schemas(traffic)}}
    return jsonschema_rs.is_valid(document, value)


@pytest.mark.parametrize("request_", [CITIES, MATRICES, STOPS, {**STOPS, "departure": 0}])
def test_a_request_has_one_form(request_: dict[str, Any]) -> None:
    assert fits("FrontRequest", {**request_, "start": 1})


@pytest.mark.parametrize(
    "request_",
    [
        {},
        {**CITIES, **MATRICES},
        {**CITIES, **STOPS},
        {**CITIES, **ONLY_STOPS},
        {**CITIES, "objectives": [WAY, MATRIX]},
        {**CITIES, "departure": 0},
        {**MATRICES, **STOPS},
        ONLY_STOPS,
        {**CITIES, "unknown": 1},
    ],
)
def test_a_request_of_no_form_or_two_does_not_fit(request_: dict[str, Any]) -> None:
    assert not fits("FrontRequest", request_)


def test_beside_a_file_neither_requests_nor_objectives_have_costs() -> None:
    named = {**ONLY_STOPS, "objectives": [IN_A_FILE, IN_A_FILE]}
    assert fits("FrontFileRequest", {})
    assert fits("FrontFileRequest", named)
    for other in (CITIES, MATRICES, STOPS, ONLY_STOPS):
        assert not fits("FrontFileRequest", other)


@pytest.mark.parametrize(
    ("name", "objective", "fit"),
    [
        ("DayObjectiveItem", MATRIX, True),
        ("DayObjectiveItem", {"name": "x", "coordinates": [[0, 0]]}, True),
        ("DayObjectiveItem", {**WAY, "speed": 5, "over_the_day": [[0, 1]]}, True),
        ("DayObjectiveItem", {**WAY, "traffic": {"date": "2026-11-27", "at": [0]}}, False),
        ("DayObjectiveItem", IN_A_FILE, False),
        ("DayObjectiveItem", {**WAY, **MATRIX}, False),
        ("DayObjectiveItem", {**MATRIX, "speed": 5}, False),
        ("DayObjectiveItem", {"name": "x", "slices": [], "over_the_day": []}, False),
        ("DayObjectiveItem", {"name": "x", "from": "road_time"}, False),
        ("FleetObjectiveItem", {**WAY, "over": "max"}, True),
        ("FleetObjectiveItem", {"name": "x", "measure": "vehicles"}, True),
        ("FleetObjectiveItem", {"name": "x", "measure": "vehicles", "over": "max"}, False),
        ("FleetObjectiveItem", {**WAY, "measure": "vehicles"}, False),
        ("ClockItem", {"from": "great_circle"}, True),
        ("ClockItem", {}, False),
    ],
)
def test_an_objective_has_one_source(name: str, objective: dict[str, Any], fit: bool) -> None:
    assert fits(name, objective) == fit


@pytest.mark.parametrize(
    ("source", "fit"), [("road_time", True), ("road_distance", False), ("great_circle", False)]
)
def test_traffic_is_of_times_by_road(source: str, fit: bool) -> None:
    objective = {"name": "x", "from": source}
    assert fits("DayObjectiveItem", objective, traffic=True)
    traffic = {"traffic": {"date": "2026-11-27", "at": [0]}}
    assert fits("DayObjectiveItem", {**objective, **traffic}, traffic=True) == fit


def test_every_reference_leads_to_a_schema_and_no_default_is_null() -> None:
    def check(value: Any) -> None:
        if isinstance(value, dict):
            assert value.get("default", 0) is not None
            if "$ref" in value:
                assert value["$ref"].removeprefix("#/components/schemas/") in schemas()
        if isinstance(value, dict | list):
            for each in value.values() if isinstance(value, dict) else value:
                check(each)

    check(schemas())


def test_the_schemas_have_the_limits_and_the_actors() -> None:
    fields = schemas()["FrontRequest"]["properties"]
    for rows in (fields["coordinates"], fields["matrices"]["items"], fields["stops"]):
        assert rows["maxItems"] == LIMITS.cities
    assert fields["actor"]["enum"] == ["pa-one"]
    assert fields["repairs"]["maximum"] == LIMITS.repairs
    assert "default" not in fields["repairs"]  # it depends on the time limit
    assert fields["augment"]["deprecated"] is True
