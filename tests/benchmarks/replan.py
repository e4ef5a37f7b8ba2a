"""`python -m tests.benchmarks replan`: replanning beside planning from nothing, over HTTP.

Instances of 50, 200 and 1000 stops, uniform and clustered. A front is planned, and of its tour
nearest to balance 0.5 a tenth of the stops is done. Then a share of the stops changes: half of
these are removed, and as many added. The rest is planned by `POST /front/{id}/replan` and, from
nothing, by `POST /front`, within the same limits. These are of the whole answer, received on
loopback: what the service takes beside its planning is measured first, and taken off `time_limit`.

Hypervolume is that in the box of the front that 5 s from nothing reach, from its least lengths to
its greatest, as a share of that front's own. `kept` is that of the tour nearest to the driven one's
balance. `busy` beside the results is how many programs wanted each processor when they began. What
is stored is not measured again. Stores `results/replan.json`.
"""

import argparse
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import httpx
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from models.data.generators import clustered, uniform
from service.pareto import hypervolume
from tests.benchmarks.rows import resume
from tests.helpers.serving import serving_released

Array = NDArray[np.float64]

SIZES = (50, 200, 1000)
SHARES = (1, 5, 10)  # per cent of the stops
SHAPES: Mapping[str, Callable[[int, Generator], Array]] = {
    "uniform": uniform,
    "clustered": clustered,
}
LIMITS = (0.1, 0.2, 0.5)  # seconds of an answer
FIRST_SECONDS = 3.0  # for the front that is replanned
REFERENCE_SECONDS = 5.0
_LEAST = 0.01  # seconds of planning, where the rest takes nearly all
_COUNT = 100
_EDGE = 1e-9  # by which the box is wider, so that the points on its edges lie within


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks replan", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", default=SIZES)
    parser.add_argument("--shares", type=int, nargs="+", choices=SHARES, default=SHARES)
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=tuple(SHAPES))
    parser.add_argument("--count", type=int, default=_COUNT, help="instances of each row")
    options = parser.parse_args(arguments)
    with serving_released() as address, httpx.Client(base_url=address, timeout=60) as client:
        for n in options.cities:
            for shape in options.shapes:
                for share in options.shares:
                    measure = partial(measured, client, n, shape, share)
                    key = f"{n} stops, {shape}, {share} %"
                    resume("replan", key, "", range(options.count), measure)  # type: ignore[arg-type]


def measured(client: httpx.Client, n: int, shape: str, share: int, seed: int) -> dict[str, Any]:
    """Shares of hypervolume and seconds by limit, replanned and from nothing, and what is kept."""
    generator = np.random.default_rng((n, share, seed))
    draw = SHAPES[shape]
    cities = np.concatenate((draw(n, generator), draw(n, generator)), axis=1)
    front = _answer(client, "/front", {"coordinates": cities.tolist()}, FIRST_SECONDS)
    changes, rest = _changes(front, cities, max(1, round(n * share / 200)), generator)
    to_replan = f"/front/{front['id']}/replan"
    best = _points(_answer(client, "/front", rest, REFERENCE_SECONDS))
    spent = [_spent(client, path, body) for path, body in ((to_replan, changes), ("/front", rest))]
    found: dict[str, Any] = {}
    for limit in LIMITS:
        for name, path, body, beside in (
            ("replanned", to_replan, changes, spent[0]),
            ("from nothing", "/front", rest, spent[1]),
        ):
            began = time.perf_counter()
            answer = _answer(client, path, body, max(_LEAST, limit - beside))
            seconds = time.perf_counter() - began
            found[f"{name}, {limit} s"] = {
                "share": round(share_of(_points(answer), best), 5),
                "seconds": round(seconds, 4),
                **_kept(answer),
            }
    return found


def share_of(points: Array, best: Array) -> float:
    """The hypervolume of points in the box of the best ones, as a share of theirs."""
    least, extent = best.min(axis=0), np.ptp(best, axis=0)
    corner = np.full(2, 1 + _EDGE)
    inside, whole = (np.maximum((each - least) / extent, 0.0) for each in (points, best))
    return hypervolume(inside, corner) / hypervolume(whole, corner)


def _changes(
    front: dict[str, Any], cities: Array, count: int, generator: Generator
) -> tuple[dict[str, Any], dict[str, Any]]:
    """A request to replan, and the same rest of the way as a request for a front."""
    driven = min(front["front"], key=lambda tour: abs(tour["balance"] - 0.5))["tour"]
    done = len(driven) // 10
    removed = generator.choice(driven[done + 1 :], count, replace=False).tolist()
    drawn = generator.integers(0, len(cities), (count, 2))
    new = np.concatenate((cities[drawn[:, 0], :2], cities[drawn[:, 1], 2:]), axis=1)
    new += generator.normal(0, 0.01, new.shape)
    left = [city for city in driven[done:] if city not in removed]
    rest = np.concatenate((cities[left], new, cities[driven[:1]]))
    changes = {
        "done": driven[: done + 1],
        "tour": driven,
        "remove": removed,
        "add": [
            {"id": f"new {index}", "coordinates": [row[:2], row[2:]]}
            for index, row in enumerate(new.tolist())
        ],
    }
    ends = {"closed": False, "start": 0, "end": len(rest) - 1}
    return changes, {"coordinates": rest.tolist(), **ends}


def _answer(client: httpx.Client, path: str, body: dict[str, Any], seconds: float) -> Any:
    return client.post(path, json={**body, "time_limit": seconds}).raise_for_status().json()


def _spent(client: httpx.Client, path: str, body: dict[str, Any]) -> float:
    """The seconds of an answer that are not of planning, the most of three."""
    spent = []
    for _ in range(3):
        began = time.perf_counter()
        _answer(client, path, body, 2 * _LEAST)
        spent.append(time.perf_counter() - began - 2 * _LEAST)
    return max(spent)


def _points(answer: dict[str, Any]) -> Array:
    return np.array([tour["lengths"] for tour in answer["front"]])


def _kept(answer: dict[str, Any]) -> dict[str, float]:
    """What the tour nearest to balance 0.5, as the driven one is, keeps of that."""
    nearest = min(answer["front"], key=lambda tour: abs(tour["balance"] - 0.5))
    return {"kept": round(nearest["kept"], 4)} if "kept" in nearest else {}
