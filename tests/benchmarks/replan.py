"""`python -m tests.benchmarks replan`: replanning beside planning from nothing, over HTTP.

Instances of 50, 200 and 1000 stops, uniform and clustered, and of 50 stops in Helsinki by road. A
front is planned, and of its tour nearest to balance 0.5 a tenth of the stops is done. Then a share
of the stops changes: half of these are removed, and as many added; of one stop alone, that is on
every other instance removed, on the others added. On roads there are rows as well
where the steps from a share of the stops cost three times as much. The rest is planned by
`POST /front/{id}/replan` and, from nothing, by `POST /front`, within the same limits. These are of
the whole answer, received on loopback, not compressed, from a service in processes of its own: what
it takes beside its planning is measured first, and taken off `time_limit`. OR-Tools has the same
limits in a process without HTTP; it sets out from the front's tours, with added stops where they
cost least (that time is not counted), and improves them under weighted sums.

Hypervolume is that in the box of the front that 5 s from nothing reach, from its least lengths to
its greatest, as a share of that front's own. `kept` is that of the tour nearest to the driven one's
balance, and `longer` by what share its lengths exceed those of that front in its direction. `busy`
beside the results is how many programs wanted each processor when they began. What is stored is not
measured again: `--count 5` takes half an hour. Stores `results/replan.json`, and says what does not
hold.
"""

import argparse
import json
import time
from collections.abc import Iterator, Mapping
from functools import partial
from statistics import median
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from service.instance import tour_lengths
from service.pareto import hypervolume, nondominated
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints
from tests.benchmarks.provenance import load
from tests.benchmarks.rests import (
    ROAD_STOPS,
    ROADS,
    ROADS_COSTS,
    SHAPES,
    Rest,
    draw_stops,
    with_costs_changed,
    with_stops_changed,
)
from tests.benchmarks.rows import TOURS, resume
from tests.helpers.processes import serve_process

Array = NDArray[np.float64]

SIZES = (50, 200, 1000)
SHARES = (1, 5, 10)  # per cent of the stops
ALL_SHAPES = (*SHAPES, ROADS, ROADS_COSTS)
LIMITS = (0.1, 0.2, 0.5)  # seconds of an answer
FIRST_SECONDS = 3.0  # for the front that is replanned
REFERENCE_SECONDS = 5.0
_LEAST = 0.01  # seconds of planning, where the rest takes nearly all
_TIMED = 0.05  # seconds of planning, beside which the rest is timed: with less, some of it is late
_COUNT = 100
_EDGE = 1e-9  # by which the box is wider, so that the points on its edges lie within
_NARROWEST = 1e-3  # of a box, as a share of the least length
_ENOUGH, _AHEAD = 0.99, 0.9  # of hypervolume, and of instances, within the limits of:
_FAST = (("200 stops, {}, 10 %", 0.1), ("1000 stops, {}, 1 %", 0.5))
_KEPT, _LONGER = 0.85, 0.001  # where one per cent of stops changes


def main(arguments: list[str]) -> str | None:
    """The command line. Says what does not hold."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks replan", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", default=SIZES)
    parser.add_argument("--shares", type=int, nargs="+", choices=SHARES, default=SHARES)
    parser.add_argument("--shapes", nargs="+", choices=ALL_SHAPES, default=ALL_SHAPES)
    parser.add_argument("--count", type=int, default=_COUNT, help="instances of each row")
    options = parser.parse_args(arguments)
    # On loopback nobody has answers compressed: that takes longer than to send them.
    plain = {"Accept-Encoding": "identity", "Content-Type": "application/json"}
    with (
        serve_process({"PARETOUR_WORKERS": "1"}, ready=True) as service,
        httpx.Client(base_url=service.url, headers=plain, timeout=60) as client,
    ):
        for n in options.cities:
            for shape in options.shapes:
                if shape not in SHAPES and n != ROAD_STOPS:
                    continue
                for share in options.shares:
                    measure = partial(measured, client, n, shape, share)
                    key = f"{n} stops, {shape}, {share} %"
                    resume("replan", key, "", range(options.count), measure)  # type: ignore[arg-type]
    return "\n".join(unmet(load("replan"))) or None


def measured(client: httpx.Client, n: int, shape: str, share: int, seed: int) -> dict[str, Any]:
    """Shares of hypervolume and seconds by limit, of each way to plan, and what is kept."""
    generator = np.random.default_rng((n, share, seed))
    of_costs = shape == ROADS_COSTS
    removed, added = (0, 0) if of_costs else removed_and_added(n, share, seed)
    stops = draw_stops(shape, n, added, generator)
    front, _ = _planned(client, "/front", stops.request(range(n)), FIRST_SECONDS)
    if of_costs:
        rest = with_costs_changed(stops, front, max(1, round(n * share / 100)), generator)
    else:
        rest = with_stops_changed(stops, front, removed, added, generator)
    ways = (
        ("replanned", f"/front/{front['id']}/replan", rest.changes),
        ("from nothing", "/front", rest.request),
    )
    reference, _ = _planned(client, "/front", rest.request, REFERENCE_SECONDS)
    best = _points(reference)
    spent = {path: _spent(client, path, body) for _, path, body in ways}
    found: dict[str, Any] = {}
    for limit in LIMITS:
        for name, path, body in ways:
            left = max(_LEAST, limit - spent[path])
            answer, seconds = _planned(client, path, body, left)
            cell = _cell(_points(answer), best, seconds)
            found[f"{name}, {limit} s"] = {**cell, **_kept(answer, best, rest.balance)}
        found[f"OR-Tools, {limit} s"] = _by_or_tools(rest, best, limit)
    return found


def removed_and_added(n: int, share: int, seed: int) -> tuple[int, int]:
    """How many stops are removed and added if a percentage of n stops changes."""
    pairs = round(n * share / 200)
    if pairs == 0:
        return (1, 0) if seed % 2 == 0 else (0, 1)
    return pairs, pairs


def unmet(results: Mapping[str, Any]) -> Iterator[str]:
    """Yield what does not hold of the rows that there are."""
    for template, limit in _FAST:
        for key in map(template.format, SHAPES):
            if key in results:
                yield from _not_fast(key, limit, results[key]["instances"])
    for key, entry in results.items():
        if key.endswith(", 1 %") and key.split(", ")[1] in (*SHAPES, ROADS):
            yield from _not_alike(
                key, [each[f"replanned, {LIMITS[-1]} s"] for each in entry["instances"]]
            )


def share_of(points: Array, best: Array) -> float:
    """The hypervolume of points in the box of the best ones, as a share of theirs.

    Where one point is the whole front, as on roads where time and distance agree, it has no box:
    each side is at least a thousandth of the least length.
    """
    least = best.min(axis=0)
    extent = np.maximum(np.ptp(best, axis=0), _NARROWEST * least)
    corner = np.full(2, 1 + _EDGE)
    inside, whole = (np.maximum((each - least) / extent, 0.0) for each in (points, best))
    return hypervolume(inside, corner) / hypervolume(whole, corner)


def longer_than(point: Array, best: Array) -> float:
    """By what share of its lengths a point exceeds the best ones in its direction, at least 0.

    Between two of these, by ascending first length, their distance from the origin is interpolated.
    """
    scaled, own = best / best.max(axis=0), point / best.max(axis=0)
    directions = np.arctan2(scaled[:, 0], scaled[:, 1])
    distance = np.interp(np.arctan2(*own), directions, np.linalg.norm(scaled, axis=1))
    return max(0.0, float(np.linalg.norm(own) / distance) - 1)


def _not_fast(key: str, limit: float, instances: list[dict[str, Any]]) -> Iterator[str]:
    shares = [each[f"replanned, {limit} s"]["share"] for each in instances]
    others = [each[f"from nothing, {limit} s"]["share"] for each in instances]
    if median(shares) < _ENOUGH:
        yield f"{key}: {median(shares):.4f} of the hypervolume within {limit} s, not {_ENOUGH}"
    ahead = float(np.mean([one > other for one, other in zip(shares, others, strict=True)]))
    if ahead < _AHEAD:
        yield f"{key}: ahead of planning from nothing on {ahead:.0%} of instances within {limit} s"


def _not_alike(key: str, cells: list[dict[str, float]]) -> Iterator[str]:
    kept, longer = (median(cell[name] for cell in cells) for name in ("kept", "longer"))
    if kept < _KEPT:
        yield f"{key}: {kept:.0%} of the legs are kept, not {_KEPT:.0%}"
    if longer > _LONGER:
        yield f"{key}: that tour is {longer:.2%} longer than need be, not {_LONGER:.2%}"


def _by_or_tools(rest: Rest, best: Array, limit: float) -> dict[str, float]:
    from tests.benchmarks.rivals.ortools_routing import improved_routes

    began = time.perf_counter()
    routes = improved_routes(rest.instance.scaled_matrices, rest.hints, limit)
    seconds = time.perf_counter() - began
    points = tour_lengths(rest.instance, np.concatenate((rest.hints, routes)))
    points = points[nondominated(points)]
    corner = rest.instance.n * rest.instance.scale
    return _cell(points[best_subset(FrontPoints(points, corner), TOURS)], best, seconds)


def _cell(points: Array, best: Array, seconds: float) -> dict[str, float]:
    return {"share": round(share_of(points, best), 5), "seconds": round(seconds, 4)}


def _planned(
    client: httpx.Client, path: str, body: dict[str, Any], time_limit: float
) -> tuple[dict[str, Any], float]:
    """Return an answer, and the seconds from the request until all of it was received."""
    content = json.dumps({**body, "time_limit": time_limit})
    began = time.perf_counter()
    response = client.post(path, content=content)
    seconds = time.perf_counter() - began
    return response.raise_for_status().json(), seconds


def _spent(client: httpx.Client, path: str, body: dict[str, Any]) -> float:
    """The seconds of an answer that are not of planning, in the median of five."""
    answers = [_planned(client, path, body, _TIMED) for _ in range(5)]
    return median(seconds for _, seconds in answers) - _TIMED


def _points(answer: dict[str, Any]) -> Array:
    return np.array([tour["lengths"] for tour in answer["front"]])


def _kept(answer: dict[str, Any], best: Array, balance: float) -> dict[str, float]:
    """What the tour nearest to the balance of the driven one keeps of that."""
    nearest = min(answer["front"], key=lambda tour: abs(tour["balance"] - balance))
    if "kept" not in nearest:
        return {}
    longer = longer_than(np.array(nearest["lengths"]), best)
    return {"kept": round(nearest["kept"], 4), "longer": round(longer, 6)}
