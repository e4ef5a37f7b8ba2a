"""Fronts of plans against brute force, and what every front promises."""

import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import count
from math import inf
from typing import Any

import numpy as np
import pytest

from service.errors import Cancelled, Refusal
from service.fleet.evaluation import plan_lengths, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.necessary import least_lengths
from service.fleet.planner import plan_fleet
from service.fleet.plans import FleetFront, kept_share
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import ALWAYS, Shipment, VehicleType, Visit
from service.pareto import nondominated
from service.watch import Progress, Watch
from tests.helpers.actors import Shuffler, info_of
from tests.helpers.fleets import (
    Point,
    bounded_fleet,
    exact_front,
    mixed_fleet,
    random_fleet,
    share_of_front,
)
from tests.helpers.sampled import few, sixth

ENOUGH = FleetOptions(time_limit=inf, iterations=20_000)


def points_of(front: FleetFront) -> list[Point]:
    return [tuple(point.tolist()) for point in front.points]


def deliveries(
    n: int, over: Sequence[Over] = ("sum", "max"), seed: int = 1, width: float = 5.0
) -> Fleet:
    """Return a fleet with a depot, n stops with windows of a width, and vehicles enough."""
    random = np.random.default_rng(seed)
    places = random.random((n + 1, 2))
    costs = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    begins = random.random(n) * 5
    visits = [
        Visit(demand=(1,), windows=((begin, begin + width),), service=0.1) for begin in begins
    ]
    rules = Rules(
        visits=(Visit(), *visits),
        vehicles=(VehicleType(start=0, end=0, count=n // 5 + 1, capacity=(10,), shift=(0, 12)),),
        over=over,
        clock=1,
    )
    return Fleet(rules=rules, costs=np.stack([costs**2, costs]))


@pytest.mark.parametrize("seed", range(sixth(60)))
@pytest.mark.parametrize("fleet_of", [random_fleet, bounded_fleet, mixed_fleet])
def test_a_handful_of_stops_has_the_front_of_brute_force(
    fleet_of: Callable[[int], Fleet], seed: int
) -> None:
    fleet = fleet_of(seed)
    if expected := exact_front(fleet):
        front = plan_fleet(fleet, FleetOptions(time_limit=inf))
        assert points_of(front) == expected
        assert front.terminated == "converged"
    else:
        with pytest.raises(Refusal) as refused:
            plan_fleet(fleet, FleetOptions(time_limit=inf))
        assert refused.value.code == "no-plan"


def test_iterations_and_seed_decide_the_front() -> None:
    fleet = deliveries(16)
    options = FleetOptions(time_limit=inf, iterations=400, seed=3)
    first, second = plan_fleet(fleet, options), plan_fleet(fleet, options)
    assert first.plans == second.plans


@pytest.mark.parametrize("over", [("sum", "max"), ("max", "sum"), ("sum", "sum")])
def test_no_plan_is_dominated_or_breaks_a_rule(over: tuple[Over, Over]) -> None:
    fleet = deliveries(20, over)
    front = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=600, size=5))
    assert 1 < len(front.plans) <= 5
    assert nondominated(front.points).tolist() == list(range(len(front.plans)))
    for plan, point in zip(front.plans, front.points, strict=True):
        assert violations(fleet, plan) == []
        assert plan_lengths(fleet, plan) == tuple(point)


def test_progress_is_reported_and_a_stop_ends_with_what_was_found() -> None:
    reports: list[tuple[int, int]] = []

    def report(progress: Progress, best: Callable[[int], FleetFront]) -> None:
        reports.append((progress.points, len(best(3).plans)))

    fleet = deliveries(20)
    options = FleetOptions(time_limit=60.0)
    front = plan_fleet(fleet, options, watch=Watch(stop=lambda: len(reports) > 1, report=report))
    assert front.terminated == "cancelled"
    assert front.plans
    assert all(0 < plans <= min(3, points) for points, plans in reports)


def test_a_stop_before_the_first_plan_cancels() -> None:
    with pytest.raises(Cancelled):
        plan_fleet(deliveries(20), FleetOptions(time_limit=60.0), watch=Watch(stop=lambda: True))


def test_the_time_limit_is_kept_and_a_front_there() -> None:
    front = plan_fleet(deliveries(30), FleetOptions(time_limit=0.3))
    assert front.terminated == "time_limit"
    assert front.plans


def test_a_fleet_of_depots_alone_has_the_plan_in_which_nobody_leaves() -> None:
    rules = Rules(visits=(Visit(),), vehicles=(VehicleType(start=0, end=0),))
    front = plan_fleet(Fleet(rules=rules, costs=np.zeros((2, 1, 1))), FleetOptions(time_limit=1))
    assert [plan.routes for plan in front.plans] == [()]


NEAR = Visit(demand=(2,))
IMPOSSIBLE = [
    ({"visits": (Visit(), Visit(demand=(9,)), NEAR)}, "the demand of stop 1"),
    ({"visits": (Visit(), *(Visit(demand=(3,)),) * 3)}, "the demands sum to 9, and all"),
    (
        {"visits": (Visit(), Visit(windows=((0, 1),)), NEAR), "clock": 0},
        "stop 1 cannot be reached within its window by any vehicle",
    ),
]


@pytest.mark.parametrize(("rules", "sentence"), IMPOSSIBLE)
def test_a_necessary_condition_that_fails_is_named(rules: dict[str, Any], sentence: str) -> None:
    fleet = Fleet(
        rules=Rules(**rules, vehicles=(VehicleType(start=0, end=0, capacity=(4,), count=2),)),
        costs=np.full((2, len(rules["visits"]), len(rules["visits"])), 3.0),
    )
    with pytest.raises(Refusal, match=sentence):
        plan_fleet(fleet, FleetOptions(time_limit=1))


@pytest.mark.parametrize("seed", range(sixth(60)))
def test_no_plan_goes_below_the_least_lengths(seed: int) -> None:
    fleet = random_fleet(seed)
    least = least_lengths(fleet)
    assert all((point >= least).all() for point in np.array(exact_front(fleet)).reshape(-1, 2))


def test_least_lengths_are_those_of_the_legs_to_and_from_each_stop() -> None:
    costs = np.array([[[0, 4, 9], [2, 0, 7], [3, 5, 0]]] * 2, float)
    for start, end, expected in ((0, None, [11, 7]), (None, 0, [5, 3]), (0, 0, [11, 7])):
        vehicles = (VehicleType(start=start, end=end, count=2),)
        rules = Rules(visits=(Visit(),) * 3, vehicles=vehicles, over=("sum", "max"))
        assert least_lengths(Fleet(rules=rules, costs=costs)).tolist() == expected
    free = Rules(visits=(Visit(),) * 3, vehicles=(VehicleType(),))
    assert least_lengths(Fleet(rules=free, costs=costs)).tolist() == [0, 0]


def test_what_was_not_found_in_time_is_said_so() -> None:
    fleet = deliveries(20)
    # Three to a stop and four to a vehicle: all vehicles hold more than all stops ask for.
    visits = (Visit(), *(Visit(demand=(3,)),) * 20)
    tight = Rules(visits=visits, vehicles=(VehicleType(start=0, capacity=(4,), count=16),))
    with pytest.raises(Refusal, match=r"no plan was found in 0.1 s"):
        plan_fleet(Fleet(rules=tight, costs=fleet.costs), FleetOptions(time_limit=0.1))


@pytest.mark.parametrize("over", [("sum", "sum"), ("sum", "max")])
def test_where_capacities_have_room_there_is_a_plan_in_any_time(over: tuple[Over, Over]) -> None:
    costs = deliveries(99).costs
    visits = (Visit(), *(Visit(demand=(1,)),) * 99)
    vans = VehicleType(start=0, end=0, capacity=(30,), count=4)
    fleet = Fleet(rules=Rules(visits=visits, vehicles=(vans,), over=over), costs=costs)
    front = plan_fleet(fleet, FleetOptions(time_limit=1e-300))
    assert front.plans
    assert all(violations(fleet, plan) == [] for plan in front.plans)


@pytest.mark.parametrize("n", [20, 60, 150])
def test_a_deadline_that_has_passed_still_gives_a_plan_of_narrow_windows(n: int) -> None:
    """A process that is held up has passed its deadline before it begins to search."""
    front = plan_fleet(deliveries(n, width=1.0), FleetOptions(time_limit=1e-300))
    assert all(not violations(front.fleet, plan) for plan in front.plans)


@pytest.mark.parametrize("time_limit", [1e-300, 1e-3])
@pytest.mark.parametrize("over", [("sum", "sum"), ("sum", "max")])
@pytest.mark.parametrize("n", [1, 2, 5, 40])
def test_where_no_rule_can_be_broken_there_is_a_plan_in_any_time(
    n: int, over: tuple[Over, Over], time_limit: float
) -> None:
    costs = np.random.default_rng(n).random((2, n, n))
    vans = [
        tuple(VehicleType(start=i % n, end=end, fixed=i * (over[0] == "sum")) for i in range(40))
        for end in (None, 0)
    ]
    prized = tuple(Visit(prize=5.0 if i % 3 else None) for i in range(n))
    shipped = Rules(
        visits=(Visit(),) * n,
        vehicles=(VehicleType(capacity=(1,)), VehicleType(capacity=(2,))),
        shipments=tuple(Shipment(i + 1, i) for i in range(0, n - 1, 2)),
        over=over,
    )
    anywhere = VehicleType(count=10**6)
    for rules in (
        *(Rules(visits=(Visit(),) * n, vehicles=each, over=over) for each in vans),
        Rules(visits=prized, vehicles=(anywhere,), over=over),
        shipped,
    ):
        fleet = Fleet(rules=rules, costs=costs)
        front = plan_fleet(fleet, FleetOptions(time_limit=time_limit))
        assert len(front.plans) >= 1
        assert not any(violations(fleet, plan) for plan in front.plans)


@pytest.mark.parametrize("over", [("sum", "sum"), ("sum", "max")])
def test_units_of_any_size_change_no_front(over: tuple[Over, Over]) -> None:
    costs = np.random.default_rng(0).integers(1, 50, (2, 14, 14)).astype(float)
    rules = Rules(visits=(Visit(),) * 14, vehicles=(OPEN,), over=over)
    options = FleetOptions(time_limit=inf, iterations=300)
    expected = plan_fleet(Fleet(rules=rules, costs=costs), options)
    for units in ((1e-200, 1e-200), (1e-150, 1e-9), (1e9, 1e-9), (1e9, 1e150)):
        scaled = costs * np.array(units)[:, np.newaxis, np.newaxis]
        front = plan_fleet(Fleet(rules=rules, costs=scaled), options)
        assert share_of_front(expected, front) == pytest.approx(1.0, abs=0.005)
        assert len(front.plans) > 2


OPEN = VehicleType(start=0, count=3)


def test_tiny_costs_and_times_are_planned_like_common_ones() -> None:
    unit = 2.0**-1040
    common = deliveries(8)
    visits = tuple(
        replace(visit, service=visit.service * unit, windows=((begin * unit, end * unit),))
        for visit in common.rules.visits
        for begin, end in visit.windows
    )
    vehicles = (replace(common.rules.vehicles[0], shift=(0, 12 * unit)),)
    rules = replace(common.rules, visits=visits, vehicles=vehicles)
    tiny = Fleet(rules=rules, costs=common.costs * unit)
    options = FleetOptions(time_limit=inf, iterations=500)
    expected, front = (plan_fleet(fleet, options) for fleet in (common, tiny))
    assert [violations(tiny, plan) for plan in front.plans] == [[]] * len(front.plans)
    np.testing.assert_allclose(front.points / unit, expected.points, rtol=1e-5)
    assert front.hypervolume == pytest.approx(expected.hypervolume, rel=1e-5)


def test_times_that_tiny_costs_leave_no_double_for_are_refused() -> None:
    fleet = deliveries(8)
    visits = (Visit(), *(Visit(windows=((1e150, inf),)),) * 8)
    rules = replace(fleet.rules, visits=visits, vehicles=(OPEN,))
    with pytest.raises(Refusal, match="too far apart"):
        plan_fleet(Fleet(rules=rules, costs=fleet.costs * 1e-310), FleetOptions(time_limit=1))


def plain_deliveries(n: int) -> Fleet:
    """Return deliveries without windows."""
    fleet = deliveries(n)
    visits = (Visit(), *(Visit(demand=(1,)),) * n)
    return Fleet(rules=replace(fleet.rules, visits=visits), costs=fleet.costs)


def shuffler() -> Shuffler:
    return Shuffler(info=info_of("shuffler", "matrices"))


def test_without_time_the_tours_of_the_network_are_cut() -> None:
    fleet = plain_deliveries(20)
    front = plan_fleet(fleet, FleetOptions(time_limit=0, size=4), shuffler())
    assert (front.terminated, len(front.plans)) == ("converged", 4)
    assert front.constructed >= front.found >= 4
    assert [violations(fleet, plan) for plan in front.plans] == [[]] * 4


@pytest.mark.parametrize("pause", [0.0, 1e-3, 9.0])
def test_without_time_a_fleet_has_the_same_plans_on_any_machine(pause: float) -> None:
    """Between two looks at the clock of a slow machine, much time passes."""
    ticks = count()
    watch = Watch[FleetFront](clock=lambda: pause * next(ticks))
    front = plan_fleet(deliveries(6), FleetOptions(time_limit=0), shuffler(), watch)
    assert points_of(front) == points_of(plan_fleet(deliveries(6), ENOUGH))
    assert front.constructed == 0  # all plans were compared


def test_what_is_too_large_to_be_cut_is_refused_without_time() -> None:
    fleet = plain_deliveries(12)
    types = tuple(replace(fleet.rules.vehicles[0], count=9) for _ in range(100))
    fleet = Fleet(rules=replace(fleet.rules, vehicles=types), costs=fleet.costs)
    with pytest.raises(Refusal, match="this many stops, types"):
        plan_fleet(fleet, FleetOptions(time_limit=0), shuffler())


def test_what_no_cut_of_a_tour_keeps_is_refused_without_time() -> None:
    options = FleetOptions(time_limit=0)
    fleet = deliveries(20)
    narrow = [replace(visit, windows=((1.0, 1.2),)) for visit in fleet.rules.visits[1:]]
    rules = replace(fleet.rules, visits=(Visit(), *narrow))
    fleet = Fleet(
        rules=replace(rules, vehicles=(replace(rules.vehicles[0], count=3),)), costs=fleet.costs
    )
    with pytest.raises(Refusal, match="no cut of the network's tours"):
        plan_fleet(fleet, options, shuffler())
    with pytest.raises(Refusal, match="need an actor"):
        plan_fleet(fleet, options)
    with pytest.raises(Cancelled):
        plan_fleet(fleet, options, shuffler(), watch=Watch(stop=lambda: True))


def loading_again(fleet: Fleet) -> Fleet:
    """Return a fleet whose vehicles hold a fifth of all stops, and may load again."""
    rules = fleet.rules
    visits = tuple(
        replace(each, demand=(int(place > 0),)) for place, each in enumerate(rules.visits)
    )
    (van,) = rules.vehicles
    van = replace(van, count=3, capacity=(5,), reload=(0,), shift=ALWAYS)
    return Fleet(rules=replace(rules, visits=visits, vehicles=(van,)), costs=fleet.costs)


@pytest.mark.parametrize(
    ("over", "loads", "size"),
    few(
        2,
        [
            (("sum", "max"), False, 100),
            (("sum", "vehicles"), True, 1),
            (("sum", "max"), True, 1),
            (("sum", "vehicles"), False, 100),
        ],
    ),
)
def test_a_plan_that_keeps_most_of_the_driven_one_is_in_its_front(
    over: tuple[Over, Over], loads: bool, size: int
) -> None:
    """The driven plan is hardly longer than the best: such plans are many, and few keep it."""
    fleet = deliveries(24, over, seed=3)
    if loads:
        fleet = loading_again(fleet)
    long = plan_fleet(fleet, FleetOptions(time_limit=inf, iterations=700))
    driven = long.plans[len(long.plans) // 2]
    options = FleetOptions(time_limit=inf, iterations=400, driven=driven, size=size)
    front = plan_fleet(fleet, options)
    assert len(front.plans) <= size
    assert (np.diff(front.points[:, 0]) >= 0).all()
    kept = max(kept_share(driven, plan) for plan in front.plans)
    lengths = np.array(plan_lengths(fleet, driven))
    near = (lengths <= 1.05 * front.points).all(axis=1).any()
    assert kept >= 0.9 or not near
    for plan, point in zip(front.plans, front.points, strict=True):
        assert violations(fleet, plan) == []
        assert plan_lengths(fleet, plan) == tuple(point)


def crowded(seed: int) -> Fleet:
    """Return a fleet with windows and releases whose vans rest, load again and have a limit."""
    random = np.random.default_rng([100, seed])
    places = np.concatenate(([[50.0, 50.0]], random.uniform(0, 100, (100, 2))))
    costs = np.linalg.norm(places[:, np.newaxis] - places, axis=2)

    def visit() -> Visit:
        begin = float(random.integers(60, 400))
        windowed, released = random.random(2) < (0.5, 0.1)
        return Visit(
            demand=(int(random.integers(1, 10)),),
            service=3.0,
            windows=((begin, begin + 120.0),) if windowed else (ALWAYS,),
            release=begin - 60.0 if released else 0.0,
        )

    van = VehicleType(
        start=0,
        end=0,
        count=5,
        capacity=(90,),
        shift=(0.0, 540.0),
        longest=280.0,
        reload=(0,),
        max_trips=2,
        max_overtime=60.0,
        breaks=((120.0, 420.0, 30.0),),
    )
    visits = (Visit(), *(visit() for _ in range(100)))
    rules = Rules(visits=visits, vehicles=(van,), over=("sum", "max"), clock=1)
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


def test_a_search_ends_where_vans_in_limited_time_load_again_what_is_released() -> None:
    """Compiled code cannot be interrupted, so another process waits for it."""
    code = (
        "from service.errors import Refusal\n"
        "from service.fleet.fronts import FleetOptions\n"
        "from service.fleet.planner import plan_fleet\n"
        "from tests.fleet.test_planner import crowded\n"
        "for seed in range(3):\n"
        "    try: plan_fleet(crowded(seed), FleetOptions(time_limit=0.5, seed=seed))\n"
        "    except Refusal: pass\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=90)
