"""`python -m tests.benchmarks fleets`: fronts of 100 to 2,000 stops, beside searches by PyVRP.

Uniform fleets of one type: places uniform in a square, demands 1 to 29, capacity 200, vehicles
enough; total against longest route, in eight seconds each on one thread. The rivals have the same
time: the sweep of searches by PyVRP that finds fronts of the fleets that the search by ruin and
recreate does not know, and PyVRP alone for the least total. Every plan is checked. Hypervolumes are
in the box of the fronts that are compared.

With `--data FOLDER`, which holds .vrp files of CVRPLIB with their .sol files, the gap of the least
total to the best known one is measured instead, in `--seconds` each, of the whole front and of
PyVRP alone.

Prints a table, and stores `results/fleets.json`; what is stored is not measured again.
"""

import argparse
import warnings
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pyvrp
import vrplib
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.stop import MaxRuntime

from service.fleet.fleet import Fleet
from service.fleet.fronts import FleetOptions
from service.fleet.goal import Goal
from service.fleet.planner import plan_fleet
from service.fleet.plans import Plan
from service.fleet.pyvrp_search import PyvrpSearch
from service.fleet.rules import Rules
from service.fleet.search.search import warm_up
from service.fleet.translation import Translation
from service.fleet.vehicles import VehicleType, Visit
from service.pareto import nondominated
from service.watch import Watch
from tests.benchmarks.cells import of
from tests.benchmarks.fleet_fronts import Find, share_of_box, timed_front
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume

SIZES = (100, 250, 480, 1000, 2000)
SECONDS = 8.0
OURS, SWEEP, ALONE = "paretour", "sweep of searches by PyVRP", "PyVRP alone"


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks fleets", description=__doc__)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument("--count", type=int, default=3, help="instances of each size")
    parser.add_argument("--seconds", type=float, default=SECONDS)
    parser.add_argument("--data", type=Path, help="a folder of .vrp files of CVRPLIB")
    parser.add_argument("--names", nargs="+", default=[], help="of files, without .vrp")
    options = parser.parse_args(arguments)
    warm_up()
    if options.data is not None:
        for name in options.names:
            for method in (OURS, ALONE):
                find = partial(gap, method, options.data, options.seconds)
                resume("fleets", f"{name}, {method}, {options.seconds:g} s", "", [name], find)
        return
    for n in options.sizes:
        fleets = [uniform(n, seed) for seed in range(options.count)]
        for name, method in METHODS.items():
            key = f"{n} stops, {name}, {options.seconds:g} s"
            resume("fleets", key, "", fleets, partial(measured, method, options.seconds))
        print("\n".join(lines(n, options.seconds)))


def uniform(n: int, seed: int) -> Fleet:
    """The uniform fleet of n stops with this number."""
    random = np.random.default_rng([n, seed])
    places = 1000 * random.random((n + 1, 2))
    demands = random.integers(1, 30, n).tolist()
    return _fleet(np.linalg.norm(places[:, np.newaxis] - places, axis=2), demands, 200)


def _fleet(costs: np.ndarray[Any, Any], demands: Sequence[int], capacity: int) -> Fleet:
    rules = Rules(
        visits=(Visit(), *(Visit(demand=(demand,)) for demand in demands)),
        vehicles=(VehicleType(start=0, end=0, count=len(demands), capacity=(capacity,)),),
        over=("sum", "max"),
    )
    return Fleet(rules=rules, costs=np.stack([costs, costs]))


def measured(find: Find, seconds: float, fleet: Fleet) -> dict[str, Any]:
    """Seconds, and the points of the plans found."""
    spent, points = timed_front(find, fleet, seconds)
    return {"seconds": spent, "points": points.round(6).tolist()}


def ours(fleet: Fleet, seconds: float) -> Sequence[Plan]:
    """The plans of plan_fleet(...)."""
    return plan_fleet(fleet, FleetOptions(time_limit=seconds)).plans


def swept(fleet: Fleet, seconds: float) -> Sequence[Plan]:
    """The plans of a sweep of searches by PyVRP."""
    options = FleetOptions(time_limit=seconds)
    search = PyvrpSearch(fleet, options, Watch(seconds))
    return search.front(options.size, search.run()).plans


def alone(fleet: Fleet, seconds: float) -> Sequence[Plan]:
    """The plan of the least total that PyVRP finds."""
    translation = Translation(fleet)
    translation.scales = [1e4 / fleet.costs.max()] * 2  # its penalties are made for this
    data = translation.data(Goal(weights=translation.sum_weights))
    with warnings.catch_warnings(action="ignore", category=PenaltyBoundWarning):
        result = pyvrp.solve(data, MaxRuntime(seconds), collect_stats=False, display=False)
    return [translation.plan(result.best)]


METHODS: dict[str, Find] = {OURS: ours, SWEEP: swept, ALONE: alone}


def gap(method: str, folder: Path, seconds: float, name: str) -> dict[str, Any]:
    """The gap of the least total to the best known one, and the number of plans."""
    read = vrplib.read_instance(folder / f"{name}.vrp")
    known = float(vrplib.read_solution(folder / f"{name}.sol")["cost"])
    costs = np.round(read["edge_weight"]).astype(float)
    fleet = _fleet(costs, [int(each) for each in read["demand"][1:]], int(read["capacity"]))
    found = measured(METHODS[method], seconds, fleet)
    least = min(point[0] for point in found["points"])
    return {
        "seconds": found["seconds"],
        "gap": round(least / known - 1, 5),
        "plans": len(found["points"]),
    }


def lines(n: int, seconds: float) -> list[str]:
    """A line for each method: hypervolume in the box of all fronts, least total, plans."""
    stored = load("fleets")
    fronts = {name: of(stored.get(f"{n} stops, {name}, {seconds:g} s")) for name in METHODS}
    count = min(map(len, fronts.values()))
    text = [f"{n} stops, {count} instances, {seconds:g} s"]
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in METHODS}
    for instance in range(count):
        found = {name: np.array(each[instance]["points"]) for name, each in fronts.items()}
        both = np.vstack([found[OURS], found[SWEEP]])
        both = both[nondominated(both)]
        least = min(points[:, 0].min() for points in found.values())
        for name, points in found.items():
            volume = share_of_box(points, both)
            rows[name].append((volume, points[:, 0].min() / least - 1, len(points)))
    for name, values in rows.items():
        volume, above, plans = np.mean(values, axis=0)
        of_front = f"hypervolume {volume:.3f}, {plans:.0f} plans, " if name != ALONE else ""
        text.append(f"  {name}: {of_front}least total {100 * above:.2f} % above the least found")
    return text
