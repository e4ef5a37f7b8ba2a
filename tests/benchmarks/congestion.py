"""`python -m tests.benchmarks congestion --data FOLDERS`: sums of durations beside the best known.

Each folder is a checkout of a set of ANR-MAMUT (GitHub, MIT) whose arrival times are given for each
pair of stops, with the best known sums of the durations of all routes, many of them proven:
`git clone https://github.com/ANR-MAMUT/MAMUT-routing-TDVRPTW-Rifki2020`, on the streets of Lyon,
`MAMUT-routing-TDVRPTW-Vu2020` beside it, and the folder `S1` of `MAMUT-routing-TDVRPTW-Lera2026`.

`paretour.plan_fleet` is asked for durations against vehicles, from the request to the answer, on
one thread; times are `breakpoints`, or of Lera2026, which says at which speed each pair is driven
at which hours, `slices`. The package kayros (PyPI, MIT) plans for the same seconds, with
its own settings; its seconds are without reading the file. The checker of the sets
(mamut-routing-lib) prices the plans of both. Stores `results/congestion.json`.
"""

import argparse
import json
import time
from functools import cache, lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import kayros
import numpy as np
from mamut_routing_lib.models import BenchmarkSolution
from mamut_routing_lib.td import (
    LoadedTDInstance,
    check_td_solution,
    load_instance_categories,
    load_td_instance,
)
from mamut_routing_lib.td.models import TD_IGP_MODEL
from numpy.typing import NDArray
from paretour.bars import Silent
from paretour.plans import FleetFront
from paretour.requests import fleet_plan

from service.library.local_planner import LocalPlanner, load_planner
from tests.benchmarks.congestion_table import congestion_table
from tests.benchmarks.fleet_instances import settings
from tests.benchmarks.rows import resume_beside

Array = NDArray[np.float64]

SECONDS = 10.0
_JUMP = 1e-3  # seconds in which times rise where they jump up in the file


class Known(NamedTuple):
    """An instance of a set, the best known sum of durations, and the slices of its day if it has.

    Without these each pair of stops has arrival times of its own.
    """

    name: str
    given: LoadedTDInstance
    least: float
    slices: list[dict[str, Any]] | None


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks congestion", description=__doc__)
    parser.add_argument("--data", type=Path, nargs="+", required=True, help="checkouts of sets")
    parser.add_argument("--stops", type=int, nargs="+", default=[30, 59, 60, 200])
    parser.add_argument("--count", type=int, default=6, help="instances of each size")
    options = parser.parse_args(arguments)
    for folder in options.data:
        for n in options.stops:
            paths = sorted((folder / f"n={n}").glob("*.vrp.json"))
            spread = np.linspace(0, len(paths) - 1, min(len(paths), options.count)).astype(int)
            if not paths:
                continue
            by_paretour(paths[0], 0.1)  # compiled before it is timed
            key = f"{read(paths[0]).given.instance.benchmark_name.value}, {n} stops"
            measures = {
                f"{key}, Paretour": partial(by_paretour, seconds=SECONDS),
                f"{key}, kayros": by_kayros,
            }
            resume_beside("congestion", measures, [paths[index] for index in spread])
    print(congestion_table())


@lru_cache(1)  # of 1,000 stops an instance takes gigabytes
def read(path: Path) -> Known:
    """Read an instance, its arrival times and its best known sum, which lie beside each other."""
    name = path.name.removesuffix(".vrp.json")
    best = json.loads(path.with_name(f"{name}.bks.Duration.json").read_text(encoding="utf-8"))
    given = load_td_instance(path)
    td, places = given.instance.td, np.array(given.instance.coordinates, np.float64)
    if td is None or td.model != TD_IGP_MODEL:
        return Known(name, given, best["cost"], None)
    rows = load_instance_categories(path.with_name(td.categories_path)).categories
    steps = places[:, np.newaxis] - places
    of_pairs = np.array(td.speeds)[np.array([list(map(int, row)) for row in rows])]
    slices = [
        {"from": begin, "matrix": (np.hypot(*steps.T).T / of_pairs[..., period]).tolist()}
        for period, (begin, _) in enumerate(td.time_periods)
    ]
    return Known(name, given, best["cost"], slices)


def breakpoints(leaves: Array, reached: Array) -> list[list[float]]:
    """Return pairs of a time and the seconds on the way; what jumps up does so just before."""
    times, found = leaves.copy(), reached.copy()
    for jump in np.flatnonzero(np.diff(leaves) <= 0.0):
        times[jump] = leaves[jump] - _JUMP
        found[jump] = _reached(leaves, reached, times[jump])
    pairs = np.stack((times, found - times), axis=1)
    kept = np.append(np.diff(times) > 0.0, True)
    return pairs[kept].tolist()  # type: ignore[no-any-return]


def _reached(leaves: Array, reached: Array, time: float) -> float:
    """Return when who leaves at a time arrives."""
    after = max(1, int(np.searchsorted(leaves, time, "left")))
    (a, b), (c, d) = (leaves[after - 1], reached[after - 1]), (leaves[after], reached[after])
    return float(b + (d - b) * (time - a) / (c - a))


def request_of(known: Known, seconds: float) -> dict[str, Any]:
    """Return the request."""
    given = known.given.instance
    rows = zip(given.demands, given.service_times, given.time_windows, strict=True)
    stops = [
        {"id": str(stop), "demand": [demand], "service": service, "window": window}
        for stop, (demand, service, window) in enumerate(rows)
    ]
    van = {"id": "van", "count": given.num_vehicles, "capacity": [given.vehicle_capacity]}
    return {
        "stops": [{"id": "0"}, *stops[1:]],
        "vehicles": [{**van, "start": "0", "end": "0", "shift": given.horizon}],
        "objectives": [
            {"name": "time", **_times(known)},
            {"name": "vans", "measure": "vehicles"},
        ],
        "clock": "time",
        "time_limit": seconds,
        "seed": 1,
    }


def _times(known: Known) -> dict[str, Any]:
    """Return the source of the times of travel."""
    if known.slices is not None:
        return {"slices": known.slices}
    n = len(known.given.instance.demands)
    of_pairs: list[list[Any]] = [[None] * n for _ in range(n)]
    for (i, j), arrival in known.given.atfs.arcs.items():
        of_pairs[i][j] = breakpoints(np.array(arrival.xs), np.array(arrival.ys))
    return {"breakpoints": of_pairs}


def by_paretour(path: Path, seconds: float) -> dict[str, Any]:
    """Return the least sum of durations that Paretour finds, and its front."""
    known = read(path)
    request = request_of(known, seconds)
    began = time.monotonic()
    front = _planner().plan(fleet_plan(request), Silent()).front()
    spent = time.monotonic() - began
    assert isinstance(front, FleetFront)
    best = min(front, key=lambda plan: plan.lengths[0])
    priced = _priced(known, [[int(stop) for stop in each.stops[1:-1]] for each in best.routes])
    np.testing.assert_allclose(priced, best.lengths[0], rtol=1e-6, atol=0.1)
    points = [[round(float(value), 3) for value in plan.lengths] for plan in front]
    return {**_row(known, priced, spent), "front": points}


@cache
def _planner() -> LocalPlanner:
    return load_planner(
        settings().model_copy(update={"max_breakpoints": 2**24})
    )  # so many breakpoints


def by_kayros(path: Path) -> dict[str, Any]:
    """Return the sum of durations that kayros finds."""
    known = read(path)
    began = time.monotonic()
    found = kayros.solve(known.given, time_limit=SECONDS, seed=1)
    spent = time.monotonic() - began
    return _row(known, _priced(known, found.routes), spent)


def _priced(known: Known, routes: list[list[int]]) -> float:
    """Return the sum of durations of routes, as the checker of the sets has it."""
    solution = BenchmarkSolution(instance_name=known.given.instance.instance_name, routes=routes)
    checked = check_td_solution(known.given, solution)
    assert checked.routing_cost is not None, checked.error_message
    return checked.routing_cost


def _row(known: Known, found: float, seconds: float) -> dict[str, Any]:
    least = {"known": known.least, "found": round(found, 3)}
    return {"name": known.name, **least, "seconds": round(seconds, 3)}
