"""Fleets of extreme numbers: each is planned, or refused with a reason."""

import json
import random
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.fleet.evaluation import plan_lengths, violations
from service.fleet.plans import Plan, Route
from service.jobs.task_runner import TaskRunner
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource, UnmeasuredFleet
from tests.fuzz.fleets import bounded_fleet, extreme_fleet
from tests.helpers.fleet_requests import LIMITS
from tests.helpers.sampled import sixth

NUMBERS = [0.0, 1.0, 3.5, 0.1, 123456.789, 7e16, *(10.0**each for each in (-300, -150, -9, 9, 150))]


def extreme_request(seed: int) -> dict[str, Any]:
    """Return a request of up to eleven stops with numbers of any size in every field."""
    generator = np.random.default_rng(seed)
    n = int(generator.integers(2, 12))
    clock = ["a", "b", None][generator.integers(3)]

    def number() -> float:
        return float(generator.choice(NUMBERS))

    def given(**members: Any) -> dict[str, Any]:
        return {name: value for name, value in members.items() if generator.random() < 0.3}

    def stop(index: int) -> dict[str, Any]:
        timed = given(window=sorted((number(), number())), service=number()) if clock else {}
        return {"id": str(index), **given(demand=[10**9], prize=number()), **timed}

    unit = number()
    whole = (unit * generator.integers(0, 5, (2, n, n))).tolist()
    mixed = [[[number() for _ in range(n)] for _ in range(n)] for _ in range(2)]
    first, second = whole if seed % 2 else mixed
    shift = given(shift=sorted((number(), number()))) if clock else {}
    vehicle = {"id": "v", "count": 10**6, "capacity": [10**9], **given(start=0), **shift}
    return {
        "stops": [{"id": "0"}, *(stop(index) for index in range(1, n))],
        "vehicles": [{**vehicle, **given(fixed=number(), longest=number() or 1.0)}],
        "objectives": [
            {"name": "a", "matrix": first},
            {"name": "b", "matrix": second, "over": ["sum", "max"][generator.integers(2)]},
        ],
        "clock": clock,
        "time_limit": 0.02,
    }


@pytest.mark.parametrize("seed", range(sixth(60)))
def test_extreme_numbers_are_planned_or_refused(seed: int) -> None:
    check(TaskSource("fleet", json.dumps(extreme_request(seed)).encode()))


@pytest.mark.parametrize("seed", [47, 390, 3924, 5727, 6846, 6866])
def test_legs_of_almost_no_cost_beside_outliers_are_planned_or_refused(seed: int) -> None:
    """Their typical leg is below the least normal double."""
    check(extreme_fleet(random.Random(seed)))


@pytest.mark.parametrize("seed", range(sixth(60)))
def test_bounds_of_any_size_are_kept_or_refused(seed: int) -> None:
    check(bounded_fleet(random.Random(seed)))


def check(source: TaskSource) -> None:
    """Check that a fleet gets a front of feasible plans, or is refused with a reason."""
    try:
        task = parse_task(source, LIMITS, {})
        document = TaskRunner({}, LIMITS).run(task, lambda: False, lambda *_: None)
    except Refusal:
        return  # its status is that of the table, and none of it is 500
    front = json.loads(document.json())["front"]
    assert front
    assert np.isfinite([plan["lengths"] for plan in front]).all()
    subject = task.subject
    assert isinstance(subject, UnmeasuredFleet)
    fleet = subject.fleet()
    for plan in front:
        found = Plan(tuple(route_of(subject, each) for each in plan["routes"]))
        assert violations(fleet, found) == []
        assert np.allclose(plan_lengths(fleet, found), plan["lengths"], rtol=1e-12)


def route_of(subject: UnmeasuredFleet, route: dict[str, Any]) -> Route:
    """Return a route of an answer, whose stops have their numbers as ids."""
    names = [(name.id, name.shift) for name in subject.vehicles]
    number = names.index((route["vehicle"], route.get("shift")))
    vehicle = subject.rules.vehicles[number]
    stops = tuple(map(int, route["stops"]))
    first = 0 if vehicle.start is None else 1
    return Route(number, stops[first : len(stops) - (vehicle.end is not None)])
