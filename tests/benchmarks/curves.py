"""`python -m tests.benchmarks curves`: hypervolume over time, Paretour beside its rivals.

On the paper's instances: Paretour's search alone, without a network; OR-Tools and fast-tsp under
weighted sums; NSGA-II and MOEA/D. All see the same instances and reference points, on one thread,
and seconds are those of the processor, which another program's load does not stretch.
Stores `results/curves.json`, instance by instance, where what is stored is not measured again, so
that a run may be broken off; and draws `service/guide/pictures/curves.png`.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from tqdm import tqdm

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.search.weights import bisection_order
from service.watch import Watch
from tests.benchmarks import provenance as of_run
from tests.benchmarks.instances import check_tours, paper_instances, reference_points
from tests.benchmarks.provenance import PICTURES, load, picture, provenance, store
from tests.benchmarks.rivals import fast_tsp_weights, ortools_routing
from tests.benchmarks.rivals.construction import distances, spread_weights
from tests.benchmarks.rivals.evolutionary import Snapshots, moead, nsga2

Array = NDArray[np.float64]
Method = Callable[[Instance], Snapshots]

SIZES = (40, 200)
MARKS = np.geomspace(0.005, 5.0, 19)
WEIGHTS = 100
POPULATION = 100
EVALUATIONS = 80_000  # the larger of the paper's two settings
APART = 1.1  # snapshots closer in time than this factor are not stored
LEAST = 0.001  # per cent of the box; the drawing tells nothing closer to the best apart
STYLES = {
    "Paretour, search alone": ("#c1272d", "-"),
    "fast-tsp, 1 ms a weight": ("#0072b2", "-"),
    "fast-tsp, 30 ms a weight": ("#0072b2", "--"),
    "OR-Tools, no limit": ("#e69f00", "-"),
    "OR-Tools, n_l = 10": ("#e69f00", "--"),
    "MOEA/D": ("#009e73", "-"),
    "NSGA-II": ("#8b5fbf", "-"),
}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks curves", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=SIZES, default=SIZES)
    parser.add_argument("--count", type=int, default=5, help="instances of each size")
    parser.add_argument("--methods", nargs="+", choices=STYLES, default=list(STYLES))
    options = parser.parse_args(arguments)
    results = load("curves")
    methods = _methods()
    warm_up()
    for n in options.cities:
        instances = [Instance(coordinates=x) for x in paper_instances(n, options.count)]
        for name in options.methods:
            _resume(results, f"{n} {name}", instances, methods[name])
    _print_table(results)
    draw(results)


def _methods() -> dict[str, Method]:
    def library(solve: Callable[[Array], NDArray[np.int64]]) -> Method:
        return partial(weighted_sums, solve=solve)

    return {
        "Paretour, search alone": paretour,
        "fast-tsp, 1 ms a weight": library(partial(fast_tsp_weights.solve, duration=0.001)),
        "fast-tsp, 30 ms a weight": library(partial(fast_tsp_weights.solve, duration=0.03)),
        "OR-Tools, no limit": library(partial(ortools_routing.solve, solution_limit=None)),
        "OR-Tools, n_l = 10": library(partial(ortools_routing.solve, solution_limit=10)),
        "MOEA/D": partial(moead, population=POPULATION, evaluations=EVALUATIONS),
        "NSGA-II": partial(nsga2, population=POPULATION, evaluations=EVALUATIONS),
    }


def paretour(instance: Instance) -> Snapshots:
    """The front after each mark, each from a search of its own, until one has converged."""
    none = np.empty((0, instance.n), np.int32)
    improve(instance, none, iterations=1)  # fills caches
    snapshots = []
    for mark in MARKS:
        began = time.process_time()
        found = improve(instance, none, watch=Watch(mark))
        snapshots.append((time.process_time() - began, tour_lengths(instance, found.tours)))
        if found.terminated == "converged":
            break
    return sorted(snapshots, key=lambda snapshot: snapshot[0])


def weighted_sums(instance: Instance, solve: Callable[[Array], NDArray[np.int64]]) -> Snapshots:
    """All points so far after each of 100 weights, both ends first and then ever finer between.

    In this order a library that is stopped early has still looked everywhere.
    """
    costs = distances(instance.scaled_coordinates)
    weights = spread_weights(WEIGHTS)
    solve(costs[0])  # fills caches
    tours, seconds = [], []
    began = time.process_time()
    for k in bisection_order(WEIGHTS):
        tours.append(solve(weights[k, 0] * costs[0] + weights[k, 1] * costs[1]))
        seconds.append(time.process_time() - began)
    check_tours(np.array(tours), instance.n)
    points = tour_lengths(instance, np.array(tours))
    return [(seconds[k], points[: k + 1]) for k in range(WEIGHTS)]


def _resume(results: dict[str, Any], key: str, instances: list[Instance], method: Method) -> None:
    """Measures the instances that have no result yet, or all with `--again`, storing after each."""
    if of_run.RUN.again:
        results.pop(key, None)
    entry = results.setdefault(key, {**provenance(1), "instances": []})
    done = len(entry["instances"])
    for instance in tqdm(instances[done:], desc=key, leave=False):
        entry["instances"].append(_curve(instance, _thinned(method(instance))))
        store("curves", results)


def _thinned(snapshots: Snapshots) -> Snapshots:
    """Those well apart in time, the last among them."""
    kept = [snapshots[0]]
    for snapshot in snapshots[1:-1]:
        if snapshot[0] >= APART * kept[-1][0]:
            kept.append(snapshot)
    return kept + snapshots[1:][-1:]


def _curve(instance: Instance, snapshots: Snapshots) -> dict[str, Any]:
    """Seconds and the hypervolume then, in per cent; for each reference point of this size."""
    shares = {
        name: [round(100 * hypervolume(points, corner), 4) for _, points in snapshots]
        for name, corner in reference_points(instance.n).items()
    }
    return {"seconds": [round(seconds, 5) for seconds, _ in snapshots], "hypervolume": shares}


def _of_size(results: dict[str, Any], n: int) -> dict[str, list[dict[str, Any]]]:
    """The stored curves of a size, by method in the order of the legend."""
    names = [name for name in STYLES if f"{n} {name}" in results]
    return {name: results[f"{n} {name}"]["instances"] for name in names}


def _print_table(results: dict[str, Any]) -> None:
    print("| cities, method | instances | seconds | reference: hypervolume at the end, % |")
    print("|---|---|---|---|")
    for n in SIZES:
        for name, curves in _of_size(results, n).items():
            seconds = np.mean([curve["seconds"][-1] for curve in curves])
            ends = "; ".join(
                f"{corner}: {np.mean([curve['hypervolume'][corner][-1] for curve in curves]):.2f}"
                for corner in reference_points(n)
            )
            print(f"| {n} {name} | {len(curves)} | {seconds:.3f} | {ends} |")


def draw(results: dict[str, Any]) -> None:
    """The figure: one panel a size, the mean over the instances that every method has."""
    figure = Figure(figsize=(12, 5.6), layout="constrained")
    panels = figure.subplots(1, len(SIZES))
    for panel, n in zip(panels, SIZES, strict=True):
        _draw_panel(panel, n, _of_size(results, n))
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False)
    figure.savefig(picture(PICTURES / "curves.png"), dpi=130)


def _draw_panel(panel: Axes, n: int, methods: dict[str, list[dict[str, Any]]]) -> None:
    corner = next(iter(reference_points(n)))
    count = min(map(len, methods.values()))
    means = {name: _mean(curves[:count], corner) for name, curves in methods.items()}
    best = max(shares[-1] for _, shares in means.values())
    for name, (seconds, shares) in means.items():
        color, line = STYLES[name]
        gaps = np.maximum(best - shares, LEAST)
        width = 2.6 if name.startswith("Paretour") else 1.7
        panel.plot(seconds, gaps, line, color=color, lw=width, label=name)
        panel.plot(seconds[-1], gaps[-1], "o", color=color, ms=5)
    _dress(panel, best)
    panel.set_title(f"{n} cities, reference point {corner}, mean of {count} instances")


def _mean(curves: list[dict[str, Any]], corner: str) -> tuple[Array, Array]:
    """Times from when all have a front until all have ended; the mean of what is in hand then."""
    first = max(curve["seconds"][0] for curve in curves)
    last = max(curve["seconds"][-1] for curve in curves)
    seconds = np.geomspace(first, last, 600)
    seconds[[0, -1]] = first, last  # geomspace rounds, and would miss what comes at either end
    shares = [
        np.array(curve["hypervolume"][corner])[
            np.searchsorted(curve["seconds"], seconds, side="right") - 1
        ]
        for curve in curves
    ]
    return seconds, np.mean(shares, axis=0)


def _dress(panel: Axes, best: float) -> None:
    """Log time; and hypervolume on a scale that grows finer towards the best found."""
    gaps = [50, 20, 10, 5, 2, 1, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002]
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_ylim(best, LEAST)
    panel.set_yticks(gaps, [f"{best - gap:.3f}" for gap in gaps])
    panel.minorticks_off()
    panel.grid(color="0.9")
    panel.set_xlabel("processor seconds, one thread")
    panel.set_ylabel(f"hypervolume, %, ever finer towards the best found ({best:.3f})")
