"""Offers of an order in slots: against every place in every slot, judged one by one."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.fleet.vehicles import Shipment, Span, VehicleType, Visit
from service.offers.offers import MOST_CHOICES, find_offers
from tests.helpers.fleets import (
    bounded_fleet,
    every_plan,
    mixed_fleet,
    random_fleet,
    taking_fleet,
    tidy_fleet,
    waiting_fleet,
)
from tests.helpers.sampled import sixth

SLOTS: tuple[Span, ...] = ((0.0, 10.0), (8.0, 8.0), (15.0, 30.0), (40.0, 45.0), (60.0, 100.0))


def insertions(fleet: Fleet, plan: Plan, stop: int) -> Iterator[Plan]:
    """Yield every plan with a stop inserted, alone or beside one stop where to load again."""
    new = [
        (len(plan.routes), Route(index, ()))
        for index, vehicle in enumerate(fleet.rules.vehicles)
        if sum(route.vehicle == index for route in plan.routes) < vehicle.count
    ]
    for number, route in (*enumerate(plan.routes), *new):
        for place in range(len(route.stops) + 1):
            for reload in (None, *fleet.rules.vehicles[route.vehicle].reload):
                added = {stop, reload} - {None}
                for each in permutations(added):
                    stops = (*route.stops[:place], *each, *route.stops[place:])
                    longer = Route(route.vehicle, stops)
                    yield Plan((*plan.routes[:number], longer, *plan.routes[number + 1 :]))


def some_plans(fleet: Fleet, order: int) -> list[Plan]:
    """Return plans that keep all rules but that the order is not visited."""
    found: dict[Plan, None] = {}
    for plan in every_plan(fleet.rules):
        stops = [tuple(stop for stop in route.stops if stop != order) for route in plan.routes]
        pairs = zip(plan.routes, stops, strict=True)
        without = Plan(tuple(Route(route.vehicle, rest) for route, rest in pairs if rest))
        found[without] = None
    known = f"stop {order} is not visited"
    kept = [plan for plan in found if {*violations(fleet, plan)} <= {known}]
    return kept[:: max(1, len(kept) // 3)]


MAKERS = (random_fleet, bounded_fleet, mixed_fleet, waiting_fleet, tidy_fleet, taking_fleet)


@pytest.mark.parametrize("seed", range(sixth(40)))
@pytest.mark.parametrize("make", MAKERS)
def test_offers_are_those_of_every_place_in_every_slot(make: object, seed: int) -> None:
    fleet = make(seed)  # type: ignore[operator]
    rules = fleet.rules
    grouped = {stop for pair in rules.groups.ordered for stop in pair}
    known = rules.shipped | rules.promises | grouped
    alone = [stop for stop in rules.clients if stop not in known]
    if rules.clock is None or not alone:
        return
    order = alone[seed % len(alone)]
    for plan in some_plans(fleet, order):
        found = find_offers(fleet, plan, order, SLOTS)
        assert found.plan == plan
        base = np.array(plan_lengths(fleet, plan))
        for slot, offer in zip(SLOTS, found.offers, strict=True):
            visits = list(rules.visits)
            visits[order] = replace(visits[order], windows=(slot,))
            served = Fleet(rules=replace(rules, visits=tuple(visits)), costs=fleet.costs)
            # A prize that is no longer lost is no price of the order.
            prize = np.zeros(len(rules.over))
            paid = rules.over.index("unassigned") if "unassigned" in rules.over else 0
            prize[paid] = visits[order].prize or 0.0
            rises = [
                np.subtract(plan_lengths(served, each), base) + prize
                for each in insertions(served, plan, order)
                if not violations(served, each)
            ]
            assert offer.complete
            assert bool(offer.choices) == bool(rises) != bool(offer.reasons)
            if not rises:
                continue
            assert offer.rise == pytest.approx(np.min(rises, axis=0), abs=1e-6)
            best = [
                each
                for each in rises
                if not any((o <= each + 1e-9).all() and (o < each - 1e-9).any() for o in rises)
            ]
            distinct = np.unique(np.round(best, 6), axis=0)
            assert len(offer.choices) == min(len(distinct), MOST_CHOICES)
            for choice in offer.choices:
                assert np.isclose(choice.rise, distinct, atol=1e-5).all(axis=1).any()


def test_an_optional_shipment_that_the_plan_leaves_out_stays_out() -> None:
    rules = Rules(
        visits=(Visit(), Visit(prize=5.0), Visit(), Visit()),
        vehicles=(VehicleType(start=0, end=0),),
        shipments=(Shipment(1, 2),),
        clock=0,
    )
    fleet = Fleet(rules=rules, costs=np.ones((2, 4, 4)))
    assert find_offers(fleet, Plan(()), 3, SLOTS).plan == Plan(())
