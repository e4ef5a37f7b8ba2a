"""A task is the same after it was written and read, and damage is told."""

import json
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

from service.kinds.parsing import parse_replan, parse_task
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource
from service.requests.task import Task, TaskKind, TaskSource
from service.requests.task_codec import decode_task, encode_task
from tests.helpers.actors import info_of
from tests.helpers.changes import random_change
from tests.helpers.sampled import third

LIMITS = Limits(
    body_bytes=2**20, cities=50, cells=100, preferences=99, size=99, seconds=9, roads=True
)
INFOS = {kind: info_of(kind, kind) for kind in ("coordinates", "matrices")}
COSTS = [[0, 1, None], [2, 0, 3], [4, 5, 0]]
STOPS = [{"id": name, "location": [24.9 + i / 100, 60.1]} for i, name in enumerate("äb#")]
OBJECTIVES = [{"name": "t", "unit": "s", "from": "road_time"}, {"name": "r", "matrix": COSTS}]
RUSH = [{**OBJECTIVES[0], "over_the_day": [[0, 1], [9, 2]]}]
SLICED = [{"name": "s", "slices": [{"from": 0, "matrix": COSTS}, {"from": 5, "matrix": COSTS}]}]
BY_PAIR = [
    {
        "name": "b",
        "breakpoints": [
            [[[k, 9 - k] for k in range(i + j)] or None for i in range(3)] for j in range(3)
        ],
    }
]
SPREAD = [
    {**OBJECTIVES[0], "spread": COSTS, "percentile": 90},
    {"name": "d", "days": [{"matrix": COSTS}, {"matrix": COSTS}], "percentile": 75},
]
SERVED = [STOPS[0], {**STOPS[1], "service": 3}, STOPS[2]]
DAY = {"departure": {"earliest": 1, "latest": 4}, "clock": "t", "preferences": 3}
ROUTE = {"closed": False, "start": None, "end": "b", "arrivals": True, "geometry": "roads"}
GRID = {"grid": [[0, 0, 1], [0, 0, 0]], "cell_size": 0.5, "origin": [1, 2, 0.5], "paths": True}
PLACES = {"places": [[0, 0], [1, 2], [1, 0]], "cost_layer": [[1, 2, 3]] * 2}
LAID_OUT = {"spacing": 0.5, "start_pose": [1.2, 2.2], "cost_layer": [[1, 2, 3]] * 2}
ROBOTS = {"robots": [{"id": "r", "start": 1}, {"id": "s", "start_pose": [1.2, 2.2]}]}
VISITS = [STOPS[0], {**STOPS[1], "demand": [1], "window": [0, 9]}, {**STOPS[2], "prize": 9}]
VAN = {"id": "van", "count": 2, "start": 0, "capacity": [3], "shift": [0, 99]}
FLEET = {"stops": VISITS, "vehicles": [VAN], "objectives": OBJECTIVES, "clock": "t"}
PAIR = {"shipments": [{"pickup": "b", "delivery": "#"}]}
SHARED = {"stops": STOPS, "vehicles": [{"id": "v"}], "objectives": OBJECTIVES, **PAIR}
REQUESTS: list[tuple[TaskKind, dict[str, Any]]] = [
    ("front", {"coordinates": np.eye(4).tolist(), "initial_tours": [[0, 2, 1, 3]]}),
    ("front", {"matrices": [COSTS, COSTS], "preferences": [10, 80], "reference_point": [99, 99]}),
    ("front", {"stops": STOPS, "objectives": OBJECTIVES, **ROUTE}),
    ("front", {"stops": SERVED, "objectives": RUSH + SLICED + BY_PAIR, **DAY}),
    ("front", {"stops": STOPS, "objectives": SPREAD}),
    ("coverage", {**GRID, **PLACES, "closed": False, "end": 1}),
    ("coverage", {**GRID, **LAID_OUT}),
    ("coverage", {**GRID, **PLACES, **ROBOTS, "over": ["max", "sum"]}),
    ("fleet", FLEET),
    ("fleet", SHARED),
    ("fleet", {**FLEET, "objectives": SPREAD[1:] + OBJECTIVES[1:], "clock": "d"}),
]


def same(one: Any, other: Any) -> bool:
    """Whether two values are the same, member by member; a list is the same as a tuple."""
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, other, equal_nan=True)) and one.dtype == other.dtype
    if is_dataclass(one):
        names = [each.name for each in fields(one)]
        alike = all(same(getattr(one, name), getattr(other, name)) for name in names)
        return type(one) is type(other) and alike
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


def is_kept(task: Task) -> bool:
    return same(task, decode_task(encode_task(task)))


def task_of(kind: TaskKind, request: dict[str, Any]) -> Task:
    return parse_task(TaskSource(kind, json.dumps(request).encode()), LIMITS, INFOS)


@pytest.mark.parametrize(("kind", "request_"), REQUESTS)
def test_a_task_is_the_same_once_it_was_written_and_read(
    kind: TaskKind, request_: dict[str, Any]
) -> None:
    assert is_kept(task_of(kind, request_))


def test_the_rest_of_a_way_is_the_same_once_it_was_written_and_read() -> None:
    for seed in range(third(80)):
        change = random_change(seed)
        body = json.dumps({**change.request, "arrivals": True, "seed": seed}).encode()
        assert is_kept(parse_replan(ReplanSource(body, change.front), LIMITS, INFOS))


def test_what_an_earlier_version_did_not_write_of_vehicles_has_its_default() -> None:
    task = task_of("fleet", FLEET)
    line, rest = encode_task(task).split(b"\n", 1)
    length = int.from_bytes(rest[:8])
    header = json.loads(rest[8 : 8 + length])
    for row in header["subject"]["rules"]["vehicles"]["$rows"]:
        del row[-6:]
    shorter = json.dumps(header).encode()
    old = line + b"\n" + len(shorter).to_bytes(8) + shorter + rest[8 + length :]
    assert same(task, decode_task(old))


def test_damage_is_told() -> None:
    rng = np.random.default_rng(0)
    for request in (REQUESTS[0], REQUESTS[4], REQUESTS[6]):
        content = encode_task(task_of(*request))
        for _ in range(200):
            with pytest.raises(ValueError, match="the task is"):
                decode_task(content[: rng.integers(len(content))])
            damaged = bytearray(content)
            damaged[rng.integers(len(content))] ^= 1 << rng.integers(8)
            try:
                decode_task(bytes(damaged))
            except ValueError:
                continue
