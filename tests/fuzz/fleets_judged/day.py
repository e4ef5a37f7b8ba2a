"""Costs over the day, and when a vehicle leaves if they change, by the words of the guide.

The end of a route is a function of its departure: pieces of straight lines, which are put together
leg by leg, forwards. The best departure is a corner of it.
"""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.timeline import (
    TOLERANCE,
    Event,
    Json,
    Timeline,
    is_later,
    places_of,
    released,
    span_of,
    trips_of,
)

_CHANGING = ("over_the_day", "slices", "breakpoints")
_EQUAL = 1e-8  # of the end: durations that differ by less are equally good
Corners = list[tuple[float, float]]  # of a function of the departure, from the earliest on


@dataclass(frozen=True)
class Costs:
    """The costs of an objective that change over the day, as its item has them.

    Args:
        item: Those of its members that say what legs cost.
    """

    item: Json

    def at(self, a: int, b: int, time: float) -> float:
        """Return what a leg costs that begins at a time, unless it is the clock's."""
        if "breakpoints" in self.item:
            return _between(self.item["breakpoints"][a][b] or [[0.0, 0.0]], time)
        begins, costs = self._slices(a, b)
        return costs[max(0, bisect_right(begins, time) - 1)]

    def arrival(self, a: int, b: int, time: float, speed: float) -> float:
        """Return when a vehicle arrives by the clock, slice by slice."""
        if "breakpoints" in self.item:
            return time + self.at(a, b, time) / speed
        begins, costs = self._slices(a, b)
        way = 1.0  # the share of it that is left
        for ends, seconds in zip([*begins[1:], inf], costs, strict=True):
            needed = way * seconds / speed
            if time >= ends:
                continue
            if time + needed <= ends:
                return time + needed
            way -= (ends - time) / (seconds / speed)
            time = ends
        raise AssertionError("the last slice has no end")

    def corners(self, a: int, b: int, speed: float) -> list[float]:
        """Return the times at which a vehicle leaves, and then drives or arrives in a new slice."""
        if "breakpoints" in self.item:
            return [time for time, _ in self.item["breakpoints"][a][b] or []]
        begins, costs = self._slices(a, b)
        found = begins[1:]
        for arrival in begins[1:]:
            way, time = 1.0, arrival
            for number in range(len(begins) - 1, -1, -1):
                since = begins[number] if number else -inf
                if time <= since:
                    continue
                seconds = costs[number] / speed
                if time - way * seconds >= since:
                    found.append(time - way * seconds)
                    break
                way -= (time - since) / seconds
                time = since
        return found

    @property
    def changes(self) -> list[float]:
        """All times at which something changes."""
        pairs = [pair for row in self.item.get("breakpoints", ()) for pair in row if pair]
        times = [time for pair in pairs for time, _ in pair]
        times += [each["from"] for each in self.item.get("slices", ())]
        return times + [time for time, _ in self.item.get("over_the_day", ())]

    def _slices(self, a: int, b: int) -> tuple[list[float], list[float]]:
        if "slices" in self.item:
            pairs = [(each["from"], each["matrix"][a][b]) for each in self.item["slices"]]
        else:
            cost = self.item["matrix"][a][b]
            pairs = [(time, factor * cost) for time, factor in self.item["over_the_day"]]
        return [time for time, _ in pairs], [cost for _, cost in pairs]


def with_days(request: Json) -> Json:
    """Return a request whose costs that change have `day`, and a `matrix` with a way or none."""
    clock = request.get("clock")
    return {
        **request,
        "objectives": [_with_day(each) for each in request["objectives"]],
        "clock": _with_day(clock) if isinstance(clock, dict) else clock,
    }


def _with_day(item: Json) -> Json:
    named = [name for name in _CHANGING if name in item]
    if not named or "matrices" in item:
        return item
    day = Costs({name: item[name] for name in ("matrix", *named) if name in item})
    if "slices" in item:
        by_pair = zip(*(each["matrix"] for each in item["slices"]), strict=True)
        # Of these numbers only those that are None mean something.
        item = {
            **item,
            "matrix": [[_first(row) for row in zip(*rows, strict=True)] for rows in by_pair],
        }
    if "breakpoints" in item:
        rows = enumerate(item["breakpoints"])
        item = {
            **item,
            "matrix": [
                [0.0 if i == j else pair and 1.0 for j, pair in enumerate(row)] for i, row in rows
            ],
        }
    return {**item, "day": day}


def _first(costs: tuple[float | None, ...]) -> float | None:
    return None if None in costs else costs[0]


def is_over_the_day(request: Json) -> bool:
    """Return whether some costs of a request change over the day."""
    items = [
        each for each in (*request["objectives"], request.get("clock")) if isinstance(each, dict)
    ]
    own = [each for item in items for each in item.get("matrices", ())]
    return any(name in each for each in (*items, *own) for name in _CHANGING)


def _between(pairs: Any, time: float) -> float:
    """Return what lies on the line between two pairs of a time and a cost."""
    if time <= pairs[0][0]:
        return float(pairs[0][1])
    for (t, cost), (u, other) in pairwise(pairs):
        if time <= u:
            return float(cost + (other - cost) * (time - t) / (u - t))
    return float(pairs[-1][1])


class _Way(NamedTuple):
    """A route: the visits, and the function of when a leg that begins at a time ends, by number."""

    visits: list[Event]
    arrival: Callable[[int, float], float]


def timelines_of_day(request: Json, clock: Json, vehicle: Json, stops: list[int]) -> list[Timeline]:
    """Return the best times of a route without breaks, or none where it cannot be in time.

    Where almost equally good departures are told apart by roundings, all of them.

    Args:
        request: The request; no stop has several windows.
        clock: The item of the costs that are time.
        vehicle: The vehicle, with one `shift` at most.
        stops: The visits, and where it loads again.
    """
    begin, last = span_of(vehicle)
    begin = max(begin, released(request, trips_of(vehicle, stops)[0]))
    places = places_of(request, clock["matrix"], vehicle, stops, {})
    if not all(places):  # a window that is over before the day begins
        return []
    visits = [each for [each] in places]
    ends = [[] if each is None else [each] for each in map(vehicle.get, ("start", "end"))]
    path, speed = [*ends[0], *stops, *ends[1]], vehicle.get("speed_factor", 1.0)
    legs = [*pairwise(path)]
    costs: Costs = clock.get("day") or Costs({**clock, "over_the_day": [[0.0, 1.0]]})

    def arrival(leg: int, time: float) -> float:
        return costs.arrival(*legs[leg], time, speed)

    way = _Way(visits, arrival)
    first = _driven(way, begin)
    if first is None or is_later(first.end, last):
        return []
    if request.get("leave") == "early":
        return [first]
    finite = [t for each in visits for t in (each.opens, each.closes, each.due) if t < inf]
    latest = max([begin, first.end, *costs.changes, *finite])
    corners: Corners = [(begin, begin), (latest, latest)]
    for number, visit in enumerate(visits):
        if number:
            inner = costs.corners(*legs[number - 1], speed)
            corners = _through(corners, inner, lambda t, leg=number - 1: arrival(leg, t))
        corners = _until(corners, visit.closes)
        corners = _through(corners, [visit.opens], lambda t, opens=visit.opens: max(t, opens))
        corners = _until(corners, max(visit.due, first.begins[number]))
        corners = [(d, t + visit.length) for d, t in corners]
    shift_end = span_of({**vehicle, "max_overtime": 0.0})[1]
    corners = _until(corners, min(last, max(shift_end, first.end)))
    least = min(end - departure for departure, end in corners)
    slack = _EQUAL * max(1.0, first.end)
    found = [
        _driven(way, min(d for d, end in corners if end - d <= least + share * slack))
        for share in (0.01, 1.0, 10.0)
    ]
    return [each for each in found if each is not None]


def _driven(way: _Way, departure: float) -> Timeline | None:
    time, lateness, waiting = departure, 0.0, 0.0
    arrivals, begins, leaves = list[float](), list[float](), list[float]()
    for number, visit in enumerate(way.visits):
        if number:
            time = way.arrival(number - 1, time)
        if is_later(time, visit.closes):
            return None
        begin = max(time, visit.opens)
        arrivals.append(time)
        begins.append(begin)
        waiting += begin - time
        lateness += begin - visit.due if is_later(begin, visit.due) else 0.0
        time = begin + visit.length
        leaves.append(time)
    times = tuple(arrivals), (), tuple(begins), tuple(leaves)
    return Timeline(departure, time, lateness, waiting, *times)


def _through(corners: Corners, inner: list[float], ends: Callable[[float], float]) -> Corners:
    """Return the corners of when something ends that begins at these times, given its own."""
    found = [(d, ends(t)) for d, t in corners]
    for (d, t), (e, u) in pairwise(corners):
        found += [(d + (e - d) * (v - t) / (u - t), ends(v)) for v in inner if t < v < u]
    return sorted(found)


def _until(corners: Corners, last: float) -> Corners:
    """Return the corners up to the departure after which it would be later than `last`."""
    latest = last + (TOLERANCE * max(1e-6, last) if last < inf else 0.0)
    found = [(d, t) for d, t in corners if t <= latest]
    for (d, t), (e, u) in pairwise(corners):
        if t <= last < u:
            found.append((d + (e - d) * (last - t) / (u - t), last))
    return sorted(found)
