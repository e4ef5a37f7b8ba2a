"""Fleets whose legs are straight lines: as good as with matrices, and many times as large."""

import json
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.fleet.evaluation import violations
from service.fleet.fleet import Array, Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.necessary import least_lengths
from service.fleet.planner import plan_fleet
from service.fleet.rules import Rules
from service.fleet.search.search import RuinSearch
from service.fleet.straight import Line
from service.fleet.vehicles import VehicleType, Visit
from service.kinds.parsing import parse_task
from service.requests.task import Task, TaskSource, UnmeasuredFleet
from service.roads.great_circle import EARTH_RADIUS, great_circle_matrix
from service.watch import Watch
from tests.helpers.fleet_requests import LIMITS

BY_ROAD = {"name": "time", "from": "road_time", "unit": "s"}
LARGE = 1001  # stops of a fleet, more than matrices may have


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_lines_in_a_plane_are_distances(size: float) -> None:
    points = size * np.random.default_rng(1).uniform(-1, 1, (30, 2))
    steps = points[:, np.newaxis] - points
    expected = np.hypot(steps[..., 0], steps[..., 1])
    stops = np.arange(30)
    np.testing.assert_allclose(
        Line.in_plane(points).legs(stops[:, np.newaxis], stops), expected, rtol=1e-12
    )


def test_lines_on_earth_are_great_circles() -> None:
    random = np.random.default_rng(2)
    locations = np.column_stack((random.uniform(-180, 180, 30), random.uniform(-90, 90, 30)))
    locations[:8] = locations[0] + 1e-4 * random.random((8, 2))  # some metres apart
    stops = np.arange(30)
    found = Line.on_earth(locations, EARTH_RADIUS).legs(stops[:, np.newaxis], stops)
    np.testing.assert_allclose(found, great_circle_matrix(locations), rtol=1e-8, atol=1e-6)


def fleets(seed: int) -> tuple[Fleet, Fleet]:
    """Return a fleet with all kinds of times, by lines and by matrices."""
    random = np.random.default_rng(seed)
    points = random.random((40, 2))
    lines = [Line.in_plane(points), Line.on_earth(25 + points, 100.0)]
    visits = [
        Visit(
            demand=(int(random.integers(1, 9)),),
            service=0.1,
            windows=((0.0, 4.0 + 4 * random.random()),),
            due=3.0,
        )
        for _ in range(len(points) - 1)
    ]
    vans = VehicleType(start=0, end=0, count=3, capacity=(60,), shift=(0.0, 12.0))
    rules = Rules(
        visits=(Visit(demand=(0,)), *visits),
        vehicles=(vans, replace(vans, end=None, max_overtime=2.0)),
        over=(("sum", "max"), ("sum", "lateness"), ("sum", "overtime", "vehicles"))[seed % 3],
        layers=(0, 1, 0)[: 3 if seed % 3 == 2 else 2],
        clock=seed % 2,
    )
    straight = Fleet.of_lines(rules, lines)
    return straight, Fleet(rules=rules, costs=straight.matrices())


@pytest.mark.parametrize("seed", range(6))
def test_a_fleet_by_lines_has_the_front_of_the_same_fleet_by_matrices(seed: int) -> None:
    straight, stored = fleets(seed)
    np.testing.assert_allclose(straight.scale, stored.scale, rtol=1e-9)
    np.testing.assert_allclose(least_lengths(straight), least_lengths(stored), rtol=1e-9)
    np.testing.assert_allclose(searched(straight), searched(stored), rtol=1e-7, atol=1e-9)


def searched(fleet: Fleet) -> Array:
    options = FleetOptions(time_limit=inf, iterations=20)
    search = RuinSearch(fleet, options, Watch())
    search.run()
    assert not any(violations(fleet, search.plan_at(index)) for index in range(len(search)))
    return search.points


def large(**changes: Any) -> dict[str, Any]:
    """Return a request of many stops."""
    random = np.random.default_rng(3)
    stops = [
        {"id": str(i), "location": place, "demand": [1]}
        for i, place in enumerate((25 + random.random((LARGE, 2))).tolist())
    ]
    return {
        "stops": [{"id": "depot", "location": [25.5, 25.5]}, *stops[1:]],
        "vehicles": [
            {"id": "van", "count": 50, "start": "depot", "end": "depot", "capacity": [25]}
        ],
        "objectives": [
            {"name": "distance", "from": "great_circle", "unit": "m"},
            {"name": "time", "from": "great_circle", "speed": 30, "unit": "s", "over": "max"},
        ],
        "time_limit": 0.2,
        **changes,
    }


def task_of(request: dict[str, Any]) -> Task:
    limits = replace(LIMITS, body_bytes=10**7, cities=10**4)
    return parse_task(TaskSource("fleet", json.dumps(request).encode()), limits, {})


def test_a_large_fleet_is_planned_without_matrices() -> None:
    task = task_of(large())
    assert isinstance(task.subject, UnmeasuredFleet)
    fleet = task.subject.fleet()
    assert fleet.costs.size == 0
    front = plan_fleet(fleet, FleetOptions(time_limit=0.2))
    visits = [sum(len(route.stops) for route in plan.routes) for plan in front.plans]
    assert set(visits) == {LARGE - 1}


@pytest.mark.parametrize(
    ("changes", "code", "pointer"),
    [
        (
            {"objectives": [BY_ROAD, {"name": "vehicles", "measure": "vehicles"}]},
            "too-many-cities",
            "/stops",
        ),
        ({"time_limit": 0}, "too-many-for-network", "/time_limit"),
    ],
)
def test_a_large_fleet_needs_straight_lines_and_a_search(
    changes: dict[str, Any], code: str, pointer: str
) -> None:
    with pytest.raises(Refusal) as refused:
        task_of(large(**changes))
    assert (refused.value.code, refused.value.limit) == (code, LIMITS.matrix_cities)
    assert refused.value.document("")["errors"][0]["pointer"] == pointer
