"""Times that are equal but for a rounding: no rule is broken by it, and no window is missed."""

from math import inf, nextafter
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.fleet.evaluation import measures, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan, Route
from service.fleet.rounding import is_over
from service.fleet.rules import Rules
from service.fleet.schedule import schedule
from service.fleet.vehicles import VehicleType, Visit

LEG, SUM = 0.1, 0.1 + 0.1 + 0.1  # three legs take 0.30000000000000004
BOTH = Route(0, (1, 2))


def fleet_of(first: dict[str, Any], second: dict[str, Any], vehicle: dict[str, Any]) -> Fleet:
    """Return a fleet of two stops and a depot, each 0.1 from the others."""
    visits = (Visit(), Visit(**first), Visit(**second))
    rules = Rules(visits=visits, vehicles=(VehicleType(start=0, end=0, **vehicle),), clock=0)
    return Fleet(rules=rules, costs=np.full((2, 3, 3), LEG))


IN_TIME: list[tuple[dict[str, Any], dict[str, Any], dict[str, Any]]] = [
    ({}, {}, {"shift": (0.0, 0.3)}),
    ({}, {}, {"longest": 0.3}),
    ({"service": 0.1}, {"windows": ((0.0, 0.3),)}, {}),
    ({"service": 0.1}, {"windows": ((0.0, 0.3), (5.0, 9.0))}, {}),
    ({"service": 0.1}, {"due": 0.3}, {}),
    ({}, {}, {"shift": (0.0, 0.3), "max_overtime": 1.0}),
    ({"service": 0.1}, {}, {"breaks": ((0.25, 0.3, 0.5),), "shift": (0.0, 0.91)}),
    ({"release": SUM}, {}, {"leaves_by": 0.3}),
]


@pytest.mark.parametrize(("first", "second", "vehicle"), IN_TIME)
def test_a_rounding_breaks_no_rule_and_misses_no_window(
    first: dict[str, Any], second: dict[str, Any], vehicle: dict[str, Any]
) -> None:
    assert SUM > 0.3
    fleet = fleet_of(first, second, vehicle)
    times = schedule(fleet, BOTH)
    assert violations(fleet, Plan((BOTH,))) == []
    assert (times.late, times.lateness, times.waiting) == (0, 0, pytest.approx(0, abs=0.06))
    assert times.end < 1
    assert measures(fleet, Plan((BOTH,))).get("overtime", 0) == 0
    plans = plan_fleet(fleet, FleetOptions(time_limit=inf)).plans
    assert any({1, 2} == set(route.stops) for plan in plans for route in plan.routes)


@pytest.mark.parametrize(
    ("first", "second", "vehicle"),
    [
        ({}, {}, {"shift": (0.0, 0.299)}),
        ({}, {}, {"longest": 0.299}),
        ({"service": 0.1}, {"windows": ((0.0, 0.299),)}, {}),
        ({"service": 0.1}, {}, {"breaks": ((0.3, 0.3, 0.5),), "shift": (0.0, 0.599)}),
    ],
)
def test_more_than_a_rounding_does(
    first: dict[str, Any], second: dict[str, Any], vehicle: dict[str, Any]
) -> None:
    fleet = fleet_of(first, second, vehicle)
    assert violations(fleet, Plan((BOTH,)))


def test_a_window_that_ends_when_the_vehicle_arrives_is_taken() -> None:
    leg = nextafter(38.08, inf)
    visits = (Visit(), Visit(windows=((20.95, 38.08), (98.08, 158.08))))
    rules = Rules(visits=visits, vehicles=(VehicleType(start=0, end=0),), clock=0)
    fleet = Fleet(rules=rules, costs=np.full((2, 2, 2), leg))
    times = schedule(fleet, Route(0, (1,)))
    assert (times.windows[1], times.end) == (0, 2 * leg)


def test_a_plan_without_a_break_that_must_be_taken_is_never_answered() -> None:
    costs = np.full((2, 3, 3), 68.18)
    costs[:, 0, 1], costs[:, 1, 2], closes = 31.33, 24.35, nextafter(27.15 + 31.33 + 24.35, 0)
    visits = (Visit(), Visit(), Visit(windows=((81.17, closes),)))
    van = VehicleType(start=0, end=0, shift=(27.15, 400.0), breaks=((63.35, 73.35, 30.0),))
    fleet = Fleet(rules=Rules(visits=visits, vehicles=(van,), clock=0), costs=costs)
    assert violations(fleet, Plan((BOTH,))) == ["a vehicle of type 0 has no time for a break"]
    with pytest.raises(Refusal, match="no plan keeps every rule"):
        plan_fleet(fleet, FleetOptions(time_limit=inf))


def test_breaks_follow_each_other_without_a_gap() -> None:
    first = (10.1, 20.2, 30.3)
    assert 20.2 + 30.3 <= 50.5 < nextafter(50.5, inf)
    fleet_of({}, {}, {"breaks": (first, (nextafter(50.5, 0), 60.0, 1.0))})
    with pytest.raises(Refusal, match="must begin after the break before"):
        fleet_of({}, {}, {"breaks": (first, (50.4, 60.0, 1.0))})


def test_a_break_is_placed_so_that_visits_are_the_least_late() -> None:
    """The break fits before or after the visit, and the route ends when a window opens."""
    visits = (Visit(), Visit(due=12.0), Visit(windows=((100.0, 100.0),)))
    van = VehicleType(start=0, end=0, breaks=((5.0, 30.0, 20.0),), leaves_by=0.0)
    costs = np.full((2, 3, 3), 10.0)
    fleet = Fleet(rules=Rules(visits=visits, vehicles=(van,), clock=0), costs=costs)
    times = schedule(fleet, BOTH)
    assert (times.arrivals, times.breaks, times.lateness) == ((0, 10, 40, 110), (10,), 0)


@pytest.mark.parametrize(
    ("value", "bound", "reach", "over"),
    [
        (SUM, 0.3, 0.0, False),
        (0.3001, 0.3, 0.0, True),
        (1.7e9 + 1e-4, 1.7e9, 0.0, False),
        (1.7e9 + 0.01, 1.7e9, 0.0, True),
        (0.3001, 0.3, 1.7e9, False),
        (1.0, inf, 0.0, False),
        (inf, 1.0, 0.0, True),
        (inf, inf, 0.0, False),
    ],
)
def test_a_value_is_over_a_bound_by_more_than_a_rounding(
    value: float, bound: float, reach: float, over: bool
) -> None:
    assert is_over(value, bound, reach) == over
