"""`python -m tests.benchmarks bounds`: fleets with the bounds of dispatchers, and their replanning.

Instances are our own: depot in the middle and stops uniform in a square of 100 by 100, which takes
100 minutes to cross; half of the stops have a window of two hours, half are due, a fifth need a
skill that half of the vans have, some are released during the day. There is a van for each 20
stops; together they hold three quarters of the demand on one trip, may load again once, work nine
hours with a break of half an hour between the second and the seventh, and an hour longer at most.

Prints for each second objective the seconds until the first plan and until ten are found, and the
plans and their hypervolume after ten seconds. Then a stop is added to a plan that is driven: how
much of it the nearest plan keeps that one second of replanning finds, and by how much its lengths
would have to shrink until no plan of ten seconds from nothing dominates it. Every plan is checked.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from math import inf
from typing import Any

import numpy as np
from paretour.choice import knee

from service.errors import Refusal
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.measures.table import Measure
from service.fleet.planner import plan_fleet
from service.fleet.plans import FleetFront, Plan, Route, kept_share
from service.fleet.rules import Over, Rules
from service.fleet.vehicles import ALWAYS, VehicleType, Visit
from service.watch import Progress, Watch
from tests.benchmarks.cells import of
from tests.benchmarks.fleet_fronts import check_plans
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume

SECONDS, BRIEF = 10.0, 1.0
TEN = 10
SECOND_OBJECTIVES: tuple[Over | Measure, ...] = (
    "sum",
    "max",
    "vehicles",
    "unassigned",
    "overtime",
    "lateness",
    "imbalance",
    "load_distance",
)


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks bounds", description=__doc__)
    parser.add_argument("--stops", type=int, default=200)
    parser.add_argument("--count", type=int, default=2, help="instances of each objective")
    options = parser.parse_args(arguments)
    plan_fleet(instance(20, 0, "max"), FleetOptions(time_limit=0.5))  # compiled before it is timed
    for over in SECOND_OBJECTIVES:
        seeds = list(range(options.count))
        key = f"{options.stops} stops, {over}"
        resume("bounds", key, "", seeds, partial(measured, options.stops, over))
    print(table(*rows(options.stops)))


def instance(n: int, seed: int, over: Over | Measure) -> Fleet:
    """The instance of n stops with this number, against a second objective."""
    random = np.random.default_rng([n, seed])
    places = np.concatenate(([[50.0, 50.0]], random.uniform(0, 100, (n, 2))))
    costs = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    visits = [_visit(random, over == "unassigned") for _ in range(n)]
    vans = max(2, n // 20)
    demand = sum(visit.demand[0] for visit in visits)
    van = VehicleType(
        start=0,
        end=0,
        capacity=(int(0.75 * demand / vans) + 9,),
        shift=(0.0, 540.0),
        reload=(0,),
        max_trips=2,
        max_overtime=60.0,
        breaks=((120.0, 420.0, 30.0),),
    )
    able = VehicleType(**{**vars(van), "skills": ("cold",), "count": vans // 2})
    others = VehicleType(**{**vars(van), "count": vans - vans // 2})
    rules = Rules(visits=(Visit(), *visits), vehicles=(able, others), over=("sum", over), clock=1)
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


def _visit(random: np.random.Generator, optional: bool) -> Visit:
    begin = float(random.integers(60, 400))
    demand, prize = int(random.integers(1, 10)), float(random.integers(20, 200))
    windowed, due, cold, released = random.random(4) < (0.5, 0.5, 0.2, 0.1)
    return Visit(
        demand=(demand,),
        service=3.0,
        windows=((begin, begin + 120.0),) if windowed else (ALWAYS,),
        prize=prize if optional else None,
        due=begin + 90.0 if due else inf,
        release=begin - 60.0 if released else 0.0,
        skills=("cold",) if cold else (),
    )


def measured(n: int, over: Over | Measure, seed: int) -> dict[str, Any]:
    """The seconds until plans are found, the front, and what replanning does."""
    fleet = instance(n, seed, over)
    found: list[tuple[float, int]] = []

    def report(progress: Progress, _: Callable[[int], FleetFront]) -> None:
        found.append((time.perf_counter() - began, progress.points))

    began = time.perf_counter()
    front = plan_fleet(fleet, FleetOptions(time_limit=SECONDS), watch=Watch(report=report))
    found.append((time.perf_counter() - began, front.found))
    check_plans(fleet, front.plans)
    return {
        "seconds": round(found[-1][0], 2),
        "first": round(next(at for at, _ in found), 2),
        "ten": next((round(at, 2) for at, points in found if points >= TEN), None),
        "plans": front.found,
        "hypervolume": round(front.hypervolume, 5),
        **replanned(fleet, front),
    }


def replanned(fleet: Fleet, front: FleetFront) -> dict[str, float | None]:
    """What the nearest plan keeps when the last stop is added to the knee, and how good it is.

    None where no plan is found in time.
    """
    added = fleet.rules.n - 1
    routes = [
        Route(route.vehicle, tuple(stop for stop in route.stops if stop != added))
        for route in front.plans[knee(front.points)].routes
    ]
    driven = Plan(tuple(route for route in routes if route.stops))
    began = time.perf_counter()
    try:
        brief = plan_fleet(fleet, FleetOptions(time_limit=BRIEF, driven=driven))
    except Refusal:
        return dict.fromkeys(("replanned in", "kept", "excess"))
    seconds = time.perf_counter() - began
    kept = [kept_share(driven, plan) for plan in brief.plans]
    nearest = brief.points[int(np.argmax(kept))]
    return {
        "replanned in": round(seconds, 2),
        "kept": round(max(kept), 4),
        "excess": round(excess(nearest, front.points), 4),
    }


def excess(point: np.ndarray, front: np.ndarray) -> float:
    """The share of its lengths by which a point must shrink until no point of a front dominates it.

    Lengths of 0 cannot shrink, and need not.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(point > 0, 1 - front / point, np.where(front > 0, -inf, inf))
    return max(0.0, float(shares.min(axis=1).max()))


def rows(n: int) -> tuple[list[str], list[list[str]]]:
    """The table of what is stored."""
    stored = load("bounds")
    head = ["second objective", "first plan", "ten plans", "plans in 10 s", "hypervolume"]
    head += ["replanned in", "kept", "longer by"]
    found = []
    for over in SECOND_OBJECTIVES:
        entries = of(stored.get(f"{n} stops, {over}"))
        if not entries:
            continue
        found.append(
            [
                over,
                _mean(entries, "first", "{:.2f} s"),
                _mean(entries, "ten", "{:.1f} s"),
                _mean(entries, "plans", "{:.0f}"),
                _mean(entries, "hypervolume", "{:.2%}"),
                _mean(entries, "replanned in", "{:.2f} s"),
                _mean(entries, "kept", "{:.1%}"),
                _mean(entries, "excess", "{:.2%}"),
            ]
        )
    return head, found


def _mean(entries: list[dict[str, Any]], name: str, form: str) -> str:
    """The mean over all instances, "-" where one has no such number."""
    numbers = [each[name] for each in entries]
    return "-" if None in numbers else form.format(np.mean(numbers))
