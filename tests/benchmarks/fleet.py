"""`python -m tests.benchmarks fleet`: total against longest route, beside PyVRP and OR-Tools.

The frame is Bi-CVRP, as in the literature on neural solvers: depot and customers uniform in the
unit square, demands 1 to 9, capacity 30, 40 and 50 at 20, 50 and 100 customers, vehicles enough.
The plain sweeps are PyVRP and OR-Tools from scratch under twelve limits on the longest route, in
the same time altogether. The network alone has no time limit. Every plan is checked. The
hypervolume is that of the literature's box, whose corner is printed; and that of the box of our
front and the plain one of PyVRP together, in which little is saturated.

Prints a table, and stores `results/fleet.json`. What is stored is not measured again: a later run
with a greater `--count` adds instances. Of 30 it takes eleven minutes on one quiet core, of 200
seventy.
"""

import argparse
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyvrp
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.stop import MaxRuntime

import service
from service.actor import OnnxActor, load_actors
from service.fleet.evaluation import points_of, violations
from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.goal import Goal
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan
from service.fleet.rules import Rules
from service.fleet.scales import UNBOUNDED
from service.fleet.translation import Translation
from service.fleet.vehicles import VehicleType, Visit
from service.pareto import hypervolume
from tests.benchmarks import printed
from tests.benchmarks.fleet_fronts import Find, timed_front
from tests.benchmarks.fleet_table import OURS, PLAIN, compared
from tests.benchmarks.provenance import load
from tests.benchmarks.rivals.ortools_fleets import route_fleet
from tests.benchmarks.rows import resume

CAPACITIES = {10: 30, 20: 30, 50: 40, 100: 50}
CORNERS = {20: (30.0, 4.0), 50: (45.0, 4.0), 100: (80.0, 4.0)}
SECONDS = {20: 0.7, 50: 1.5, 100: 4.0}
LIMITS = 12  # of the plain sweeps
ACTORS = Path(service.__file__).parent / "actors"
NETWORK = "network alone"
WITH_NETWORK = (NETWORK, OURS)


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks fleet", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=sorted(SECONDS), choices=SECONDS)
    parser.add_argument("--count", type=int, default=30, help="instances of each size")
    options = parser.parse_args(arguments)
    actor = load_actors(ACTORS, 1)["pa-one-matrix"]
    methods = methods_with(actor)
    methods[NETWORK](bi_cvrp(10, 0), 0.0)  # compiled before it is timed
    for n in options.sizes:
        fleets = [bi_cvrp(n, seed) for seed in range(options.count)]
        for name, find in methods.items():
            digest = actor.info.digest if name in WITH_NETWORK else ""
            resume("fleet", f"{n} customers, {name}", digest, fleets, partial(measured, find))
        print("\n".join(rows(n, load("fleet"), list(methods))))


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
    seconds, points = timed_front(find, fleet, SECONDS[n])
    return {
        "seconds": seconds,
        "hypervolume": round(hypervolume(points, np.array(CORNERS[n])), 6),
        "points": points.round(6).tolist(),
    }


def methods_with(actor: OnnxActor) -> dict[str, Find]:
    """All methods, by name; ours with this network."""

    def ours(fleet: Fleet, seconds: float) -> list[Plan]:
        return list(plan_fleet(fleet, FleetOptions(time_limit=seconds), actor).plans)

    return {
        NETWORK: lambda fleet, _: ours(fleet, 0.0),
        OURS: ours,
        PLAIN: swept_plainly,
        "plain OR-Tools sweep": swept_by_or_tools,
    }


def swept_plainly(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of PyVRP from scratch, under limits evenly spaced down to the least there can be.

    Scaled so that 1 is 10,000, which its penalties are made for.
    """
    translation = Translation(fleet)
    translation.scales = [1e4, 1e4]
    return swept(translation, 2 * fleet.costs[0, 0].max(), seconds)


def swept(translation: Translation, least: float, seconds: float) -> list[Plan]:
    """The plans of PyVRP from scratch, without a limit and then under limits down to the least."""
    fleet = translation.fleet
    plans = [_solved(translation, UNBOUNDED, seconds / LIMITS)]
    longest = points_of(fleet, plans)[0, 1]
    for limit in np.linspace(longest, least, LIMITS)[1:]:
        ceiling = int(np.ceil(translation.scales[1] * limit)) + fleet.rules.n
        plans.append(_solved(translation, ceiling, seconds / LIMITS))
    return [plan for plan in plans if not violations(fleet, plan)]


def _solved(translation: Translation, limit: int, seconds: float) -> Plan:
    data = translation.data(Goal(weights=translation.sum_weights, limit=limit))
    with warnings.catch_warnings(action="ignore", category=PenaltyBoundWarning):
        # That it finds few plans under a tight limit.
        result = pyvrp.solve(data, MaxRuntime(seconds), collect_stats=False, display=False)
    return translation.plan(result.best)


def swept_by_or_tools(fleet: Fleet, seconds: float) -> list[Plan]:
    """The plans of OR-Tools under the same limits, by guided local search from its savings."""
    least = 2 * fleet.costs[0, 0].max()
    free = route_fleet(fleet, np.inf, seconds / LIMITS)
    if free is None:
        return []
    limits = np.linspace(points_of(fleet, [free])[0, 1], least, LIMITS)[1:]
    limited = (route_fleet(fleet, limit, seconds / LIMITS) for limit in limits)
    return [free, *(plan for plan in limited if plan is not None)]


def rows(n: int, stored: dict[str, Any], names: list[str]) -> list[str]:
    """A line for each method with its means, and one that compares ours with the plain sweep."""
    entries = {name: stored[f"{n} customers, {name}"]["instances"] for name in names}
    counted = min(map(len, entries.values()))
    lines = [
        f"{n} customers, corner {CORNERS[n]}, {counted} instances; printed {printed.FLEETS[n]}"
    ]
    for name, each in entries.items():
        volume, seconds = (
            np.mean([entry[key] for entry in each[:counted]]) for key in ("hypervolume", "seconds")
        )
        lines.append(f"  {name}: {volume:.4f} in {seconds:.3f} s")
    ours, plain, ahead = compared(stored, n)
    lines.append(f"  in their own box {ours:.4f} and plainly {plain:.4f}, ahead on {ahead:.0%}")
    return lines
