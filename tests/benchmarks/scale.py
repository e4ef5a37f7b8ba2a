"""`python -m tests.benchmarks scale`: the search over time, from a thousand to 100,000 cities.

Paretour's search alone, on one thread, for cities that are uniform or clustered in both planes;
each limit in a process of its own, whose memory at its highest is told. Greedy edge and fast-tsp,
under weights evenly spaced, stop at 5,000 cities, since they take all pairs. OR-Tools has no tour
yet when that limit ends; it gets a minute, and stops where its first tours take longer. PA-One has
101 preferences, alone and with its default repairs, up to 10,000 cities. Beside it stand 101 tours
of the search's last limit, the best under as many weights.

The hypervolume is that of the box to (n, n), in per cent. `ends` is the mean of
the least lengths over sqrt(n): of uniform cities an optimal tour takes 0.7313 at 1,000, 0.7168 at
10,000 and 0.7124 at 100,000 (Johnson and McGeoch, 1996). `late` is by how many seconds the
limit was overrun. All takes a quarter of an hour. What is stored is not measured again. Stores
`results/scale.json`.
"""

import argparse
import resource
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from models.data.generators import clustered, uniform
from service.actor import OnnxActor
from service.construction.repairs import repairs_worth
from service.front import PlanOptions
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.planner import plan
from service.preferences import fan, from_angles
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.instances import check_tours
from tests.benchmarks.rivals.construction import Construct, greedy_edge, spread_weights, under_each
from tests.benchmarks.rows import Points, resume

Way = Callable[[str, float, int], dict[str, Any]]

SHAPES = {"uniform": uniform, "clustered": clustered}
LIMITS = {
    1_000: (0.3, 1.0, 3.0),
    2_000: (1.0, 2.0, 5.0),
    5_000: (1.0, 3.0, 10.0),
    10_000: (1.0, 3.0, 10.0, 30.0),
    100_000: (60.0, 120.0),
}
MOST_OF_ALL_PAIRS = 5_000  # cities
MOST_OF_OR_TOOLS = 1_000  # cities
MOST_OF_NETWORK = 10_000  # cities
MINUTE = 60.0  # seconds
WEIGHTS = 17  # of rivals
ACTOR = Path("service/actors/pa-one.onnx")
PREFERENCES = 101  # of the network, as in the literature


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks scale", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=LIMITS, default=list(LIMITS))
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    options = parser.parse_args(arguments)
    digest = OnnxActor(ACTOR, threads=1).info.digest
    for n in options.cities:
        for shape in options.shapes:
            if n <= MOST_OF_NETWORK:
                _of_preferences(shape, n, digest)
            for limit in LIMITS[n]:
                measure = partial(_alone, searched, shape, limit)
                resume("scale", f"{n} cities, {shape}, search, {limit:g} s", "", [n], measure)
            if n <= MOST_OF_ALL_PAIRS:
                for name, rival in RIVALS.items():
                    measure = partial(_alone, rival, shape, LIMITS[n][-1])
                    resume("scale", f"{n} cities, {shape}, {name}", "", [n], measure)
            if n <= MOST_OF_OR_TOOLS:
                measure = partial(_alone, by_or_tools, shape, MINUTE)
                resume("scale", f"{n} cities, {shape}, OR-Tools", "", [n], measure)


def _of_preferences(shape: str, n: int, digest: str) -> None:
    for name, way in OF_PREFERENCES.items():
        of_row = "" if way is least_sums else digest
        measure = partial(_alone, way, shape, LIMITS[n][-1])
        resume("scale", f"{n} cities, {shape}, {name}", of_row, [n], measure)


def drawn(shape: str, n: int) -> Instance:
    """Return the instance of n cities of a shape, the same in each process."""
    draw, random = SHAPES[shape], np.random.default_rng(0)
    return Instance(coordinates=np.concatenate((draw(n, random), draw(n, random)), axis=1))


def searched(shape: str, limit: float, n: int) -> dict[str, Any]:
    """The search's front after a limit."""
    warm_up()
    instance = drawn(shape, n)
    began = time.monotonic()
    found = improve(instance, np.empty((0, n), np.int32), watch=Watch(limit))
    seconds = time.monotonic() - began
    check_tours(found.tours_at(np.array([0, len(found.points) - 1])), n)
    return {**_row(found.points, n, seconds), "late": round(max(0.0, seconds - limit), 3)}


def by_the_network(repairs: bool, shape: str, _limit: float, n: int) -> dict[str, Any]:
    """The best tours of one call of PA-One, as many as preferences."""
    warm_up()
    actor, instance = OnnxActor(ACTOR, threads=1), drawn(shape, n)
    actor.load()
    directions = from_angles(fan(PREFERENCES))
    count = repairs_worth(actor.info.inputs, n, instance.objectives) if repairs else 0
    options = PlanOptions(directions=directions, size=PREFERENCES, repairs=count)
    began = time.monotonic()
    tours = plan(actor, instance, options).tours
    seconds = time.monotonic() - began
    check_tours(tours, n)
    return _row(tour_lengths(instance, tours), n, seconds)


def least_sums(shape: str, limit: float, n: int) -> dict[str, Any]:
    """Of the search's front after a limit, the tour with the least sum under each weight."""
    warm_up()
    instance = drawn(shape, n)
    began = time.monotonic()
    found = improve(instance, np.empty((0, n), np.int32), watch=Watch(limit))
    best = (found.points @ spread_weights(PREFERENCES).T).argmin(axis=0)
    return _row(found.points[np.unique(best)], n, time.monotonic() - began)


def by_greedy_edge(shape: str, _limit: float, n: int) -> dict[str, Any]:
    """Greedy edge under each weight."""
    instance = drawn(shape, n)
    began = time.monotonic()
    tours = greedy_edge(instance, spread_weights(WEIGHTS))
    return _row(tour_lengths(instance, tours), n, time.monotonic() - began)


def by_fast_tsp(shape: str, limit: float, n: int) -> dict[str, Any]:
    """fast-tsp under each weight, all of them in the limit."""
    from tests.benchmarks.rivals.fast_tsp_weights import solve

    return _under_weights(lambda cost: solve(cost, limit / WEIGHTS), shape, n)


def by_or_tools(shape: str, limit: float, n: int) -> dict[str, Any]:
    """OR-Tools' guided local search under each weight, all of them in the limit."""
    from tests.benchmarks.rivals.ortools_routing import guided

    return _under_weights(lambda cost: guided(cost, limit / WEIGHTS), shape, n)


def _under_weights(solve: Construct, shape: str, n: int) -> dict[str, Any]:
    instance = drawn(shape, n)
    began = time.monotonic()
    tours = under_each(spread_weights(WEIGHTS), solve, instance)
    return _row(tour_lengths(instance, tours), n, time.monotonic() - began)


RIVALS = {"greedy edge": by_greedy_edge, "fast-tsp": by_fast_tsp}
OF_PREFERENCES: dict[str, Way] = {
    "PA-One": partial(by_the_network, False),
    "PA-One, repaired": partial(by_the_network, True),
    f"search, {PREFERENCES} weights": least_sums,
}


def _row(points: Points, n: int, seconds: float) -> dict[str, Any]:
    ends = float(points.min(axis=0).mean()) / n**0.5
    return {
        "hypervolume": round(100 * hypervolume(points, np.full(2, float(n))), 4),
        "seconds": round(seconds, 3),
        "points": len(points),
        "ends": round(ends, 4),
        "peak_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
    }


def _alone(
    way: Callable[[str, float, int], dict[str, Any]], shape: str, limit: float, n: int
) -> Any:
    """Measure in a process of its own, which the memory of no other counts for."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(way, shape, limit, n).result()
