"""The time limit is the whole of planning a fleet, here in seconds of the processor."""

import time

import numpy as np
import pytest

from service.fleet.evaluation import violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.left_out import explain
from service.fleet.planner import plan_fleet
from service.fleet.plans import FleetFront, Plan
from service.fleet.rules import Rules
from service.fleet.vehicles import VehicleType, Visit
from service.watch import Watch
from tests.helpers.pace import seconds_of_loop

MOST_LOOPS = 4  # times as long as a loop takes on this machine: 0.4 s where that is 0.1 s


def fleet_of(n: int, over: tuple[str, str], **visit: float) -> Fleet:
    random = np.random.default_rng(n)
    places = random.uniform(0, 60, (n, 2))
    costs = np.hypot(*np.moveaxis(places[:, np.newaxis] - places, -1, 0))
    orders = (Visit(demand=(int(load),), **visit) for load in random.integers(1, 9, n - 1))
    vans = VehicleType(start=0, end=0, count=n // 6, capacity=(30,))
    rules = Rules(visits=(Visit(), *orders), vehicles=(vans,), over=over, layers=(0, 0))
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


@pytest.mark.parametrize("over", [("sum", "max"), ("sum", "unassigned")])
def test_hundreds_of_stops_are_planned_within_a_tenth_of_a_second(
    over: tuple[str, str],
) -> None:
    watch = Watch[FleetFront](clock=time.process_time)
    fleet = fleet_of(400, over, **({"prize": 20.0} if "unassigned" in over else {}))
    plan_fleet(fleet, FleetOptions(time_limit=0.1), watch=watch)
    loop, seconds = seconds_of_loop(), []
    for _ in range(3):  # beside other programs a processor is slower, and not each time
        began = time.process_time()
        front = plan_fleet(fleet, FleetOptions(time_limit=0.1), watch=watch)
        explain(fleet, front.plans, front.points)
        seconds.append(time.process_time() - began)
        assert all(violations(fleet, plan) == [] for plan in front.plans)
    assert min(seconds) < MOST_LOOPS * max(loop, seconds_of_loop())


def test_without_time_stops_have_neither_a_price_nor_reasons() -> None:
    fleet = fleet_of(9, ("sum", "unassigned"), prize=1.0)
    nothing = Plan(())
    points = np.zeros((1, 2))
    left = iter([False] * 3)
    (servings,) = explain(fleet, [nothing], points, lambda: next(left, True))
    assert [each.price is not None for each in servings] == [True] * 3 + [False] * 5
    assert all(each.reasons == () for each in servings)
