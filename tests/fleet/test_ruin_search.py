"""The search by ruin and recreate against brute force, in small fleets of all rules."""

from collections.abc import Callable
from math import inf
from operator import le

import numpy as np
import pytest

from service.fleet.evaluation import plan_lengths, points_of, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.necessary import fewest_vehicles
from service.fleet.plans import FleetFront
from service.fleet.rules import Rules
from service.fleet.search.search import RuinSearch
from service.fleet.vehicles import VehicleType, Visit
from service.watch import Watch
from tests.helpers.fleets import (
    bounded_fleet,
    exact_front,
    mixed_fleet,
    random_fleet,
    sampled_fleet,
    shipping_fleet,
    spreading_fleet,
    taking_fleet,
    tidy_fleet,
    varied_fleet,
    waiting_fleet,
)
from tests.helpers.sampled import few


def searched(fleet: Fleet, rounds: int = 300) -> RuinSearch:
    search = RuinSearch(fleet, FleetOptions(time_limit=inf, iterations=rounds), Watch[FleetFront]())
    search.run()
    return search


@pytest.mark.parametrize(
    "fleet_of",
    [
        *(random_fleet, bounded_fleet, mixed_fleet, shipping_fleet),
        *(tidy_fleet, varied_fleet, taking_fleet, spreading_fleet, sampled_fleet, waiting_fleet),
    ],
)
def test_small_fleets_have_plans_as_good_as_brute_force_and_none_better(
    fleet_of: Callable[[int], Fleet],
) -> None:
    tried = whole = 0
    for seed in few(6, range(90)):
        fleet = fleet_of(seed)
        expected = exact_front(fleet)
        search = searched(fleet)
        plans = [search.plan_at(index) for index in range(len(search))]
        assert [violations(fleet, plan) for plan in plans] == [[]] * len(plans)
        points = [plan_lengths(fleet, plan) for plan in plans]
        np.testing.assert_allclose(search.points, points_of(fleet, plans), rtol=1e-12, atol=1e-12)
        least = [np.multiply(each, 1 - 1e-12) for each in expected]
        assert all(any(all(map(le, each, point)) for each in least) for point in points)
        tried += 1
        # Equal lengths differ by a rounding where routes are summed in another order.
        most = [np.multiply(each, 1 + 1e-12) for each in expected]
        whole += all(any(all(map(le, point, each)) for point in points) for each in most)
    assert tried - whole <= max(1, 0.05 * tried)


@pytest.mark.parametrize(
    ("demands", "vehicles", "fewest"),
    [
        ([], [VehicleType(start=0, end=0, count=3)], 1),
        ([(7,)] * 3, [VehicleType(start=0, end=0, count=5, capacity=(10,))], 3),
        (
            [(7,)] * 3,
            [VehicleType(start=0, end=0, count=2, capacity=(size,)) for size in (4, 14)],
            2,
        ),
        ([(1, 9), (1, 9)], [VehicleType(start=0, end=0, count=4, capacity=(9, 9))], 2),
        ([(7,)] * 3, [VehicleType(start=0, end=0, count=5, capacity=(10,), reload=(0,))], 1),
    ],
)
def test_loads_need_some_vehicles(
    demands: list[tuple[int, ...]], vehicles: list[VehicleType], fewest: int
) -> None:
    visits = (Visit(), *(Visit(demand=each) for each in demands))
    rules = Rules(visits=visits, vehicles=tuple(vehicles), over=("sum", "vehicles"))
    assert fewest_vehicles(rules) == fewest
