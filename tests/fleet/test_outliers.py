"""Fleets with costs of very different sizes, forbidden legs, and bounds that are just kept."""

import dataclasses
from functools import cache
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.construction.call_estimate import CallEstimate
from service.errors import Cancelled, InvalidInstance, Refusal
from service.fleet.enumeration import exact_plans
from service.fleet.evaluation import points_of, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.planner import plan_fleet
from service.fleet.plans import FleetFront, path_of
from service.fleet.reference_point import default_reference_point
from service.fleet.rules import Rules
from service.fleet.schedule import schedule
from service.fleet.vehicles import ALWAYS, Shipment, VehicleType, Visit
from service.instance import Instance
from service.pareto import nondominated
from service.watch import Watch
from tests.helpers.fleets import exact_front, random_fleet
from tests.helpers.sampled import few, sixth, tenth

VAN = VehicleType(start=0, end=0, count=2, capacity=(9,))
ITERATIONS = 300


def with_costs(seed: int, n: int, over: tuple[str, str]) -> Fleet:
    """Two vans and costs of whole numbers, some of which are huge or forbidden."""
    rng = np.random.default_rng(seed)
    costs = rng.integers(1, 100, (2, n, n)).astype(float)
    spread = rng.choice([4, 9, 12])
    costs[rng.random((2, n, n)) < 0.08] = 10.0**spread
    costs[0][rng.random((n, n)) < 0.1] = inf
    visits = (Visit(), *(Visit(demand=(int(rng.integers(1, 4)),)) for _ in range(n - 1)))
    van = dataclasses.replace(VAN, capacity=(2 * n,))
    return Fleet(rules=Rules(visits=visits, vehicles=(van,), over=over), costs=costs)


@pytest.mark.parametrize("over", [("sum", "sum"), ("sum", "max"), ("max", "sum")])
@pytest.mark.parametrize("seed", range(sixth(8)))
def test_a_few_stops_of_any_costs_give_the_front_of_all_plans(
    seed: int, over: tuple[str, str]
) -> None:
    fleet = with_costs(seed, 5, over)
    known = exact_front(fleet)
    if not known:
        with pytest.raises(Refusal, match="plan"):
            plan_fleet(fleet, FleetOptions(time_limit=5))
        return
    front = plan_fleet(fleet, FleetOptions(time_limit=5))
    np.testing.assert_allclose(front.points, known, rtol=1e-12)


@pytest.mark.parametrize("seed", few(1, range(3)))
def test_the_search_finds_the_least_of_both_lengths_in_costs_of_any_size(seed: int) -> None:
    fleet = with_costs(100 + seed, 8, ("sum", "sum"))
    plans = exact_plans(fleet)
    assert plans
    exact = points_of(fleet, plans)
    front = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=5_000))
    assert not any(violations(fleet, plan) for plan in front.plans)
    np.testing.assert_allclose(front.points.min(axis=0), exact.min(axis=0), rtol=1e-12)


@cache
def front_with_one_leg(cost: float) -> FleetFront:
    """The front of three vans and twenty stops, where one leg has this cost."""
    costs = np.random.default_rng(7).integers(1, 100, (2, 21, 21)).astype(float)
    costs[:, 3, 4] = cost
    rules = Rules(
        visits=(Visit(), *(Visit(demand=(1,)) for _ in range(20))),
        vehicles=(VehicleType(start=0, end=0, count=3, capacity=(8,)),),
    )
    options = FleetOptions(time_limit=inf, iterations=500)
    return plan_fleet(Fleet(rules=rules, costs=costs), options)


@pytest.mark.parametrize("cost", few(2, [2147483647.0, 1e200, 1e6, 1e12]))
def test_one_leg_coded_as_a_big_number_makes_no_plan_longer(cost: float) -> None:
    known, found = front_with_one_leg(inf), front_with_one_leg(cost)
    assert (found.points.min(axis=0) <= 1.03 * known.points.min(axis=0)).all()
    assert found.points.max() < 5_000


def test_a_plan_that_must_take_a_big_leg_is_found_at_its_true_cost() -> None:
    costs = np.full((2, 9, 9), 5.0)
    costs[:, 4, :], costs[:, :, 4] = 1e9, 1e9
    rules = Rules(visits=(Visit(),) * 9, vehicles=(VehicleType(start=0, end=0),))
    front = plan_fleet(Fleet(rules=rules, costs=costs), FleetOptions(time_limit=inf, iterations=50))
    assert front.points.tolist() == [[2e9 + 7 * 5, 2e9 + 7 * 5]]


def test_a_stop_without_a_way_is_named() -> None:
    costs = np.ones((2, 8, 8))
    costs[1, :, 3] = inf
    rules = Rules(visits=(Visit(),) * 8, vehicles=(VehicleType(start=0, end=0),))
    with pytest.raises(Refusal, match="a way must lead to stop 3 from the start"):
        plan_fleet(Fleet(rules=rules, costs=costs), FleetOptions(time_limit=1))


@pytest.mark.parametrize("seed", few(1, range(12)))
def test_a_tight_capacity_hides_neither_end_of_two_sums(seed: int) -> None:
    rng = np.random.default_rng(seed)
    costs = rng.integers(1, 100, (2, 8, 8)).astype(float)
    visits = (Visit(), *(Visit(demand=(int(rng.integers(1, 4)),)) for _ in range(7)))
    van = dataclasses.replace(VAN, capacity=(16,))
    fleet = Fleet(rules=Rules(visits=visits, vehicles=(van,)), costs=costs)
    front = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=5_000))
    exact = points_of(fleet, exact_plans(fleet) or ())
    np.testing.assert_array_equal(front.points.min(axis=0), exact.min(axis=0))


class AnyOrder:
    """A network whose tours visit the stops in random orders."""

    estimate = CallEstimate("matrices")

    def tours(self, instance: Instance, preferences: np.ndarray, _repairs: int = 0) -> np.ndarray:
        rng = np.random.default_rng(1)
        return np.array([rng.permutation(instance.n) for _ in preferences])

    def terminate(self) -> None:
        """Do nothing: no call takes long."""


def test_no_plan_takes_a_forbidden_leg_without_time_either() -> None:
    fleet = with_costs(3, 9, ("sum", "sum"))
    assert fleet.forbids
    front = plan_fleet(fleet, FleetOptions(time_limit=0), AnyOrder())
    assert np.isfinite(front.points).all()
    assert not any(violations(fleet, plan) for plan in front.plans)


@pytest.mark.parametrize("seed", range(sixth(40)))
def test_what_was_answered_is_accepted_as_windows(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 9
    costs = rng.random((2, n, n)) * 1000 / 7
    van = VehicleType(start=0, end=0, count=3, shift=(100 / 3, 1e5))
    rules = Rules(
        visits=(Visit(), *(Visit(service=float(rng.random())) for _ in range(n - 1))),
        vehicles=(van,),
        clock=0,
    )
    fleet = Fleet(rules=rules, costs=costs)
    options = FleetOptions(time_limit=4, iterations=ITERATIONS)
    plan = plan_fleet(fleet, dataclasses.replace(options, iterations=30)).plans[0]
    windows = {}
    for route in plan.routes:
        times = schedule(fleet, route)
        windows |= dict(zip(path_of(rules, route)[1:-1], times.arrivals[1:-1], strict=True))
    visits = tuple(
        dataclasses.replace(
            visit, windows=((windows[i], windows[i]),) if i in windows else (ALWAYS,)
        )
        for i, visit in enumerate(rules.visits)
    )
    tight = Fleet(rules=dataclasses.replace(rules, visits=visits), costs=costs)
    assert not violations(tight, plan)
    assert plan_fleet(tight, options).plans


def test_the_default_reference_point_leaves_room_for_waiting() -> None:
    costs = np.random.default_rng(1).random((2, 6, 6))
    visits = (Visit(), *(Visit(windows=((7200.0 * i, 7200.0 * i + 60),)) for i in range(5)))
    rules = Rules(visits=visits, vehicles=(VehicleType(start=0, end=0),), clock=1)
    front = plan_fleet(Fleet(rules=rules, costs=costs), FleetOptions(time_limit=1))
    assert front.hypervolume > 0
    assert (front.points < front.reference_point).all()
    assert default_reference_point(front.fleet)[1] > 4 * 7200


@pytest.mark.parametrize("limit", [0.0, 0.01])
def test_enumeration_leaves_the_search_its_time_and_stops_when_told(limit: float) -> None:
    van = VehicleType(start=0, end=0, capacity=(9,))
    rules = Rules(visits=(Visit(),) * 7, vehicles=(van,) * 6)
    fleet = Fleet(rules=rules, costs=np.random.default_rng(1).random((2, 7, 7)))
    with pytest.raises((Cancelled, Refusal)):
        plan_fleet(fleet, FleetOptions(time_limit=limit), watch=Watch(stop=lambda: True))
    calls: list[None] = []
    assert exact_plans(fleet, lambda: bool(calls.append(None)) or len(calls) > 100) is None


def test_a_shipment_that_closes_before_it_opens_is_no_plan() -> None:
    visits = (Visit(), Visit(windows=((100, 200),)), Visit(windows=((0, 50),)), *(Visit(),) * 6)
    for prize in (None, 5.0):
        given = (visits[0], dataclasses.replace(visits[1], prize=prize), *visits[2:])
        rules = Rules(
            visits=given,
            vehicles=(VehicleType(start=0, end=0),),
            shipments=(Shipment(1, 2),),
            clock=1,
        )
        fleet = Fleet(rules=rules, costs=np.ones((2, 9, 9)))
        options = FleetOptions(time_limit=inf, iterations=50)
        if prize is None:
            with pytest.raises(Refusal, match="stop 2, where a shipment is delivered, closes"):
                plan_fleet(fleet, options)
        else:
            assert all(len(list(plan.visited())) == 6 for plan in plan_fleet(fleet, options).plans)


TIMES = st.sampled_from([0.0, 1e-9, 0.5, 7.0, 1e3, 86_400.0, 1e9, 1e15, 1e18, 1e300, inf])


@settings(max_examples=tenth(400), deadline=None)
@given(data=st.data(), seed=st.integers(0, 10**6))
def test_what_no_engine_would_take_is_refused_and_never_an_error(
    data: st.DataObject, seed: int
) -> None:
    draw = data.draw
    fleet = random_fleet(seed)
    rules = fleet.rules

    def span() -> tuple[float, float]:
        begin = draw(TIMES.filter(lambda time: time < inf))
        return begin, max(begin, draw(TIMES))

    timed = rules.clock is not None
    visits = tuple(
        visit
        if i in rules.depots or not timed or draw(st.booleans())
        else dataclasses.replace(
            visit, windows=(span(),), service=draw(TIMES.filter(lambda time: time < inf))
        )
        for i, visit in enumerate(rules.visits)
    )
    vehicles = tuple(
        dataclasses.replace(vehicle, shift=span() if timed else ALWAYS)
        for vehicle in rules.vehicles
    )
    scale = draw(st.sampled_from([1e-300, 1e-5, 1.0, 1e7, 1e12, 1e200]))
    try:
        changed = Fleet(
            rules=dataclasses.replace(rules, visits=visits, vehicles=vehicles),
            costs=fleet.costs * scale,
        )
        front = plan_fleet(changed, FleetOptions(time_limit=0.02, iterations=20))
    except (Refusal, InvalidInstance):
        return
    points = points_of(changed, front.plans)
    assert not any(violations(changed, plan) for plan in front.plans)
    assert len(nondominated(points)) == len(points)
