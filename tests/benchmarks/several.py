"""`python -m tests.benchmarks several --data FOLDER`: three and four objectives, beside rivals.

Instances: uniform cities, cities in clusters, and kroA100, kroB100 and kroC100 of TSPLIB together,
whose files are in a folder of the user's. Every method has the same seconds of the clock on one
thread: our search, the whole front at once; a service that is asked over HTTP for 100 and for 1,000
tours, its seconds being those until the answer is read; weighted sums, which share the seconds, by
fast-tsp (105) and by OR-Tools' guided local search (28, as it finds hardly any tour in a tenth of a
second); and NSGA-III and MOEA/D of pymoo. All points that a method finds count, and of the service
those that it returns. The reference point is n times the scale. Of kroABC100 a front of a longer
search is summed up, so that others have one to beat: its least lengths, its number of points, a
digest of them, and the hypervolume between its least and its greatest lengths. What is stored is
not measured again. Prints a table and stores `results/several.json`.
"""

import argparse
import atexit
import time
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import cache, partial
from hashlib import sha256
from pathlib import Path
from typing import Any

import httpx
import moocore
import numpy as np
from numpy.typing import NDArray

from models.data.generators import clustered, uniform
from service.instance import Instance, step_lengths, tour_lengths
from service.preferences import spread
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.kro import rounded_distances
from tests.benchmarks.provenance import load
from tests.benchmarks.rivals import evolutionary, fast_tsp_weights, ortools_routing
from tests.benchmarks.rows import resume
from tests.helpers.processes import serve_process

Array = NDArray[np.float64]
Find = Callable[[Instance, float], Array]

KRO = ("kroA100", "kroB100", "kroC100")
LONG = "a long search"
SIZES = {  # by the name of the instances: kind of plane, cities, objectives, how many, seconds
    "50 uniform, 4 objectives": (uniform, 50, 4, 3, 10.0),
    "100 uniform, 4 objectives": (uniform, 100, 4, 3, 3.0),
    "100 uniform": (uniform, 100, 3, 3, 10.0),
    "100 clustered": (clustered, 100, 3, 3, 10.0),
    "500 uniform": (uniform, 500, 3, 1, 10.0),
    "1000 uniform": (uniform, 1000, 3, 1, 10.0),
    "2000 uniform": (uniform, 2000, 3, 1, 30.0),
    "5000 uniform": (uniform, 5000, 3, 1, 60.0),
}
KRO_SECONDS = 10.0
MOST_IN_ANSWER = 2_000_000  # stops of all tours, each with its return


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks several", description=__doc__)
    parser.add_argument("--data", type=Path, help="holds the .tsp files of kroABC100")
    parser.add_argument("--on", nargs="+", choices=SIZES, default=list(SIZES), metavar="INSTANCES")
    parser.add_argument("--rows", nargs="+", choices=METHODS, default=list(METHODS))
    parser.add_argument("--long", type=float, default=600.0, help="seconds of the long search")
    options = parser.parse_args(arguments)
    warm_up()
    if any(row in SERVED for row in options.rows):
        _client()  # the first call waits until the service has compiled everything
    for row in options.rows:
        for name in options.on:
            kind, n, objectives, count, seconds = SIZES[name]
            seeds = range(count)
            measure = partial(_measured_drawn, METHODS[row], kind, n, objectives, seconds)
            resume("several", f"{name}: {row}", "", list(seeds), measure)
    if options.data is not None:
        planes = [rounded_distances(options.data / f"{name}.tsp") for name in KRO]
        kro = Instance(matrices=np.stack(planes))
        for row in options.rows:
            measure = partial(_measured, METHODS[row], KRO_SECONDS)
            resume("several", f"kroABC100: {row}", "", [kro], measure)
        resume("several", f"kroABC100: {LONG}", "", [kro], partial(_summed_up, options.long))
    print_table()


def _measured_drawn(
    find: Find, kind: Callable[..., Array], n: int, objectives: int, seconds: float, seed: int
) -> dict[str, Any]:
    """The measures of a method on the instance of a seed, each plane drawn on its own."""
    generator = np.random.default_rng([n, objectives, seed])
    planes = [kind(n, generator) for _ in range(objectives)]
    return _measured(find, seconds, Instance(coordinates=np.concatenate(planes, axis=1)))


def _measured(find: Find, seconds: float, instance: Instance) -> dict[str, Any]:
    """Hypervolume in per cent, the number of points, and the seconds that a method took."""
    began = time.monotonic()
    found = find(instance, seconds)
    points = moocore.filter_dominated(found) if len(found) else found
    took = time.monotonic() - began
    corner = instance.reference_point
    share = moocore.hypervolume(points, ref=corner) / corner.prod()
    return {
        "hypervolume": round(float(100 * share), 4),
        "points": len(points),
        "seconds": round(took, 3),
    }


def _summed_up(seconds: float, instance: Instance) -> dict[str, Any]:
    """What others need to compare a front with that of a long search."""
    points = np.unique(moocore.filter_dominated(_search(instance, seconds)), axis=0)
    least, most = points.min(axis=0), points.max(axis=0)
    share = moocore.hypervolume(points - least, ref=most - least) / (most - least).prod()
    rows = "\n".join(" ".join(f"{length:.0f}" for length in point) for point in points)
    return {
        "seconds": seconds,
        "points": len(points),
        "least": least.tolist(),
        "greatest": most.tolist(),
        "hypervolume between them": float(share),
        "sha256 of the points, ascending": sha256(rows.encode()).hexdigest(),
    }


def _search(instance: Instance, seconds: float) -> Array:
    nothing = np.empty((0, instance.n), np.int32)
    return improve(instance, nothing, watch=Watch(seconds)).points


def _served(size: int, instance: Instance, seconds: float) -> Array:
    """The points of the tours that a service returns over HTTP."""
    given = instance.coordinates if instance.matrices is None else instance.matrices
    kind = "coordinates" if instance.matrices is None else "matrices"
    assert given is not None
    size = min(size, MOST_IN_ANSWER // (instance.n + 1))
    body = {kind: given.tolist(), "time_limit": seconds, "size": size}
    answer = _client().post("/front", json=body)
    answer.raise_for_status()
    return np.array([tour["lengths"] for tour in answer.json()["front"]])


@cache
def _client() -> httpx.Client:
    """A client of a service with one worker, which runs until this process ends."""
    running = ExitStack()
    atexit.register(running.close)
    service = running.enter_context(serve_process({"PARETOUR_WORKERS": "1"}, ready=True))
    return running.enter_context(httpx.Client(base_url=service.url, timeout=120))


def _under_weights(
    solve: Callable[[Array, float], NDArray[np.int64]],
    count: int,
    instance: Instance,
    seconds: float,
) -> Array:
    """The points of tours, one under each of some weighted sums, which share the seconds."""
    ends = time.monotonic() + seconds
    steps = step_lengths(instance, *np.indices((instance.n, instance.n)))
    costs = np.moveaxis(steps / instance.scale, 2, 0)
    tours = []
    for turn, weights in enumerate(spread(count, len(instance.scale))):
        left = max(ends - time.monotonic(), 0.0) / (count - turn)
        summed = np.tensordot(weights / weights.sum(), costs, axes=1)
        with suppress(TimeoutError):
            tours.append(solve(summed, max(left, 0.002)))
    return tour_lengths(instance, np.array(tours, np.int64).reshape(-1, instance.n))


SERVED: dict[str, Find] = {
    "the service, 100 tours": partial(_served, 100),
    "the service, 1,000 tours": partial(_served, 1_000),
}
METHODS: dict[str, Find] = {
    "the search": _search,
    **SERVED,
    "105 weighted sums, fast-tsp": partial(_under_weights, fast_tsp_weights.solve, 105),
    "28 weighted sums, OR-Tools": partial(_under_weights, ortools_routing.guided, 28),
    "NSGA-III, pymoo": evolutionary.nsga3,
    "MOEA/D, pymoo": evolutionary.moead_for,
}


def print_table() -> None:
    """Print the means of what is stored."""
    stored = load("several")
    names = [*SIZES, "kroABC100"]
    print("| | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for row in METHODS:
        entries = [stored.get(f"{name}: {row}", {}).get("instances", []) for name in names]
        print(f"| {row} | " + " | ".join(map(_cell, entries)) + " |")
    for summary in stored.get(f"kroABC100: {LONG}", {}).get("instances", []):
        print(f"\nkroABC100, {LONG}: {summary}")


def _cell(entries: list[dict[str, Any]]) -> str:
    if not entries:
        return ""
    share, seconds = (
        np.mean([each[name] for each in entries]) for name in ("hypervolume", "seconds")
    )
    return f"{share:.2f} in {seconds:.1f} s"
