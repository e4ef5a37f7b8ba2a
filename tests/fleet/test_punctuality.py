"""How surely plans are on time, against 10,000 or a few given days that other code drives."""

from dataclasses import replace
from itertools import permutations
from math import inf, sqrt
from statistics import NormalDist

import numpy as np
import pytest

from service.fleet.evaluation import measures, plan_lengths, route_violations, violations
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.schedule import schedule
from service.fleet.vehicles import VehicleType, Visit
from tests.helpers.fleets import every_plan, random_fleet, sampled_fleet

DAYS = 10_000
SPREAD = 0.3


def spreading(seed: int) -> tuple[Fleet, Route] | None:
    """Return a fleet whose times spread, and a route through all its stops that keeps the rules."""
    fleet = random_fleet(seed, ("sum", "sum"))
    if fleet.rules.clock is None or not any(v.windows[0][1] < inf for v in fleet.rules.visits):
        return None
    rules = replace(fleet.rules, spread=SPREAD)
    fleet = Fleet(rules=rules, costs=fleet.costs)
    for stops in permutations(rules.clients):
        route = Route(0, stops)
        if not any(route_violations(fleet, route)):
            return fleet, route
    return None


def driven(fleet: Fleet, route: Route, seed: int) -> tuple[float | None, np.ndarray]:
    """Return the share of visits on time, and how long the route takes on each day."""
    rules, random = fleet.rules, np.random.default_rng(seed)
    vehicle = rules.vehicles[route.vehicle]
    left = schedule(fleet, route).arrivals[0]
    now, at, kept = np.full(DAYS, left), vehicle.start, []
    for stop in route.stops:
        if at is not None:
            leg = fleet.costs[rules.clock, at, stop] / vehicle.speed_factor
            now = now + random.normal(leg, SPREAD * leg, DAYS)
        opens, closes = rules.visits[stop].windows[0]
        if closes < inf:
            kept.append((now <= closes).mean())
        now = np.maximum(now, opens) + rules.service(route.vehicle, stop)
        at = stop
    if vehicle.end is not None:
        leg = fleet.costs[rules.clock, at, vehicle.end] / vehicle.speed_factor
        now = now + random.normal(leg, SPREAD * leg, DAYS)
    return (float(np.mean(kept)) if kept else None), now - left


def test_simulated_days_are_as_the_measures_say() -> None:
    found = [(seed, pair) for seed in range(150) if (pair := spreading(seed))]
    misses = []
    for seed, (fleet, route) in found:
        said = measures(fleet, Plan((route,)))
        on_time, durations = driven(fleet, route, seed)
        assert said.get("on_time") == (on_time and pytest.approx(on_time, abs=0.08))
        misses += [] if on_time is None else [said["on_time"] - on_time]
        assert said["duration"] == pytest.approx(durations.mean(), abs=0.4)
        most = np.quantile(durations, 0.9)
        assert said["duration_p90"] == pytest.approx(most, rel=0.05)
        if fleet.rules.clock == 0 and on_time is not None:
            free = tuple(replace(each, fixed=0.0) for each in fleet.rules.vehicles)
            objectives = {"over": ("sum", "on_time"), "percents": (90, None)}
            asked = replace(fleet.rules, vehicles=free, **objectives)
            lengths = plan_lengths(fleet.under(asked), Plan((route,)))
            late = sum(fleet.rules.visits[s].windows[0][1] < inf for s in route.stops)
            assert lengths == pytest.approx(
                (said["duration_p90"], late * (1 - said["on_time"])), abs=1e-9
            )
    assert len(misses) > 50
    assert len(misses) > 50
    assert np.sqrt(np.mean(np.square(misses))) < 0.01


def on_a_day(fleet: Fleet, route: Route, day: np.ndarray) -> tuple[int, int, float]:
    """Return the visits of a route with a latest time, those in time, and how long it takes."""
    rules, times = fleet.rules, schedule(fleet, route)
    vehicle = rules.vehicles[route.vehicle]
    planned = iter(times.arrivals if vehicle.start is None else times.arrivals[1:])
    now = left = times.arrivals[0]
    timed = kept = 0
    stops = [stop for stop in (vehicle.start, *route.stops, vehicle.end) if stop is not None]
    for at, stop in zip([None, *stops], [*stops, None], strict=True):
        if at is not None and stop is not None:
            now += day[at, stop] / vehicle.speed_factor
        if stop is None or (at is None and vehicle.start is not None):
            continue
        arrival, visit = next(planned), rules.visits[stop]
        if stop in rules.depots:
            continue
        opens, closes = next(w for w in visit.windows if arrival <= w[1] * (1 + 1e-12))
        latest = min(closes, visit.due)
        timed += latest < inf
        kept += latest < inf and now <= latest * (1 + 1e-12)
        now = max(now, opens) + rules.service(route.vehicle, stop)
    return timed, kept, now - left


def test_each_given_day_is_driven() -> None:
    several = 0
    for seed in range(40):
        fleet = sampled_fleet(seed)
        assert fleet.sampled is not None
        if fleet.rules.reloads:
            continue
        plans = [plan for plan in every_plan(fleet.rules) if not violations(fleet, plan)]
        for plan in plans[:: max(1, len(plans) // 5)]:
            days = [[on_a_day(fleet, each, day) for each in plan.routes] for day in fleet.sampled]
            durations = sorted(sum(taken for *_, taken in day) for day in days)
            timed = sum(route[0] for day in days for route in day)
            kept = sum(route[1] for day in days for route in day)
            said = measures(fleet, plan)
            assert said.get("on_time") == (pytest.approx(kept / timed) if timed else None)
            assert said["duration"] == pytest.approx(np.mean(durations))
            nine_in_ten = next(
                most
                for most in durations
                if 10 * sum(other <= most for other in durations) >= 9 * len(days)
            )
            assert said["duration_p90"] == pytest.approx(nine_in_ten)
            several += len(plan.routes) > 1 and 0 < kept < timed
    assert several > 20


def fleet_of(*visits: Visit, spread: float | None = 0.5) -> Fleet:
    costs = np.full((2, len(visits) + 1, len(visits) + 1), 8.0)
    rules = Rules(
        visits=(Visit(), *visits),
        vehicles=(VehicleType(start=0, end=0, count=2, shift=(0, inf)),),
        clock=0,
        leave="early",
        spread=spread,
    )
    return Fleet(rules=rules, costs=costs)


@pytest.mark.parametrize(
    ("visit", "share"),
    [
        (Visit(windows=((0, 8),)), 0.5),
        (Visit(windows=((0, 12),)), NormalDist().cdf(1)),
        (Visit(due=4), 1 - NormalDist().cdf(1)),
        (Visit(windows=((0, 9),), due=8), 0.5),
    ],
)
def test_a_visit_is_on_time_on_a_share_of_days(visit: Visit, share: float) -> None:
    found = measures(fleet_of(visit, Visit()), Plan((Route(0, (1,)), Route(0, (2,)))))
    assert found["on_time"] == pytest.approx(share)


def test_all_routes_together_take_what_their_variances_say() -> None:
    fleet = fleet_of(Visit(service=3), Visit())
    found = measures(fleet, Plan((Route(0, (1,)), Route(0, (2,)))))
    assert "on_time" not in found
    assert found["duration"] == pytest.approx(4 * 8 + 3)
    assert found["duration_p90"] == pytest.approx(35 + NormalDist().inv_cdf(0.9) * 4 * 2)


def test_percentiles_are_of_all_routes_together_or_of_the_longest() -> None:
    fleet, z = fleet_of(Visit(service=3), Visit()), NormalDist().inv_cdf(0.9)
    plan = Plan((Route(0, (1,)), Route(0, (2,))))
    rules = replace(fleet.rules, over=("sum", "max"), layers=(0, 0), percents=(90, 90))
    lengths = plan_lengths(fleet.under(rules), plan)
    assert lengths == pytest.approx((35 + z * 4 * 2, 19 + z * 4 * sqrt(2)))
    means = replace(rules, percents=(50, None))
    assert plan_lengths(fleet.under(means), plan) == pytest.approx((35, 19))


def test_who_waits_long_is_on_time_afterwards_whatever_the_leg_took() -> None:
    fleet = fleet_of(Visit(windows=((50, 60),)), Visit(windows=((0, 62),)))
    late = NormalDist(58, 4)
    found = measures(fleet, Plan((Route(0, (1, 2)),)))
    assert found["on_time"] == pytest.approx((1 + late.cdf(62)) / 2)


def test_times_that_do_not_spread_have_no_such_measures() -> None:
    fleet = fleet_of(Visit(), spread=None)
    assert not {"on_time", "duration"} & measures(fleet, Plan((Route(0, (1,)),))).keys()
    sure = measures(fleet_of(Visit(due=8), spread=0.0), Plan((Route(0, (1,)),)))
    assert (sure["on_time"], sure["duration_p90"]) == (1, 16)
