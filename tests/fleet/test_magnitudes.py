"""Fleets with huge prizes and costs, bridges between clusters, and times since 1970."""

import dataclasses
from math import inf

import numpy as np
import pytest

from service.errors import NoTour, Refusal
from service.fleet.enumeration import exact_plans, is_enumerable
from service.fleet.evaluation import points_of, route_lengths, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.necessary import check_necessary
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import ALWAYS, Shipment, VehicleType, Visit
from service.pareto import nondominated
from tests.fleet.test_outliers import AnyOrder
from tests.helpers.fleets import share_of_front
from tests.helpers.sampled import few

BRIEF = FleetOptions(time_limit=inf, iterations=400)
MODERATE = 1e5
HUGE = [1e8, 1e12]
OVERS: list[tuple[Over, Over]] = [("sum", "sum"), ("sum", "max")]
OF_HUGE = list(zip(OVERS, HUGE, strict=True))


def van(**members: object) -> VehicleType:
    return VehicleType(**{"start": 0, "end": 0, "capacity": (8,), **members})


def prized_fleet(over: tuple[Over, Over], huge: float, fixed: float) -> Fleet:
    """Twenty stops; three with a prize that is huge, or one type of two with such a fixed cost."""
    costs = np.random.default_rng(5).integers(1, 100, (2, 21, 21)).astype(float)
    prizes = [huge if 3 <= i < 6 and huge else None for i in range(21)]
    visits = (Visit(), *(Visit(demand=(1,), prize=prize) for prize in prizes[1:]))
    vehicles = (van(count=2), van(count=2, fixed=fixed))
    return Fleet(rules=Rules(visits=visits, vehicles=vehicles, over=over), costs=costs)


@pytest.mark.parametrize(("over", "huge"), few(1, OF_HUGE))
def test_a_huge_prize_means_as_good_a_front_as_a_moderate_one(
    over: tuple[Over, Over], huge: float
) -> None:
    twin, found = (plan_fleet(prized_fleet(over, p, 0.0), BRIEF) for p in (MODERATE, huge))
    assert share_of_front(twin, found) == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(("over", "huge"), few(1, OF_HUGE[::-1]))
def test_a_vehicle_of_huge_fixed_cost_is_used_where_it_is_needed_alone(
    over: tuple[Over, Over], huge: float
) -> None:
    twin, found = (plan_fleet(prized_fleet(over, 0.0, f), BRIEF) for f in (MODERATE, huge))
    assert share_of_front(twin, found) == pytest.approx(1.0, abs=0.03)
    assert min(sum(r.vehicle for r in plan.routes) for plan in found.plans) == 1


def test_of_two_huge_prizes_the_larger_is_earned() -> None:
    prizes = [None, None, None, 1e9, 1e12, None, None, 1e6, None]
    visits = tuple(Visit(demand=(int(i > 0),), prize=prize) for i, prize in enumerate(prizes))
    costs = np.random.default_rng(2).integers(1, 100, (2, 9, 9)).astype(float)
    rules = Rules(visits=visits, vehicles=(van(capacity=(6,)),))
    front = plan_fleet(Fleet(rules=rules, costs=costs), BRIEF)
    assert {4, 5, 6} < set(front.plans[0].visited())
    assert set(range(1, 9)) - set(front.plans[0].visited()) == {3, 7}


def timed_fleet(begin: float) -> Fleet:
    """Twelve stops with windows that open after a time, at which the shift begins."""
    rng = np.random.default_rng(4)
    costs = rng.integers(60, 1800, (2, 13, 13)).astype(float)
    opens = begin + rng.integers(0, 8000, 13).astype(float)
    windows = [(float(a), float(a) + 9000.0) for a in opens]
    visits = (Visit(), *(Visit(demand=(1,), service=300, windows=(w,)) for w in windows[1:]))
    vehicles = (van(count=3, shift=(begin, begin + 28_800.0)),)
    return Fleet(rules=Rules(visits=visits, vehicles=vehicles, clock=1), costs=costs)


@pytest.mark.parametrize("time_limit", [0.0, inf])
def test_times_since_1970_are_planned_like_times_of_day(time_limit: float) -> None:
    options = dataclasses.replace(BRIEF, time_limit=time_limit)
    day, since = (plan_fleet(timed_fleet(begin), options, AnyOrder()) for begin in (0, 1.7e9))
    np.testing.assert_allclose(since.points, day.points, rtol=1e-9)


def test_a_second_late_is_late_in_times_since_1970() -> None:
    visits = (Visit(), Visit(windows=((1.7e9, 1.7e9 + 99.0),)))
    rules = Rules(visits=visits, vehicles=(van(shift=(1.7e9, inf), capacity=()),), clock=0)
    plan = Plan((Route(0, (1,)),))
    for leg, late in ((99.0 + 1e-7, False), (99.01, True), (100.0, True)):
        fleet = Fleet(rules=rules, costs=np.full((2, 2, 2), leg))
        assert bool(violations(fleet, plan)) == late


def clusters(seed: int, bridge: float, over: tuple[Over, Over]) -> Fleet:
    """Two clusters; the legs between them are a bridge longer."""
    rng = np.random.default_rng(seed)
    n = 8
    costs = rng.integers(1, 100, (2, n, n)).astype(float)
    apart = np.arange(n) % 2
    between = apart != apart[:, np.newaxis]
    costs[:, between] += bridge * 50
    visits = (Visit(), *(Visit(demand=(1,)) for _ in range(n - 1)))
    rules = Rules(visits=visits, vehicles=(van(count=2, capacity=(n,)),), over=over)
    return Fleet(rules=rules, costs=costs)


@pytest.mark.parametrize(("seed", "bridge"), few(1, [(0, 1e9), (1, 1e6), (0, 1e4)]))
def test_clusters_far_apart_are_planned_at_true_lengths(seed: int, bridge: float) -> None:
    fleet = clusters(seed, bridge, ("sum", "sum"))
    front = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=1_500))
    exact = points_of(fleet, exact_plans(fleet) or ())
    assert front.points.tolist() == points_of(fleet, front.plans).tolist()
    np.testing.assert_allclose(front.points.min(axis=0), exact.min(axis=0), rtol=1e-12)
    assert (front.scale >= bridge).all()
    assert front.hypervolume > 0


def spread_fleet(seed: int) -> Fleet:
    """Up to five stops; costs, prizes and fixed costs from 1 to 1e12, forbidden legs, windows."""
    rng = np.random.default_rng(seed)
    n = 8 if seed % 40 == 0 else int(rng.integers(4, 7))
    costs = rng.integers(1, 100, (2, n, n)).astype(float)
    huge = 10.0 ** rng.uniform(2, 12, (2, n, n)).round(int(rng.integers(3)))
    costs = np.where(rng.random((2, n, n)) < rng.choice([0.05, 0.2]), huge, costs)
    costs[0][rng.random((n, n)) < rng.choice([0, 0.1])] = inf
    over: tuple[Over, Over] = (("sum", "sum"), ("sum", "max"), ("max", "sum"))[seed % 3]
    clock = (None, 0, 1)[int(rng.integers(3))]
    begin = float(rng.choice([0.0, 1.7e9]))
    extras = over[0] == "sum"

    def visit() -> Visit:
        opens = begin + float(rng.integers(300))
        closes = opens + float(rng.integers(50, 400))
        timed = clock is not None and rng.random() < 0.4
        prized = extras and rng.random() < 0.3
        return Visit(
            demand=(int(rng.integers(1, 4)),),
            windows=((opens, closes),) if timed else (ALWAYS,),
            prize=float(10.0 ** rng.integers(13)) if prized else None,
        )

    visits = (Visit(), *(visit() for _ in range(n - 1)))
    fixed = float(10.0 ** rng.integers(13)) if extras and rng.random() < 0.5 else 0.0
    # Three types, so that there are too many vehicles to compare all plans.
    vehicles = tuple(van(count=4, capacity=(c,), fixed=f) for c, f in ((6, 0), (5, 0), (6, fixed)))
    rules = Rules(visits=visits, vehicles=vehicles, over=over, clock=clock)
    return Fleet(rules=rules, costs=costs)


def misses(fleet: Fleet, iterations: int) -> bool:
    """Return whether a front lacks an end of the exact one, or holds what cannot be."""
    assert not is_enumerable(fleet.rules)
    exact = points_of(fleet, exact_plans(fleet) or ())
    try:
        front = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=iterations))
    except Refusal:
        return len(exact) > 0
    assert not any(violations(fleet, plan) for plan in front.plans)
    points = points_of(fleet, front.plans)
    assert nondominated(points).tolist() == list(range(len(points)))
    best = exact.min(axis=0)
    assert (points >= best * (1 - 1e-12)).all()
    return not np.allclose(points.min(axis=0), best, rtol=1e-12)


def test_the_search_finds_both_ends_of_fronts_whose_numbers_are_far_apart() -> None:
    seeds = few(10, range(40))
    missed = [s for s in seeds if misses(spread_fleet(s), 300)]
    assert len(missed) <= len(seeds) // 5, missed


@pytest.mark.parametrize(("over", "kind"), list(zip(OVERS, ("null", "huge"), strict=True)))
def test_five_hundred_stops_with_a_tenth_of_all_legs_closed_are_planned(
    over: tuple[Over, Over], kind: str
) -> None:
    rng = np.random.default_rng(0)
    n = 500
    places = rng.random((n, 2)) * 100
    lengths = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    costs = np.stack([lengths, lengths * rng.uniform(0.8, 1.2, (n, n))])
    costs[:, rng.random((n, n)) < 0.1] = {"null": inf, "huge": 1e12}[kind]
    visits = (Visit(), *(Visit(demand=(1,), service=1.0) for _ in range(n - 1)))
    vehicles = (van(count=50, capacity=(20,), shift=(0.0, 1e4)),)
    rules = Rules(visits=visits, vehicles=vehicles, over=over, clock=1)
    front = plan_fleet(Fleet(rules=rules, costs=costs), FleetOptions(time_limit=2))
    assert front.terminated == "time_limit"
    assert (front.points < 1e6).all()


@pytest.mark.parametrize("seed", few(3, range(12)))
def test_what_was_answered_is_accepted_as_the_longest_route_and_the_shift(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, clock = 10, (None, 0, 1)[seed % 3]
    costs = rng.random((2, n, n)) * 1000 / 7
    demands = [int(rng.integers(1, 9)) for _ in range(n)]
    stops = [Visit(demand=(d,), prize=1e12 if d > 7 else None) for d in demands[1:]]
    vehicle = van(count=4, capacity=(15,))
    rules = Rules(visits=(Visit(), *stops), vehicles=(vehicle,), over=("sum", "max"), clock=clock)
    fleet = Fleet(rules=rules, costs=costs)
    options = FleetOptions(time_limit=4, iterations=300)
    plan = plan_fleet(fleet, options).plans[-1]
    lengths = [route_lengths(fleet, route) for route in plan.routes]
    longest = max(each[1 if clock is None else clock] for each in lengths)
    bounds = {"longest": longest} | ({} if clock is None else {"shift": (0.0, longest)})
    tight = dataclasses.replace(rules, vehicles=(dataclasses.replace(vehicle, **bounds),))
    assert not violations(Fleet(rules=tight, costs=costs), plan)
    assert plan_fleet(Fleet(rules=tight, costs=costs), options).plans


def test_all_stops_that_no_way_connects_with_the_depot_are_named() -> None:
    costs = np.ones((2, 12, 12))
    costs[:, :8, 8:] = inf
    rules = Rules(visits=(Visit(),) * 12, vehicles=(VehicleType(start=0, end=0),))
    with pytest.raises(NoTour) as refused:
        check_necessary(Fleet(rules=rules, costs=costs))
    sentences = [fault.detail for fault in refused.value.errors]
    expected = [f"a way must lead to stop {i} from the start of a vehicle" for i in range(8, 12)]
    assert sentences == expected
    with pytest.raises(NoTour, match="from stop 8 to the end of a vehicle"):
        check_necessary(Fleet(rules=rules, costs=costs.transpose(0, 2, 1)))


def test_a_shipment_is_refused_where_no_way_leads_to_its_delivery() -> None:
    costs = np.ones((2, 4, 4))
    costs[:, :, 3] = inf
    visits = (Visit(),) * 4
    rules = Rules(visits=visits, vehicles=(van(capacity=()),), shipments=(Shipment(1, 3),))
    with pytest.raises(NoTour, match="a way must lead to stop 3"):
        check_necessary(Fleet(rules=rules, costs=costs))
