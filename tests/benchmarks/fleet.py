"""`python -m tests.benchmarks fleet`: total against longest route, beside a plain sweep of PyVRP.

The frame is Bi-CVRP, as in the literature on neural solvers: depot and customers uniform in the
unit square, demands 1 to 9, capacity 30, 40 and 50 at 20, 50 and 100 customers, vehicles enough.
The plain sweep is PyVRP from scratch under twelve limits on the longest route, in the same time
altogether. Every plan is checked. The hypervolume is that of the literature's box, whose corner is
printed; and that of the box of both fronts together, in which little is saturated. Prints a table,
and stores `results/fleet.json`. What is stored is not measured again.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pyvrp
from pyvrp.stop import MaxRuntime

from service.fleet.evaluation import points_of, violations
from service.fleet.fleet import Fleet, Rules, VehicleType, Visit
from service.fleet.planner import FleetOptions, plan_fleet
from service.fleet.plans import Plan
from service.fleet.translation import UNBOUNDED, Goal, Translation
from service.pareto import hypervolume, nondominated
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import Points, resume

CAPACITIES = {20: 30, 50: 40, 100: 50}
CORNERS = {20: (30.0, 4.0), 50: (45.0, 4.0), 100: (80.0, 4.0)}
SECONDS = {20: 0.7, 50: 1.5, 100: 4.0}
LIMITS = 12  # of the plain sweep
Find = Callable[[Fleet, float], list[Plan]]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks fleet", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=sorted(SECONDS), choices=SECONDS)
    parser.add_argument("--count", type=int, default=200, help="instances of each size")
    options = parser.parse_args(arguments)
    for n in options.sizes:
        fleets = [bi_cvrp(n, seed) for seed in range(options.count)]
        for name, find in METHODS.items():
            resume("fleet", f"{n} customers, {name}", "", fleets, partial(measured, find))
        print(row(n, load("fleet")))


def bi_cvrp(n: int, seed: int) -> Fleet:
    """The instance of n customers with this number."""
    random = np.random.default_rng([n, seed])
    places = random.random((n + 1, 2))
    demands = random.integers(1, 10, n).tolist()
    costs = np.linalg.norm(places[:, np.newaxis] - places, axis=2)
    rules = Rules(
        visits=(Visit(), *(Visit(demand=(demand,)) for demand in demands)),
        vehicles=(VehicleType(start=0, end=0, count=n, capacity=(CAPACITIES[n],)),),
        over=("sum", "max"),
    )
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


def measured(find: Find, fleet: Fleet) -> dict[str, Any]:
    """Seconds, the points of the plans found, and their hypervolume in the literature's box."""
    n = fleet.rules.n - 1
    began = time.perf_counter()
    plans = find(fleet, SECONDS[n])
    seconds = time.perf_counter() - began
    if broken := [each for plan in plans for each in violations(fleet, plan)]:
        raise RuntimeError(f"a plan breaks a rule: {broken[0]}")
    points = points_of(fleet, plans)
    points = points[nondominated(points)]
    return {
        "seconds": round(seconds, 3),
        "hypervolume": round(hypervolume(points, np.array(CORNERS[n])), 6),
        "points": points.round(6).tolist(),
    }


def swept(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of this project's sweep."""
    return list(plan_fleet(fleet, FleetOptions(time_limit=seconds)).plans)


def swept_plainly(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of PyVRP from scratch, under limits evenly spaced down to the least there can be.

    Scaled so that 1 is 10,000, which its penalties are made for.
    """
    translation = Translation(fleet)
    translation.distance_scale = 1e4
    least = 2 * fleet.costs[0, 0].max()
    plans = [_solved(translation, UNBOUNDED, seconds / LIMITS)]
    longest = points_of(fleet, plans)[0, 1]
    for limit in np.linspace(longest, least, LIMITS)[1:]:
        ceiling = int(np.ceil(1e4 * limit)) + fleet.rules.n
        plans.append(_solved(translation, ceiling, seconds / LIMITS))
    return [plan for plan in plans if not violations(fleet, plan)]


def _solved(translation: Translation, limit: int, seconds: float) -> Plan:
    data = translation.data(Goal(weights=(1, 0), limit=limit))
    result = pyvrp.solve(data, MaxRuntime(seconds), collect_stats=False, display=False)
    return translation.plan(result.best)


METHODS: dict[str, Find] = {"paretour": swept, "plain PyVRP sweep": swept_plainly}


def row(n: int, stored: dict[str, Any]) -> str:
    """A line with the means of both methods, and the share of instances that ours is ahead on."""
    ours, plain = (stored[f"{n} customers, {name}"]["instances"] for name in METHODS)
    boxes = [in_their_box(a["points"], b["points"]) for a, b in zip(ours, plain, strict=False)]
    means = [np.mean([each["hypervolume"] for each in entries]) for entries in (ours, plain)]
    own = np.mean(boxes, axis=0)
    ahead = np.mean([a >= b for a, b in boxes])
    return (
        f"{n} customers, corner {CORNERS[n]}, {len(boxes)} instances: {means[0]:.4f} and plainly"
        f" {means[1]:.4f}; in their own box {own[0]:.4f} and {own[1]:.4f}, ahead on {ahead:.0%}"
    )


def in_their_box(ours: list[list[float]], plain: list[list[float]]) -> tuple[float, float]:
    """The hypervolumes of two fronts in the box of both together."""
    together = np.array([*ours, *plain])
    least, most = together.min(axis=0), together.max(axis=0)
    extent = np.where(most > least, most - least, 1.0)

    def share(points: list[list[float]]) -> float:
        scaled: Points = (np.array(points) - least) / extent
        return hypervolume(scaled, np.array([1.0 + 1e-9, 1.0 + 1e-9]))

    return share(ours), share(plain)
