"""`python -m tests.benchmarks deadlines`: by how much planning exceeds its time limit, and uses it.

Requests of every kind, under two, three and four objectives, of 8 to 10,000 cities, with limits of
.05 to 10 s and 1 to 1,000 tours to choose, are planned one after another: by a service over HTTP,
in this process by the library, or by a cluster of one machine (Redis, and a worker of Celery).
Seconds are those of planning as the answer has them, without waiting, the survey of a map and its
paths; those of the library are by the clock. With
`--busy` every core computes something else as well.

Prints for each kind and size, and each limit, the worst of all numbers of tours: the milliseconds
beyond the limit, and the least share of it that was used where the search had not converged. What
must hold: 50 ms and 2 % beyond it at most, and nine tenths of it used. Prints, and stores nothing.
"""

import argparse
import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import httpx
import numpy as np
import paretour

from tests.benchmarks.markdown import table
from tests.helpers.processes import serve_process, work_process
from tests.helpers.redis_server import redis_server

OBJECTIVES = (2, 3, 4)
CITIES = (8, 12, 30, 100, 500, 2_000, 10_000)
LIMITS = (0.05, 0.1, 0.3, 1.0, 3.0, 10.0)
SIZES = (1, 20, 100, 1_000)
MOST = {"matrices": 1_000, "day": 500, "coverage": 500, "detours": 100, "fleet": 499}
LEAST_USED, MOST_BEYOND, BEYOND_SHARE = 0.9, 0.05, 0.02
MOST_IN_ANSWER = 2_000_000  # stops of all tours
APART = ("queue", "costs", "roads", "survey", "paths")  # phases that are no planning
_EARLIER = 0.3  # seconds, for the front that is replanned

Body = dict[str, Any]
# Plans a body that is posted to a path; returns the seconds of planning, and the answer.
Ask = Callable[[str, Body], tuple[float, Body]]


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks deadlines", description=__doc__)
    parser.add_argument("--where", choices=WAYS, default="http")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--objectives", nargs="+", type=int, default=list(OBJECTIVES))
    parser.add_argument("--cities", nargs="+", type=int, default=list(CITIES))
    parser.add_argument("--limits", nargs="+", type=float, default=list(LIMITS))
    parser.add_argument("--sizes", nargs="+", type=int, default=list(SIZES))
    parser.add_argument("--busy", action="store_true", help="keep every core busy")
    options = parser.parse_args(arguments)
    cells = [
        (kind, objectives, cities)
        for kind in options.kinds
        for objectives in options.objectives
        for cities in options.cities
        if cities <= MOST.get(kind, cities) and (objectives < 4 or kind != "fleet")
    ]
    rows, unmet = [], []
    with WAYS[options.where]() as ask, _busy(options.busy):
        for kind, objectives, cities in cells:
            worst = [
                _worst(ask, kind, objectives, cities, limit, options.sizes)
                for limit in options.limits
            ]
            row = [f"{kind}, {cities}", str(objectives), *map(_said, worst)]
            print("\t".join(row), flush=True)
            rows.append(row)
            missed = zip(options.limits, worst, strict=True)
            unmet += [
                f"{row[0]}, {row[1]} objectives, {a:g} s: {_said(b)}"
                for a, b in missed
                if not _holds(a, *b)
            ]
    print(table(["cities", "objectives", *(f"{limit:g} s" for limit in options.limits)], rows))
    return "\n".join(unmet) or None


def _worst(
    ask: Ask, kind: str, objectives: int, cities: int, limit: float, sizes: Sequence[int]
) -> tuple[float, float]:
    """Return the most seconds beyond a limit, and the least share of it that was used."""
    beyond, used = -np.inf, 1.0
    for size in sizes:
        request = KINDS[kind](np.random.default_rng(cities), objectives, cities)
        options = {"time_limit": limit, "size": min(size, MOST_IN_ANSWER // cities)}
        if kind == "replanned":
            _, earlier = ask("front", {**request, "time_limit": _EARLIER})
            seconds, answer = ask(f"front/{earlier['id']}/replan", {"done": [0], **options})
        else:
            path = {"fleet": "fleet", "coverage": "coverage", "detours": "coverage"}
            seconds, answer = ask(path.get(kind, "front"), {**request, **options})
        beyond = max(beyond, seconds - limit)
        if answer["terminated"] == "time_limit":
            used = min(used, seconds / limit)
    return beyond, used


def _said(worst: tuple[float, float]) -> str:
    beyond, used = worst
    return f"{1000 * beyond:+.0f} ms, {100 * used:.0f} %"


def _holds(limit: float, beyond: float, used: float) -> bool:
    return beyond <= MOST_BEYOND + BEYOND_SHARE * limit and used >= LEAST_USED


def _planes(random: np.random.Generator, objectives: int, cities: int) -> Body:
    return {"coordinates": random.random((cities, 2 * objectives)).tolist()}


def _matrices(random: np.random.Generator, objectives: int, cities: int) -> Body:
    return {"matrices": random.random((objectives, cities, cities)).round(4).tolist()}


def _open(random: np.random.Generator, objectives: int, cities: int) -> Body:
    return {**_planes(random, objectives, cities), "closed": False}


def _day(random: np.random.Generator, objectives: int, cities: int) -> Body:
    places = 5_000 * random.random((objectives, cities, 2))
    matrices = [np.linalg.norm(each[:, None] - each, axis=2).round(1).tolist() for each in places]
    rush = [[0, 1.0], [27_000, 1.6], [34_200, 1.1]]
    named = [{"name": f"o{i}", "matrix": matrix} for i, matrix in enumerate(matrices)]
    named[0] |= {"unit": "s", "over_the_day": rush}
    stops = [{"id": f"s{i}", "service": 60} for i in range(cities)]
    return {"stops": stops, "objectives": named, "departure": 25_200}


def _coverage(random: np.random.Generator, objectives: int, cities: int) -> Body:
    side = 60
    cells = random.choice(side * side, cities, replace=False)
    layers = [
        {"name": f"o{i}", "layer": (0.1 + random.random((side, side))).tolist()}
        for i in range(1, objectives)
    ]
    return {
        "grid": [[0] * side] * side,
        "cell_size": 0.5,
        "places": np.column_stack(np.divmod(cells, side)).tolist(),
        "cost_layers": layers,
    }


def _detours(random: np.random.Generator, objectives: int, cities: int) -> Body:
    return {**_coverage(random, objectives, cities), "detours": True}


def _fleet(random: np.random.Generator, objectives: int, cities: int) -> Body:
    places = random.random((2, cities, 2)).tolist()
    total = {"name": "total", "coordinates": places[0]}
    longest = {"name": "longest", "coordinates": places[0], "over": "max"}
    third = {"name": "vehicles", "measure": "vehicles"}
    stops = [{"id": "depot"}, *({"id": f"s{i}", "demand": [1]} for i in range(1, cities))]
    vans = max(2, cities // 20)
    van = {"id": "van", "count": 2 * vans, "start": 0, "end": 0, "capacity": [-(-cities // vans)]}
    return {"stops": stops, "vehicles": [van], "objectives": [total, longest, third][:objectives]}


KINDS: Mapping[str, Callable[[np.random.Generator, int, int], Body]] = {
    "planes": _planes,
    "matrices": _matrices,
    "open": _open,
    "replanned": _planes,
    "day": _day,
    "coverage": _coverage,
    "detours": _detours,
    "fleet": _fleet,
}


@contextmanager
def _over_http(settings: Mapping[str, str] | None = None) -> Iterator[Ask]:
    """Yield what asks a service of one machine."""
    with (
        serve_process({"PARETOUR_WORKERS": "1", **(settings or {})}, ready=True) as service,
        httpx.Client(base_url=service.url, timeout=120) as client,
    ):

        def ask(path: str, body: Body) -> tuple[float, Body]:
            answer = client.post(f"/{path}", json=body)
            if answer.is_error:
                raise RuntimeError(answer.text)
            timings = answer.json()["timings_ms"]
            planning = timings["total"] - sum(timings.get(each, 0.0) for each in APART)
            return planning / 1000, answer.json()

        yield ask


@contextmanager
def _in_process() -> Iterator[Ask]:
    """Yield what plans in this process."""
    fronts: dict[str, Any] = {}

    def ask(path: str, body: Body) -> tuple[float, Body]:
        plan = {
            "front": paretour.plan,
            "fleet": paretour.plan_fleet,
            "coverage": paretour.plan_coverage,
        }
        begun = time.monotonic()
        if path in plan:
            front: Any = plan[path](**body)
        else:
            front = paretour.replan(fronts[path.split("/")[1]], **body)
        seconds = time.monotonic() - begun
        key = str(len(fronts))
        fronts[key] = front
        return seconds, {"id": key, "terminated": front.terminated}

    yield ask


@contextmanager
def _by_a_cluster() -> Iterator[Ask]:
    """Yield what asks a service whose work another process does, by way of Redis."""
    with TemporaryDirectory() as folder, redis_server(Path(folder)) as redis:
        settings = {"PARETOUR_REDIS_URL": redis.url, "PARETOUR_WORKERS": "1"}
        with work_process(settings), _over_http(settings) as ask:
            yield ask


WAYS = {"http": _over_http, "library": _in_process, "cluster": _by_a_cluster}


@contextmanager
def _busy(wanted: bool) -> Iterator[None]:
    """Keep every core busy with something else, where it is wanted."""
    count = len(os.sched_getaffinity(0)) if wanted else 0
    others = [multiprocessing.Process(target=_compute, daemon=True) for _ in range(count)]
    for other in others:
        other.start()
    try:
        yield
    finally:
        for other in others:
            other.kill()


def _compute() -> None:
    while True:
        sum(range(10_000))
