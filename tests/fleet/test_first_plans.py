"""First plans against brute force, with every rule that can be cut by; and at sizes beyond that."""

import dataclasses
from itertools import pairwise
from math import inf

import numpy as np
import pytest

from service.errors import Refusal
from service.fleet.evaluation import plan_lengths, violations
from service.fleet.first_plans import Cutter, without_changes
from service.fleet.fleet import Fleet
from service.fleet.optimal_split import Indices
from service.fleet.plans import Plan
from service.fleet.rules import Rules
from service.fleet.vehicles import Shipment, VehicleType, Visit
from service.pareto import nondominated
from tests.helpers.fleet_days import day_fleet
from tests.helpers.fleets import Point, every_plan, hull_corners, random_fleet
from tests.helpers.sampled import sixth


def cut(fleet: Fleet, *sequences: Indices) -> list[Plan]:
    return list(Cutter(fleet, sequences, lambda: False).plans())


def follows(plan: Plan, sequence: Indices) -> bool:
    """Return whether each route visits neighbours in a cyclic sequence, in its order."""
    places = {stop: place for place, stop in enumerate(sequence.tolist())}
    return all(
        (places[b] - places[a]) % len(places) == 1
        for route in plan.routes
        for a, b in pairwise(route.stops)
    )


def front_of(fleet: Fleet, plans: list[Plan]) -> list[Point]:
    points = np.array(sorted({plan_lengths(fleet, plan) for plan in plans})).reshape(-1, 2)
    return [(float(x), float(y)) for x, y in points[nondominated(points)]]


def without_shipments(seed: int) -> Fleet:
    fleet = random_fleet(seed)
    return Fleet(rules=dataclasses.replace(fleet.rules, shipments=()), costs=fleet.costs)


@pytest.mark.parametrize("seed", range(sixth(80)))
def test_cuts_have_the_front_of_all_plans_that_follow_the_sequence(seed: int) -> None:
    fleet = without_shipments(seed)
    sequence = np.random.default_rng(seed).permutation(fleet.rules.clients)
    plans = [
        plan
        for plan in every_plan(fleet.rules)
        if follows(plan, sequence) and not violations(fleet, plan)
    ]
    expected, found = front_of(fleet, plans), cut(fleet, sequence)
    assert all(violations(fleet, plan) == [] and follows(plan, sequence) for plan in found)
    points = front_of(fleet, found)
    if fleet.rules.maximum is not None:
        assert points == expected
    else:
        assert hull_corners(points) == hull_corners(expected)


def uniform(n: int, **vehicle: object) -> Fleet:
    places = np.random.default_rng(n).random((n + 1, 2))
    costs = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    rules = Rules(
        visits=(Visit(), *(Visit(demand=(1,)),) * n),
        vehicles=(VehicleType(start=0, end=0, capacity=(n,), **vehicle),),
        over=("sum", "max"),
    )
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


def test_of_several_sequences_each_plan_follows_the_best() -> None:
    fleet = uniform(12, count=12)
    random = np.random.default_rng(0)
    sequences = [random.permutation(np.arange(1, 13)) for _ in range(5)]
    alone = [plan for sequence in sequences for plan in cut(fleet, sequence)]
    assert front_of(fleet, cut(fleet, *sequences)) == front_of(fleet, alone)


def test_first_plans_descend_to_the_stop_that_is_farthest_away() -> None:
    fleet = uniform(40, count=40)
    plans = cut(fleet, np.arange(1, 41))
    longest = [plan_lengths(fleet, plan)[1] for plan in plans]
    assert all(a > b for a, b in pairwise(longest))
    assert longest[-1] == pytest.approx(2 * fleet.costs[0, 0].max())


def test_few_vehicles_are_not_exceeded_and_their_sequence_has_one_begin() -> None:
    """So many stops that the cyclic order would take too long."""
    fleet = uniform(150, count=4)
    plans = cut(fleet, np.arange(1, 151), np.arange(150, 0, -1))
    assert {len(plan.routes) for plan in plans} == {1, 2, 3, 4}
    assert all(violations(fleet, plan) == [] for plan in plans)


@pytest.mark.parametrize("costs", [(0.0, 0.0), (1.0, 0.0), (1e-310, 1.0), (1e-310, 1e-310)])
def test_fleets_of_costs_of_any_magnitude_are_cut(costs: tuple[float, float]) -> None:
    fleet = uniform(6)
    rules = dataclasses.replace(fleet.rules, over=("sum", "sum"))
    scaled = Fleet(rules=rules, costs=fleet.costs * np.array(costs)[:, np.newaxis, np.newaxis])
    with np.errstate(all="raise", under="ignore"):
        assert cut(scaled, np.arange(6))


def test_what_cannot_be_cut_is_refused() -> None:
    fleet = uniform(3)
    shipped = dataclasses.replace(fleet.rules, shipments=(Shipment(1, 2),), visits=(Visit(),) * 4)
    with pytest.raises(Refusal, match="shipments need a time_limit"):
        cut(Fleet(rules=shipped, costs=fleet.costs), np.arange(1, 4))
    many = tuple(VehicleType(start=0, count=9, longest=inf) for _ in range(10))
    fleet = Fleet(rules=Rules(visits=(Visit(),) * 12, vehicles=many), costs=np.ones((2, 12, 12)))
    with pytest.raises(Refusal, match="this many stops, types"):
        cut(fleet, np.arange(1, 12))


def test_whatever_breaks_a_rule_over_the_day_breaks_it_at_the_greatest_times() -> None:
    planned = 0
    for seed in range(sixth(60)):
        fleet = day_fleet(seed)
        *_, slowest = without_changes(fleet)
        try:
            plans = cut(slowest, np.array(fleet.rules.clients))
        except Refusal:  # it has shipments, breaks or several windows
            continue
        for plan in plans:
            broken = {each.rule for each in violations(fleet, plan)} - {"shortest"}
            assert broken <= {each.rule for each in violations(slowest, plan)}
            planned += not broken
    assert planned > 10
