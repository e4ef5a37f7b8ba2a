"""Objectives that are times along straight lines at a speed: their costs, storage and refusals."""

import io
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.kinds.parsing import parse_task
from service.objectives import Objective
from service.requests.fleet import parse_fleet_request
from service.requests.front import parse_front_request
from service.requests.stops import Measured, cost_matrices
from service.requests.task import TaskKind, TaskSource
from service.requests.task_codec import decode_task, encode_task
from tests.helpers.actors import info_of
from tests.helpers.serving import LIMITS
from tests.helpers.straight_lines import matrix_of

PLACES = [[24.94, 60.17], [24.95, 60.171], [24.952, 60.18], [24.9, 60.16]]
COSTS = [[0, 1, 2, 3], [4, 0, 5, 6], [7, 8, 0, 9], [1, 2, 3, 0]]
STOPS = [{"id": f"{i}", "location": place} for i, place in enumerate(PLACES)]
WAY = {"name": "way", "from": "great_circle"}
TIME = {"name": "time", "from": "great_circle", "speed": 30}
ROADS = replace(LIMITS, roads=True)
ACTORS = {"pa-one-matrix": info_of("pa-one-matrix", "matrices")}


def body(second: dict[str, Any], **members: Any) -> bytes:
    return json.dumps({"stops": STOPS, "objectives": [WAY, second], **members}).encode()


@pytest.mark.parametrize("speed", [30, 4.5, 0.001, 1000])
@pytest.mark.parametrize("unit", [{}, {"unit": None}, {"unit": "s"}])
def test_straight_lines_become_seconds_at_a_speed(speed: float, unit: dict[str, Any]) -> None:
    request = parse_front_request(body({**TIME, "speed": speed, **unit}), LIMITS)
    assert request.labels is not None
    assert request.labels.objectives == (Objective("way", "m"), Objective("time", "s"))
    expected = [matrix_of(PLACES), matrix_of(PLACES, speed)]
    np.testing.assert_allclose(request.subject.instance.matrices, expected, rtol=1e-9)


def test_a_speed_of_null_is_none() -> None:
    request = parse_front_request(body({**TIME, "speed": None}), LIMITS)
    assert request.labels is not None
    assert request.labels.objectives[1].unit == "m"
    assert request.subject.sources[1] == Measured("great_circle")


def test_a_fleet_has_the_seconds_at_a_speed() -> None:
    content = body({**TIME, "over": "max"}, vehicles=[{"id": "van", "start": 0}], clock="time")
    fleet = parse_fleet_request(content, LIMITS).subject().fleet()
    np.testing.assert_allclose(fleet.costs[1], matrix_of(PLACES, 30), rtol=1e-9)
    assert fleet.rules.clock == 1


def test_a_stored_task_keeps_its_speed_and_one_of_a_version_without_speeds_has_none() -> None:
    task = parse_task(TaskSource("front", body(TIME)), LIMITS, ACTORS)
    again = decode_task(encode_task(task))
    assert again.stops is not None
    assert again.stops.sources == (Measured("great_circle"), Measured("great_circle", 30.0))
    np.testing.assert_allclose(cost_matrices(again.stops)[1], matrix_of(PLACES, 30), rtol=1e-9)
    without = encode_task(
        parse_task(TaskSource("front", body({**WAY, "name": "b"})), LIMITS, ACTORS)
    )
    member = b',"speed":null'
    assert without.count(member) == 2
    old = decode_task(without.replace(member, b" " * len(member)))
    assert old.stops is not None
    assert old.stops.sources == (Measured("great_circle"), Measured("great_circle"))


NEEDS = "objectives/1/speed needs from great_circle, got"


@pytest.mark.parametrize("kind", ["front", "fleet"])
@pytest.mark.parametrize(
    ("changes", "pointer", "sentence"),
    [
        ({"from": "road_time"}, "speed", f"{NEEDS} from road_time"),
        ({"from": "road_distance", "unit": "m"}, "speed", f"{NEEDS} from road_distance"),
        ({"from": None, "matrix": COSTS}, "speed", f"{NEEDS} matrix"),
        ({"from": None, "coordinates": PLACES}, "speed", f"{NEEDS} coordinates"),
        ({"from": None}, "speed", f"{NEEDS} no source"),
        ({"unit": "m"}, "unit", 'must be s, the unit of great_circle at a speed, got "m"'),
        ({"speed": 0}, "speed", "objectives/1/speed must be at least 0.001, got 0"),
        ({"speed": -30}, "speed", "objectives/1/speed must be at least 0.001, got -30"),
        ({"speed": 1e-300}, "speed", "objectives/1/speed must be at least 0.001"),
        ({"speed": 1000.5}, "speed", "objectives/1/speed must be at most 1000, got 1000.5"),
        ({"speed": 10**400}, "speed", "objectives/1/speed must be"),
        ({"speed": "30"}, "speed", "objectives/1/speed must be a valid number"),
        ({"speed": True}, "speed", "objectives/1/speed must be a valid number"),
        ({"speed": [30]}, "speed", "objectives/1/speed must be a valid number"),
    ],
)
@pytest.mark.parametrize("limits", [LIMITS, ROADS], ids=["no roads", "roads"])
def test_a_speed_that_does_not_fit_is_pointed_at(
    kind: TaskKind, changes: dict[str, Any], pointer: str, sentence: str, limits: Any
) -> None:
    second = {name: each for name, each in {**TIME, **changes}.items() if each is not None}
    vans = {} if kind == "front" else {"vehicles": [{"id": "van"}]}
    with pytest.raises(Refusal) as refused:
        parse_task(TaskSource(kind, body(second, **vans)), limits, ACTORS)
    assert (refused.value.status, refused.value.code) == (422, "invalid-request")
    assert [each.pointer for each in refused.value.errors] == [f"/objectives/1/{pointer}"]
    assert sentence in refused.value.detail


def test_costs_in_a_file_have_no_speed() -> None:
    stream = io.BytesIO()
    np.save(stream, np.array([COSTS, COSTS], dtype=np.float64))
    content = json.dumps(
        {"stops": STOPS, "objectives": [{"name": "a"}, {"name": "b", "speed": 30}]}
    ).encode()
    with pytest.raises(Refusal, match="objectives/1/speed needs from great_circle, got no source"):
        parse_front_request(content, LIMITS, stream.getvalue())


def test_every_stop_needs_a_location_for_a_speed() -> None:
    content = body(TIME, stops=[*STOPS[:3], {"id": "nowhere"}])
    with pytest.raises(Refusal, match="stops/3/location is required by objectives/0/from"):
        parse_front_request(content, LIMITS)
