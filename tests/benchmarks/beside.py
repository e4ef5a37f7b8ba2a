"""Paretour beside OR-Tools on instances of two matrices.

The rows: each actor of a directory that reads matrices, by default the released ones, alone, with
as many repairs as the service makes by default, and with half a second of search after it; the
search alone; OR-Tools' routing solver under 100
weights, with the paper's two limits on its solutions. Every row gives at most 100 tours an
instance, on one thread. Seconds are those of the processor, which another program's load does not
stretch. The reference point is n times the scale, the largest entry of each matrix. What is stored
is not measured again, so that a run may be broken off.
"""

import argparse
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.actor import OnnxActor, load_actors
from service.construction.call_estimate import CallEstimate
from service.construction.repairs import repairs_worth
from service.front import PlanOptions
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.planner import plan
from service.preferences import fan, from_angles, spread
from service.search.warm_up import warm_up
from tests.benchmarks.instances import check_tours
from tests.benchmarks.provenance import load
from tests.benchmarks.rivals import ortools_routing
from tests.benchmarks.rivals.construction import spread_weights
from tests.benchmarks.rows import resume

Tours = NDArray[np.integer]
Method = Callable[[Instance], Tours]

ACTORS = Path("service/actors")
COUNT = 10
TOURS = 100
SECONDS = 0.5


class Nothing:
    """A constructor that leaves everything to the search."""

    estimate = CallEstimate("coordinates")

    def tours(self, instance: Instance, *_: object) -> NDArray[np.int64]:
        """Return no tour."""
        return np.empty((0, instance.n), np.int64)

    def terminate(self) -> None:
        """Do nothing: there is nothing to end."""


def parser(
    name: str, about: str | None, sizes: Sequence[int], unit: str
) -> argparse.ArgumentParser:
    """The command line that such a benchmark has, for sizes counted in a unit."""
    made = argparse.ArgumentParser(f"python -m tests.benchmarks {name}", description=about)
    made.add_argument(f"--{unit}", dest="sizes", type=int, nargs="+", choices=sizes, default=sizes)
    made.add_argument("--count", type=int, default=COUNT, help="instances of each size and kind")
    made.add_argument("--methods", nargs="+", default=[], help="names of rows; default: all")
    made.add_argument("--actors", type=Path, default=ACTORS, help="directory of ONNX files")
    return made


def methods(actors: Path) -> dict[str, tuple[str, Method]]:
    """By the name of its row, the digest of its network (or nothing) and how tours are built."""
    rows: dict[str, tuple[str, Method]] = {}
    for name, actor in load_actors(actors, threads=1).items():
        if actor.info.inputs == "matrices":
            digest = actor.info.digest
            rows[f"{name}, network alone"] = digest, partial(planned, actor, 0.0)
            if actor.info.repairs:
                rows[f"{name}, repaired"] = digest, partial(planned, actor, 0.0, repaired=True)
            rows[f"{name}, {SECONDS} s of search"] = digest, partial(planned, actor, SECONDS)
    rows[f"search alone, {SECONDS} s"] = "", partial(planned, Nothing(), SECONDS)
    rows["OR-Tools, n_l = 10"] = "", partial(_ortools, 10)
    rows["OR-Tools, n_l = 100"] = "", partial(_ortools, 100)
    return rows


def measure(
    benchmark: str, groups: Mapping[str, Sequence[Instance]], options: argparse.Namespace
) -> None:
    """Measures methods on groups of instances, stores after each, prints the table."""
    warm_up()
    for row, (digest, method) in methods(options.actors).items():
        if row in options.methods or not options.methods:
            for group, instances in groups.items():
                resume(benchmark, f"{group}: {row}", digest, instances, partial(measured, method))
    _print_table(load(benchmark), list(groups))


def planned(
    constructor: OnnxActor | Nothing, seconds: float, instance: Instance, *, repaired: bool = False
) -> Tours:
    """The front of a constructor's tours, as they are or repaired, after so much search."""
    # The time of the network comes on top of the seconds of search.
    repairs = repairs_worth("matrices", instance.n, instance.objectives) if repaired else 0
    tours = constructor.tours(instance, from_angles(fan(TOURS)), repairs)
    demand = PlanOptions(
        directions=spread(TOURS), size=TOURS, time_limit=seconds, initial_tours=tours
    )
    return plan(Nothing(), instance, demand).tours


def _ortools(limit: int, instance: Instance) -> Tours:
    first, second = instance.scaled_matrices
    weights = spread_weights(TOURS)
    return np.array([ortools_routing.solve(w * first + v * second, limit) for w, v in weights])


def measured(method: Method, instance: Instance) -> dict[str, float]:
    """Hypervolume, in per cent of the box to n times the scale, and seconds of the processor."""
    began = time.process_time()
    tours = method(instance)
    seconds = time.process_time() - began
    check_tours(tours, instance.n)
    share = hypervolume(tour_lengths(instance, tours), instance.n * instance.scale)
    return {"hypervolume": round(100 * share, 4), "seconds": round(seconds, 4)}


def _print_table(results: dict[str, Any], groups: list[str]) -> None:
    stored = (key for group in groups for key in results if key.startswith(group))
    rows = dict.fromkeys(key.partition(": ")[2] for key in stored)
    print("| hypervolume, %, at n times the scale | " + " | ".join(groups) + " |")
    print("|---" * (len(groups) + 1) + "|")
    for row in rows:
        cells = [_cell(results.get(f"{group}: {row}")) for group in groups]
        print(f"| {row} | " + " | ".join(cells) + " |")


def _cell(entry: dict[str, Any] | None) -> str:
    if entry is None:
        return ""
    shares = [each["hypervolume"] for each in entry["instances"]]
    seconds = [each["seconds"] for each in entry["instances"]]
    return f"{np.mean(shares):.2f} ± {np.std(shares):.2f} in {np.mean(seconds):.3f} s"
