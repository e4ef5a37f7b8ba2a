"""The lengths and times of plans, and the rules that they break."""

import dataclasses
from itertools import islice, pairwise, takewhile
from math import inf

import numpy as np
import pytest

from service.fleet.evaluation import (
    measures,
    plan_lengths,
    route_lengths,
    unassigned,
    violations,
)
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.schedule import schedule
from service.fleet.vehicles import Shipment, VehicleType, Visit
from tests.helpers.fleets import best_times, bounded_fleet, every_plan, random_fleet
from tests.helpers.sampled import sixth

FULL = VehicleType(start=0, end=0, count=1, capacity=(3,))
LINE = np.abs(np.subtract.outer([0.0, 1, 2, 3, 4], [0.0, 1, 2, 3, 4]))


def fleet_of(**rules: object) -> Fleet:
    """Return a fleet on a line with a depot at 0 and stops at 1 to 4."""
    given = {
        "visits": (Visit(),) * 5,
        "vehicles": (VehicleType(start=0, end=0, count=2),),
        **rules,
    }
    return Fleet(rules=Rules(**given), costs=np.stack([LINE, 10 * LINE]))


def test_a_sum_adds_routes_and_a_maximum_takes_the_longest() -> None:
    plan = Plan((Route(0, (1, 2)), Route(0, (3, 4))))
    assert plan_lengths(fleet_of(), plan) == (12, 120)
    assert plan_lengths(fleet_of(over=("max", "sum")), plan) == (8, 120)


def test_vehicles_have_speeds_times_at_stops_and_prices_of_their_own() -> None:
    van = VehicleType(start=0, end=0, fixed=100, per_distance=3.0, per_time=2.0)
    bike = VehicleType(
        start=0, end=0, speed_factor=0.5, service_factor=2.0, per_distance=0.0, per_time=1.0
    )
    visits = (Visit(), *(Visit(service=5),) * 4)
    fleet = fleet_of(vehicles=(van, bike), visits=visits, clock=1)
    plan = Plan((Route(0, (1, 2)), Route(1, (3, 4))))
    assert route_lengths(fleet, plan.routes[0]) == (3 * 4 + 2 * 50, 50)
    assert route_lengths(fleet, plan.routes[1]) == (160 + 20, 160 + 20)
    assert plan_lengths(fleet, plan) == (112 + 180 + 100, 230)
    found = measures(fleet, plan)
    assert (found["driving"], found["service"], found["longest"]) == (200, 30, 180)


def test_an_open_route_ends_at_its_last_visit() -> None:
    vehicles = (VehicleType(start=0, count=2),)
    assert route_lengths(fleet_of(vehicles=vehicles), Route(0, (1, 4))) == (4, 40)
    vehicles = (VehicleType(count=2),)
    assert route_lengths(fleet_of(vehicles=vehicles), Route(0, (1, 4))) == (3, 30)


def test_prizes_lost_and_vehicles_used_are_added_to_the_first_length() -> None:
    visits = (Visit(), Visit(prize=7), *(Visit(),) * 3)
    vehicles = (VehicleType(start=0, end=0, count=2, fixed=100),)
    fleet = fleet_of(visits=visits, vehicles=vehicles)
    plan = Plan((Route(0, (2,)), Route(0, (3, 4))))
    assert unassigned(fleet.rules, plan) == [1]
    assert plan_lengths(fleet, plan) == (4 + 8 + 7 + 200, 120)


def test_a_vehicle_leaves_as_late_as_its_end_allows() -> None:
    visits = (Visit(), Visit(service=2, windows=((10, 12),)), *(Visit(),) * 3)
    fleet = fleet_of(visits=visits, clock=0)
    times = schedule(fleet, Route(0, (1, 2)))
    assert times.arrivals == (9, 10, 13, 15)
    assert times.duration == 6


@pytest.mark.parametrize("seed", range(sixth(150)))
def test_times_agree_with_trying_every_departure(seed: int) -> None:
    fleet = random_fleet(seed)
    if fleet.rules.clock is None:
        fleet = dataclasses.replace(fleet, rules=dataclasses.replace(fleet.rules, clock=1))
    plans = list(every_plan(fleet.rules))
    plan = plans[seed % len(plans)]
    for route in plan.routes:
        times, expected = schedule(fleet, route), best_times(fleet, route)
        assert (times.late == 0) == (expected is not None)
        if expected is not None:
            assert (times.end, times.lateness, times.arrivals[0]) == expected


@pytest.mark.parametrize("seed", range(sixth(140)))
def test_times_with_all_bounds_agree_with_trying_every_departure_and_window(seed: int) -> None:
    fleet = bounded_fleet(seed)
    plans = list(islice(every_plan(fleet.rules), 3000))
    plan = plans[(seed * 997) % len(plans)]
    for route in plan.routes:
        times, expected = schedule(fleet, route), best_times(fleet, route)
        assert (times.late == 0) == (expected is not None)
        if expected is not None:
            assert (times.end, times.lateness, times.arrivals[0]) == expected


def carried(fleet: Fleet, route: Route) -> float:
    """Return the load distance of a route, driven stop by stop with each order on board."""
    rules, vehicle = fleet.rules, fleet.rules.vehicles[route.vehicle]
    ends = [[] if end is None else [end] for end in (vehicle.start, vehicle.end)]
    path = [*ends[0], *route.stops, *ends[1]]
    first = len(ends[0])
    on_board = list(vehicle.initial_load)[:1]

    def loaded(place: int) -> list[int]:
        trip = takewhile(lambda stop: stop not in vehicle.reload, path[place:])
        return [rules.visits[stop].demand[0] for stop in trip if rules.visits[stop].demand]

    on_board += loaded(first)
    total = 0.0
    for place, (here, there) in enumerate(pairwise(path)):
        if place >= first and rules.visits[here].demand:
            on_board.remove(rules.visits[here].demand[0])
        elif place >= first and here in vehicle.reload:
            on_board = loaded(place + 1)
        total += sum(on_board) * fleet.costs[0, here, there]
    return total


@pytest.mark.parametrize("seed", range(sixth(60)))
def test_the_load_distance_is_that_of_the_orders_on_board(seed: int) -> None:
    fleet = bounded_fleet(seed)
    plans = list(islice(every_plan(fleet.rules), 3000))
    plan = plans[(seed * 997) % len(plans)]
    expected = sum(carried(fleet, route) for route in plan.routes)
    assert measures(fleet, plan)["load_distance"] == pytest.approx(expected)


def test_what_a_shipment_picks_up_counts_until_it_is_delivered() -> None:
    visits = (Visit(), Visit(demand=(2,)), Visit(demand=(3,)), Visit(), Visit())
    fleet = fleet_of(visits=visits, vehicles=(FULL,), shipments=(Shipment(2, 3),))
    plan = Plan((Route(0, (1, 2, 3, 4)),))
    assert measures(fleet, plan)["load_distance"] == 2 * LINE[0, 1] + 3 * LINE[2, 3]


BROKEN = [
    ({}, [(1, 2, 3)], "stop 4 is not visited"),
    ({}, [(1, 2), (2, 3, 4)], "stop 2 is visited 2 times"),
    ({}, [(0, 1, 2, 3, 4)], "stop 0 is not a stop to visit"),
    ({}, [(1, 2, 3, 4), ()], "a route visits no stop"),
    ({"vehicles": (FULL,)}, [(1, 2), (3, 4)], "2 vehicles of type 0 leave"),
    (
        {"visits": (Visit(), *(Visit(demand=(1,)),) * 4), "vehicles": (FULL,)},
        [(1, 2, 3, 4)],
        "holds 4 of 3",
    ),
    (
        {"shipments": (Shipment(3, 1),)},
        [(1, 2, 3, 4)],
        "the load for 1 was not picked up at 3 before",
    ),
    (
        {"shipments": (Shipment(1, 3),)},
        [(1, 2), (3, 4)],
        "the load for 3 was not picked up at 1 before",
    ),
    (
        {"shipments": (Shipment(1, 3),), "visits": (Visit(), Visit(prize=1), *(Visit(),) * 3)},
        [(1, 2, 4)],
        "only half of the shipment",
    ),
    (
        {"visits": (Visit(), Visit(windows=((0, 3),)), *(Visit(),) * 3), "clock": 0},
        [(4, 1, 2, 3)],
        "late by 4",
    ),
    (
        {"vehicles": (VehicleType(start=0, end=0, shift=(2, 9)),), "clock": 0},
        [(1, 2, 3, 4)],
        "late by 1",
    ),
    (
        {"vehicles": (VehicleType(start=0, end=0, longest=7),), "clock": 0},
        [(1, 2, 3, 4)],
        "longer than 7",
    ),
]


@pytest.mark.parametrize(("rules", "routes", "sentence"), BROKEN)
def test_each_broken_rule_is_named(
    rules: dict[str, object], routes: list[tuple[int, ...]], sentence: str
) -> None:
    plan = Plan(tuple(Route(0, stops) for stops in routes))
    assert any(sentence in broken for broken in violations(fleet_of(**rules), plan))


def test_a_plan_that_keeps_every_rule_breaks_none() -> None:
    assert violations(fleet_of(), Plan((Route(0, (1, 2)), Route(0, (3, 4))))) == []


def test_a_load_is_freed_by_what_is_delivered_before_a_pickup() -> None:
    """Two of three places are delivered at 1, which leaves room for the shipment from 2 to 3."""
    visits = (Visit(), Visit(demand=(2,)), Visit(demand=(3,)), Visit(), Visit())
    fleet = fleet_of(visits=visits, vehicles=(FULL,), shipments=(Shipment(2, 3),))
    assert violations(fleet, Plan((Route(0, (1, 2, 3, 4)),))) == []
    assert violations(fleet, Plan((Route(0, (2, 1, 3, 4)),)))


def test_an_unbounded_vehicle_has_no_longest_route() -> None:
    assert VehicleType().longest == inf
