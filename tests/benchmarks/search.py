"""`python -m tests.benchmarks search`: hypervolume over time, beside OR-Tools under weighted sums.

Paretour's search alone, without a network, on the paper's instances. OR-Tools gets the same
instances, 100 weights, and either no limit or its tenth solution. Results are stored instance by
instance in `results/search.json`, and what is stored for the same number of cities is not
measured again, so that a run may be broken off. Everything runs on one thread.
"""

import argparse
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks import provenance as of_run
from tests.benchmarks.instances import COUNT, check_tours, paper_instances, reference_points
from tests.benchmarks.provenance import load, provenance, store
from tests.benchmarks.rivals.construction import distances, spread_weights
from tests.benchmarks.rivals.ortools_routing import solve

WEIGHTS = 100
MARKS = {
    40: (0.01, 0.02, 0.05, 0.1, 0.2),
    200: (0.05, 0.1, 0.3, 1.0),
    500: (0.1, 0.3, 1.0, 3.0),
    1000: (0.3, 0.6, 1.0, 3.0),
}
SOLUTION_LIMITS = {"no limit": None, "n_l = 10": 10}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks search", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=MARKS, default=list(MARKS))
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    parser.add_argument("--rivals", type=int, nargs="*", choices=MARKS, default=[40, 200])
    options = parser.parse_args(arguments)
    results = load("search")
    warm_up()
    for n in options.cities:
        instances = paper_instances(n, options.count)
        _resume(results, f"{n} Paretour", instances, paretour)
        if n in options.rivals:
            for name, limit in SOLUTION_LIMITS.items():
                _resume(
                    results,
                    f"{n} OR-Tools, {name}",
                    instances,
                    lambda cities, limit=limit: or_tools(cities, limit),
                )
    _print_table(results)


def paretour(cities: NDArray[np.float64]) -> list[dict[str, Any]]:
    """The front after each mark, each from a search of its own; its seconds are measured."""
    instance = Instance(coordinates=cities)
    n = instance.n
    rows = []
    for mark in MARKS[n]:
        began = time.monotonic()
        found = improve(instance, np.empty((0, n), np.int32), watch=Watch(mark))
        seconds = time.monotonic() - began
        rows.append({"limit": mark, **_row(instance, found.tours, seconds)})
    return rows


def or_tools(cities: NDArray[np.float64], solution_limit: int | None) -> list[dict[str, Any]]:
    """The front of one solution for each of 100 weights."""
    instance = Instance(coordinates=cities)
    costs = distances(instance.scaled_coordinates)
    began = time.monotonic()
    tours = [
        solve(w[0] * costs[0] + w[1] * costs[1], solution_limit) for w in spread_weights(WEIGHTS)
    ]
    seconds = time.monotonic() - began
    return [_row(instance, np.array(tours), seconds)]


def _row(instance: Instance, tours: NDArray[np.integer], seconds: float) -> dict[str, Any]:
    check_tours(tours, instance.n)
    points = tour_lengths(instance, tours)
    shares = {
        name: 100 * hypervolume(points, corner)
        for name, corner in reference_points(instance.n).items()
    }
    return {"seconds": seconds, "points": len(points), "hypervolume": shares}


def _resume(
    results: dict[str, Any], key: str, instances: list[NDArray[np.float64]], measure: Any
) -> None:
    """Measures the instances that have no result yet, or all with `--again`, storing after each."""
    if of_run.RUN.again:
        results.pop(key, None)
    entry = results.setdefault(key, {**provenance(1), "instances": []})
    done = len(entry["instances"])
    for cities in tqdm(instances[done:], desc=key, leave=False):
        entry["instances"].append(measure(cities))
        store("search", results)


def _print_table(results: dict[str, Any]) -> None:
    print("| cities, method | instances | seconds | points | reference: hypervolume, % |")
    print("|---|---|---|---|---|")
    for key, entry in results.items():
        for rows in zip(*entry["instances"], strict=True):
            print(f"| {key} | {len(rows)} | {' | '.join(_means(rows))} |")


def _means(rows: tuple[dict[str, Any], ...]) -> Iterator[str]:
    yield f"{np.mean([row['seconds'] for row in rows]):.3f}"
    yield f"{np.mean([row['points'] for row in rows]):.0f}"
    names = rows[0]["hypervolume"]
    shares = {name: [row["hypervolume"][name] for row in rows] for name in names}
    yield "; ".join(f"{k}: {np.mean(v):.2f} ± {np.std(v):.2f}" for k, v in shares.items())
