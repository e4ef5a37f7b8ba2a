"""When visits begin that wait for those of other routes, found by letting all vehicles drive."""

from itertools import product
from math import inf
from typing import Any

from tests.fuzz.fleets_judged.timeline import (
    Bounds,
    Json,
    is_later,
    places_of,
    released,
    span_of,
)


def has_waits(request: Json) -> bool:
    """Return whether some visits wait for others, whoever drives."""
    return any(each.get("vehicles") == "any" for each in request.get("before", ()))


def bounds_of(
    request: Json, matrices: list[Any], routes: list[tuple[Json, tuple[int, ...]]]
) -> Bounds | None:
    """Return the bounds of all visits that wait, or for which others wait; None in a circle.

    Args:
        request: The request.
        matrices: The times of the legs to the vehicle of each route.
        routes: The vehicles, which do not rest or load again, and their visits.
    """
    pairs: dict[tuple[int, int], float] = {}
    for each in request["before"]:
        for pair in product(each["first"], each["then"]) if each.get("vehicles") == "any" else ():
            pairs[pair] = max(pairs.get(pair, 0.0), each.get("gap", 0.0))
    where = {stop: number for number, (_, stops) in enumerate(routes) for stop in stops}
    pairs = {
        (a, b): gap
        for (a, b), gap in pairs.items()
        if a in where and b in where and (gap or where[a] != where[b])
    }
    driven = _driven(request, matrices, routes, pairs)
    if driven is None:
        return None
    begins, ends = driven
    found: Bounds = {}
    for stop in where:
        since = max((ends[a] + gap for (a, b), gap in pairs.items() if b == stop), default=0.0)
        lasts = ends[stop] - begins[stop]
        hold = min(
            (begins[b] - gap - lasts for (a, b), gap in pairs.items() if a == stop), default=inf
        )
        found[stop] = since, hold
    return found


def _driven(
    request: Json,
    matrices: list[Any],
    routes: list[tuple[Json, tuple[int, ...]]],
    pairs: dict[tuple[int, int], float],
) -> tuple[dict[int, float], dict[int, float]] | None:
    """Let all vehicles leave at once, and return when each visit begins and ends."""
    begins: dict[int, float] = {}
    ends: dict[int, float] = {}
    vehicles = []
    for (vehicle, stops), matrix in zip(routes, matrices, strict=True):
        places = places_of(request, matrix, vehicle, [*stops], {})
        leaves = max(span_of(vehicle)[0], released(request, [*stops]))
        path = [*([] if vehicle.get("start") is None else [None]), *stops]
        vehicles.append([leaves, [*zip(path, places, strict=False)]])
    moved = True
    while moved:
        moved = False
        for each in vehicles:
            time, left = each
            while left:
                stop, windows = left[0]
                firsts = {a: gap for (a, b), gap in pairs.items() if b == stop}
                if not firsts.keys() <= ends.keys():
                    break
                reached = max(
                    [time + windows[0].leg, *(ends[a] + gap for a, gap in firsts.items())]
                )
                window = next((w for w in windows if not is_later(reached, w.closes)), None)
                if window is None:
                    return None
                begin = max(reached, window.opens)
                time = each[0] = begin + window.length
                if stop is not None:
                    begins[stop], ends[stop] = begin, time
                left.pop(0)
                moved = True
    return None if any(left for _, left in vehicles) else (begins, ends)
