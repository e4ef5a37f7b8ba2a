"""`python -m tests.benchmarks weights`: Paretour beside a few weights in OR-Tools.

One instance: `service/examples/helsinki-deliveries.json`, 60 stops by road, seconds of driving
against people passed. Paretour plans it once, as the service does, on one thread. OR-Tools solves a
weighted sum for each of 3, 10 or 30 weights by guided local search, and these share the same limit
on the clock. The methods take turns, round by round. Compiling the search is not counted.

Stores the points of every front in `results/weights.json`, prints `weights_table`, and
`python -m tests.guide` writes that table into the guide. What is stored is not measured again: a
later run with greater `--rounds` adds rounds. Three rounds take two minutes.
"""

import argparse
import json
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.actor import OnnxActor
from service.front import PlanOptions
from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.planner import plan
from service.preferences import spread
from service.search.warm_up import warm_up
from tests.benchmarks.instances import check_tours
from tests.benchmarks.rivals import ortools_routing
from tests.benchmarks.rows import resume
from tests.benchmarks.weights_table import weights_table

Array = NDArray[np.float64]
Find = Callable[[Instance, int], NDArray[np.integer]]

EXAMPLE = Path("service/examples/helsinki-deliveries.json")
ACTOR = Path("service/actors/pa-one-matrix.onnx")
LIMITS = (1.0, 10.0)  # seconds
WEIGHTS = (3, 10, 30)
OURS = "Paretour, one request"
# At a weight of 0 OR-Tools would take any of the tours that are equal in the other objective.
EDGE = 0.001


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks weights", description=__doc__)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args(arguments)
    actor = OnnxActor(ACTOR, threads=1)
    instance = example()
    warm_up()
    for rounds in range(1, options.rounds + 1):
        for limit in LIMITS:
            for name, find in methods(actor, limit).items():
                digest = actor.info.digest if name == OURS else ""
                measure = partial(measured, find, instance)
                resume("weights", f"{limit:g} s: {name}", digest, range(rounds), measure)
    print(weights_table())


def example() -> Instance:
    """The instance: matrices of seconds and of people passed."""
    request = json.loads(EXAMPLE.read_text(encoding="utf-8"))
    return Instance(matrices=np.array([each["matrix"] for each in request["objectives"]], float))


def methods(actor: OnnxActor, limit: float) -> dict[str, Find]:
    """How tours are found within a limit, by the name of the method."""
    rivals: dict[str, Find] = {
        f"OR-Tools, {count} weights": partial(_by_weights, count, limit) for count in WEIGHTS
    }
    return {OURS: partial(_planned, actor, limit), **rivals}


def measured(find: Find, instance: Instance, seed: int) -> dict[str, Any]:
    """Seconds on the clock and of the processor, and the points of the front, in their units."""
    clock, processor = time.perf_counter(), time.process_time()
    tours = find(instance, seed)
    taken = time.perf_counter() - clock, time.process_time() - processor
    check_tours(tours, instance.n)
    points = tour_lengths(instance, tours)
    return {
        "seconds": round(taken[0], 3),
        "processor": round(taken[1], 3),
        "points": points[nondominated(points)].tolist(),
    }


def _planned(actor: OnnxActor, limit: float, instance: Instance, seed: int) -> NDArray[np.integer]:
    options = PlanOptions(directions=spread(100), fewer=True, size=100, time_limit=limit, seed=seed)
    return plan(actor, instance, options).tours


def _by_weights(count: int, limit: float, instance: Instance, _: int) -> NDArray[np.integer]:
    first, second = instance.scaled_matrices
    shares = np.linspace(EDGE, 1 - EDGE, count)
    costs = [(1 - share) * first + share * second for share in shares]
    return np.array([ortools_routing.guided(cost, limit / count) for cost in costs])
