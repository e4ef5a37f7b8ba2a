"""Fleets over the day: routes at their best departures, and the search for plans of them."""

from collections.abc import Callable, Sequence
from math import inf

import numpy as np
import pytest

from service.day.costs import CostsOfDay
from service.fleet.evaluation import first_broken, points_of, route_violations, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.measures.of_times import overtime
from service.fleet.plans import FleetFront, Route
from service.fleet.rules import Rules
from service.fleet.schedule import legs, schedule
from service.fleet.search.search import RuinSearch
from service.fleet.vehicles import VehicleType, Visit
from service.watch import Watch
from tests.helpers.fleet_days import (
    Driven,
    day_fleet,
    departures,
    driven,
    limited_day_fleet,
    other_length,
)
from tests.helpers.fleets import exact_front
from tests.helpers.sampled import third


def routes_of(fleet: Fleet, seed: int) -> list[Route]:
    """Return some routes of one window a stop, without breaks and without loading again."""
    random = np.random.default_rng(seed)
    found = []
    for index, vehicle in enumerate(fleet.rules.vehicles):
        for _ in range(3):
            count = int(random.integers(1, len(fleet.rules.clients) + 1))
            stops = random.permutation(fleet.rules.clients)[:count].tolist()
            alone = all(len(fleet.rules.windows[stop]) == 1 for stop in stops)
            if alone and not vehicle.breaks:
                found.append(Route(index, tuple(stops)))
    return found


def badness(fleet: Fleet, route: Route, times: Driven) -> tuple[float, float, float]:
    """Return how late a route is, how long after its shift it ends, and how long it takes."""
    late = max(0.0, times.end - fleet.rules.vehicles[route.vehicle].shift[1])
    return times.lateness, late, times.end - times.arrivals[0]


def reaches(one: Sequence[float], other: Sequence[float]) -> bool:
    """Return whether a point is as good as another, up to roundings."""
    return all(a <= b + 1e-9 * (1 + abs(b)) for a, b in zip(one, other, strict=True))


def test_a_route_leaves_when_it_takes_the_least_time_and_nothing_is_later_for_it() -> None:
    tried = 0
    for seed in range(third(60)):
        fleet = day_fleet(seed)
        for route in routes_of(fleet, seed):
            if fleet.forbids or fleet.rules.clock is None:
                continue
            times = schedule(fleet, route)
            every = [each for t in departures(fleet, route) if (each := driven(fleet, route, t))]
            if times.late:
                assert not every
                continue
            again = driven(fleet, route, times.arrivals[0])
            assert again is not None
            np.testing.assert_allclose(times.arrivals, again.arrivals, rtol=1e-9)
            assert times.lateness == pytest.approx(again.lateness, abs=1e-9)
            least = min(badness(fleet, route, each) for each in every)
            if fleet.rules.leave == "late":
                assert badness(fleet, route, again)[:2] <= tuple(x + 1e-6 for x in least[:2])
                assert overtime(fleet, route) <= least[1] + 1e-6
                assert times.duration <= least[2] + 1e-6
            other = 1 - fleet.rules.clock
            expected = other_length(fleet, route, list(times.leaves), other)
            assert sum(legs(fleet, route, other)) == pytest.approx(expected)
            tried += 1
    assert tried > 20


def test_what_is_driven_is_bounded_at_the_times_of_the_route() -> None:
    broken = tried = 0
    for seed in range(third(120)):
        fleet = limited_day_fleet(seed)
        for route in routes_of(fleet, seed):
            clock = fleet.rules.clock
            assert clock is not None
            again = driven(fleet, route, schedule(fleet, route).arrivals[0])
            rules = {each.rule for each in route_violations(fleet, route)}
            if again is None or "way" in rules:
                continue
            vehicle, leaves = fleet.rules.vehicles[route.vehicle], schedule(fleet, route).leaves
            far = other_length(fleet, route, list(leaves), 1 - clock)
            assert ("max_driving" in rules) == (again.driving > vehicle.max_driving + 1e-7)
            assert ("max_distance" in rules) == (far > vehicle.max_distance + 1e-7)
            broken += bool({"max_driving", "max_distance"} & rules)
            tried += 1
    assert 10 < broken < tried - 10


@pytest.mark.parametrize("drawn", [day_fleet, limited_day_fleet])
def test_small_fleets_have_plans_as_good_as_brute_force_and_none_better(
    drawn: Callable[[int], Fleet],
) -> None:
    tried = same = 0
    for seed in range(third(24)):
        fleet = drawn(seed)
        expected = exact_front(fleet)
        options = FleetOptions(time_limit=inf, iterations=60)
        search = RuinSearch(fleet, options, Watch[FleetFront]())
        search.run()
        plans = [search.plan_at(index) for index in range(len(search))]
        rests = any(vehicle.breaks for vehicle in fleet.rules.vehicles)
        kept = [plan for plan in plans if not violations(fleet, plan)]
        # With breaks the search knows of two departures, and bounds what is driven without them.
        assert len(kept) == len(plans) or (rests and fleet.rules.capped)
        points = points_of(fleet, kept)
        if not rests:
            np.testing.assert_allclose(search.points, points, rtol=1e-9, atol=1e-9)
        assert all(any(reaches(each, point) for each in expected) for point in points)
        tried += 1
        same += all(any(reaches(point, each) for point in points) for each in expected)
    assert same >= 0.8 * tried > 5


def test_a_route_without_changes_over_the_day_is_that_of_a_plain_fleet() -> None:
    for seed in range(third(30)):
        plain = day_fleet(seed)
        day = plain.day
        assert day is not None
        costs = np.stack([each.factors[0] * each.matrices[each.layers[0]] for each in day])
        fleet = Fleet(rules=plain.rules, costs=costs)
        still = [type(each).constant(matrix) for each, matrix in zip(day, costs, strict=True)]
        over = Fleet.over_the_day(plain.rules, *still)
        for route in routes_of(plain, seed):
            assert (first_broken(over, route) is None) == (first_broken(fleet, route) is None)
            if first_broken(fleet, route) is None:
                times, known = schedule(over, route), schedule(fleet, route)
                np.testing.assert_allclose(times.arrivals, known.arrivals, rtol=1e-9)
                assert times.lateness == pytest.approx(known.lateness)


def test_a_break_is_taken_before_the_departure_though_sums_differ_by_a_rounding() -> None:
    way, opens = 14.84, 59.01
    assert (opens - way) + way > opens
    visit = Visit(windows=((opens, 100.0),), due=10.0)
    van = VehicleType(start=0, end=None, breaks=((10.0, 20.0, 5.0),))
    rules = Rules(visits=(Visit(), visit), vehicles=(van,), clock=0)
    still = CostsOfDay.constant(np.array([[0.0, way], [way, 0.0]]))
    times = schedule(Fleet.over_the_day(rules, still, still), Route(0, (1,)))
    assert times.breaks == ()
    assert times.duration == pytest.approx(way)


def test_a_break_delays_no_late_visit_though_the_route_ends_a_rounding_later() -> None:
    begin, there, service, back = 42.89, 20.3, 0.46, 9.799999999999999
    assert begin + there + 5 + service + back < begin + there + service + 5 + back
    visit = Visit(due=39.55, service=service)
    van = VehicleType(start=0, end=0, shift=(begin, 78.7), breaks=((58.04, 71.93, 5.0),))
    rules = Rules(visits=(Visit(), visit), vehicles=(van,), clock=0)
    still = CostsOfDay.constant(np.array([[0.0, there], [back, 0.0]]))
    times = schedule(Fleet.over_the_day(rules, still, still), Route(0, (1,)))
    assert times.lateness == pytest.approx(begin + there - 39.55)
