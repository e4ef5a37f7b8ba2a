"""Why plans leave stops out: prices and reasons against all insertions."""

from collections.abc import Iterator
from math import inf

import numpy as np
import pytest

from service.fleet.evaluation import plan_lengths, unassigned, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.left_out import explain, with_stop
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit
from tests.helpers.fleets import bounded_fleet, exact_front
from tests.helpers.sampled import sixth


def insertions(fleet: Fleet, plan: Plan, stop: int) -> Iterator[Plan]:
    """Yield every plan with a stop inserted, also into a route of its own."""
    for number, route in enumerate(plan.routes):
        for place in range(len(route.stops) + 1):
            stops = (*route.stops[:place], stop, *route.stops[place:])
            longer = Route(route.vehicle, stops)
            yield Plan((*plan.routes[:number], longer, *plan.routes[number + 1 :]))
        for reload in fleet.rules.vehicles[route.vehicle].reload:
            longer = Route(route.vehicle, (*route.stops, reload, stop))
            yield Plan((*plan.routes[:number], longer, *plan.routes[number + 1 :]))
    for vehicle, kind in enumerate(fleet.rules.vehicles):
        for first in [(), *((reload,) for reload in kind.reload)]:
            yield Plan((*plan.routes, Route(vehicle, (*first, stop))))


@pytest.mark.parametrize("seed", range(sixth(60)))
def test_a_stop_left_out_has_a_price_if_a_plan_can_serve_it_and_reasons_if_none(seed: int) -> None:
    fleet = bounded_fleet(seed)
    if not exact_front(fleet):
        return
    front = plan_fleet(fleet, FleetOptions(time_limit=inf))
    explained = explain(fleet, front.plans, front.points)
    left_out = [unassigned(fleet.rules, plan) for plan in front.plans]
    assert [[each.stop for each in servings] for servings in explained] == left_out
    fullest = min(front.plans, key=lambda plan: len(unassigned(fleet.rules, plan)))
    for point, servings in zip(front.points, explained, strict=True):
        for serving in servings:
            if serving.plan is not None:
                assert serving.stop not in left_out[serving.plan]
                assert serving.price == tuple(front.points[serving.plan] - point)
                continue
            assert all(serving.stop in stops for stops in left_out)
            possible = [
                np.subtract(plan_lengths(fleet, plan), plan_lengths(fleet, fullest))
                for plan in insertions(fleet, fullest, serving.stop)
                if not violations(fleet, plan)
            ]
            assert (serving.price is None) == (not possible) == bool(serving.reasons)
            if serving.price is not None:
                assert any(np.allclose(serving.price, price) for price in possible)


LINE = np.abs(np.subtract.outer([0.0, 1, 2, 3], [0.0, 1, 2, 3]))
OPTIONAL = Visit(prize=1)
REASONS = [
    ({"visits": [Visit(prize=1, skills=("cold",))]}, "skills", "lacks the skill cold"),
    ({"visits": [Visit(prize=1, vehicles=(1,))]}, "vehicle", "is not the one that the stop names"),
    ({"visits": [Visit(prize=1, demand=(4,))]}, "capacity", "holds 4 of 3"),
    ({"visits": [Visit(prize=1, windows=((0.0, 0.5),))]}, "window", "is late by 0.5"),
    ({"vehicle": {"shift": (0, 1)}}, "shift", "is late by 1"),
    ({"vehicle": {"longest": 1}}, "longest", "has a route of 2, longer than 1"),
]


@pytest.mark.parametrize(("change", "rule", "detail"), REASONS)
def test_each_reason_names_the_rule_and_the_numbers(
    change: dict[str, object], rule: str, detail: str
) -> None:
    first = change.get("visits", [OPTIONAL])
    vehicle = {"start": 0, "end": 0, "capacity": (3,), **change.get("vehicle", {})}
    types = (VehicleType(**vehicle), VehicleType(start=3, end=3, capacity=(0,), shift=(0, 0.1)))
    rules = Rules(visits=(Visit(), *first, OPTIONAL, Visit()), vehicles=types, clock=0)
    fleet = Fleet(rules=rules, costs=np.stack([LINE, LINE]))
    nobody = Plan(())
    (servings,) = explain(fleet, [nobody], np.array([plan_lengths(fleet, nobody)]))
    (reason, *_) = servings[0].reasons
    assert (reason.vehicle, reason.broken.rule, reason.broken.detail) == (0, rule, detail)


def test_a_stop_that_gives_more_than_it_gets_fits_after_others_have_got_theirs() -> None:
    rules = Rules(
        visits=(Visit(), Visit(demand=(2,)), Visit(demand=(2,), pickup=(5,))),
        vehicles=(VehicleType(start=0, end=0, capacity=(6,)),),
    )
    fleet = Fleet(rules=rules, costs=np.ones((2, 3, 3)))
    assert with_stop(fleet, Plan((Route(0, (1,)),)), 2) == Plan((Route(0, (1, 2)),))
