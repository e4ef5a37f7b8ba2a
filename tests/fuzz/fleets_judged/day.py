"""Costs over the day, and when a vehicle leaves if they change, by the words of the guide.

The end of a route is a function of its departure: pieces of straight lines, which are put together
leg by leg, forwards. The best departure is a corner of it.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import combinations_with_replacement, pairwise
from math import inf
from typing import Any, NamedTuple, TypeVar

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


class _Stay(NamedTuple):
    """A visit or a break: when it may begin, how long it takes, and the leg before it."""

    windows: list[tuple[float, float]]
    length: float
    due: float
    leg: int | None  # its number
    place: int  # the place in the route
    rests: bool

    def begin(self, time: float) -> float | None:
        """Return when it begins, given when the vehicle is there; None after its windows."""
        open_then = (opens for opens, closes in self.windows if not is_later(time, closes))
        opens = next(open_then, None)
        return None if opens is None else max(time, opens)


class _Way(NamedTuple):
    """A way to drive a route: its visits and breaks, and when a leg that begins at a time ends."""

    stays: list[_Stay]
    arrival: Callable[[int, float], float]
    corners: Callable[[int], list[float]]  # of a leg: see Costs.corners
    begin: float
    last: float


def timelines_of_day(request: Json, clock: Json, vehicle: Json, stops: list[int]) -> list[Timeline]:
    """Return the best times of a route, or none where it cannot be in time.

    Where almost equally good departures are told apart by roundings, or breaks can be taken at
    several places, all of them.

    Args:
        request: The request.
        clock: The item of the costs that are time.
        vehicle: The vehicle, with one `shift` at most.
        stops: The visits, and where it loads again.
    """
    shift_end = span_of({**vehicle, "max_overtime": 0.0})[1]
    found = []
    for ways in _ways(request, clock, vehicle, stops):
        pairs = [(way, first) for way in ways if (first := _driven(way, way.begin)) is not None]
        pairs = [(way, first) for way, first in pairs if not is_later(first.end, way.last)]
        pairs = _least(pairs, lambda pair: (pair[1].end, pair[1].lateness))
        for way, first in pairs:
            early = request.get("leave") == "early"
            found += [first] if early else _best(way, first, shift_end, _changes(clock))
    if request.get("leave") == "early":
        return _least(found, lambda each: (each.end, each.lateness))
    return _least(
        found,
        lambda each: (
            each.lateness,
            max(0.0, each.end - shift_end),
            each.end - each.departure,
        ),
    )


Item = TypeVar("Item")


def _least(items: list[Item], key: Callable[[Item], tuple[float, ...]]) -> list[Item]:
    """Return the items of the least key, up to roundings."""
    for number in range(len(key(items[0])) if items else 0):
        least = min(key(each)[number] for each in items)
        items = [each for each in items if key(each)[number] <= least + 20 * _EQUAL * (1 + least)]
    return items


def _ways(request: Json, clock: Json, vehicle: Json, stops: list[int]) -> Iterator[list[_Way]]:
    """Yield the ways to drive a route after no break, after the first one, and so on."""
    begin, last = span_of(vehicle)
    begin = max(begin, released(request, trips_of(vehicle, stops)[0]))
    ends = [[] if each is None else [each] for each in map(vehicle.get, ("start", "end"))]
    legs = [*pairwise([*ends[0], *stops, *ends[1]])]
    costs: Costs = clock.get("day") or Costs({**clock, "over_the_day": [[0.0, 1.0]]})
    speed = vehicle.get("speed_factor", 1.0)
    of_legs = (
        lambda leg, time: costs.arrival(*legs[leg], time, speed),
        lambda leg: costs.corners(*legs[leg], speed),
    )
    places = places_of(request, clock["matrix"], vehicle, stops, {})
    rests = vehicle.get("breaks", []) if all(places) else []
    for first in range(len(rests) + 1) if all(places) else ():
        if first:
            begin = max(begin, rests[first - 1]["window"][0] + rests[first - 1]["length"])
        found = []
        for after in range(first, len(rests) + 1):
            until = min([last, *(each["window"][1] for each in rests[after:])])
            spots = combinations_with_replacement(range(2 * len(places)), after - first)
            found += [
                _Way(
                    _stays(places, [*zip(each, rests[first:after], strict=True)]),
                    *of_legs,
                    begin,
                    until,
                )
                for each in spots
            ]
        yield found


def _stays(places: list[list[Event]], rests: list[tuple[int, Json]]) -> list[_Stay]:
    """Return the visits and breaks of a route.

    Args:
        places: The visit at each place, once for each window.
        rests: The breaks, each after a number: even ones are before a visit, others after it.
    """
    found = []
    for place, events in enumerate(places):
        windows = [(each.opens, each.closes) for each in events]
        group = [_rest(rest, place) for spot, rest in rests if spot == 2 * place]
        group.append(_Stay(windows, events[0].length, events[0].due, None, place, rests=False))
        group += [_rest(rest, place) for spot, rest in rests if spot == 2 * place + 1]
        found += [group[0]._replace(leg=place - 1 if place else None), *group[1:]]
    return found


def _rest(rest: Json, place: int) -> _Stay:
    return _Stay([tuple(rest["window"])], rest["length"], inf, None, place, rests=True)


def _best(way: _Way, first: Timeline, shift_end: float, changes: list[float]) -> list[Timeline]:
    """Return the times after the best departures, given those after the earliest one."""
    spans = [span for stay in way.stays for span in stay.windows]
    finite = [time for span in spans for time in span if time < inf]
    latest = max(
        [way.begin, first.end, *changes, *finite, *(s.due for s in way.stays if s.due < inf)]
    )
    corners: Corners = [(way.begin, way.begin), (latest, latest)]
    begins = iter(first.begins)
    for stay in way.stays:
        if stay.leg is not None:
            leg = stay.leg
            corners = _through(corners, way.corners(leg), lambda t, leg=leg: way.arrival(leg, t))
        corners = _when_open(_until(corners, stay.windows[-1][1]), stay)
        if not stay.rests:
            corners = _until(corners, max(stay.due, next(begins)))
        corners = [(d, t + stay.length) for d, t in corners]
    corners = _until(corners, min(way.last, max(shift_end, first.end)))
    least = min(end - departure for departure, end in corners)
    slack = _EQUAL * max(1.0, first.end)
    found = [
        _driven(way, min(d for d, end in corners if end - d <= least + share * slack))
        for share in (0.01, 1.0, 10.0)
    ]
    return [each for each in found if each is not None]


def _when_open(corners: Corners, stay: _Stay) -> Corners:
    """Return the corners of when a stay begins, given those of when the vehicle is there.

    After each window but the last, it begins when the next one opens.
    """
    found: Corners = []
    for (opens, closes), after in zip(stay.windows, [*stay.windows[1:], None], strict=True):
        inside = _until(corners, closes)
        found += _through(inside, [opens], lambda t, opens=opens: max(t, opens))
        if after is None or not inside:
            continue
        corners = [inside[-1], *(each for each in corners if each not in inside)]
    return sorted(found)


def _changes(clock: Json) -> list[float]:
    costs: Costs | None = clock.get("day")
    return costs.changes if costs else []


def _driven(way: _Way, departure: float) -> Timeline | None:
    time, lateness, waiting = departure, 0.0, 0.0
    arrivals, begins, rests = dict[int, float](), list[float](), list[float]()
    leaves = dict[int, float]()
    for stay in way.stays:
        if stay.leg is not None:
            time = way.arrival(stay.leg, time)
        arrivals.setdefault(stay.place, time)
        begin = stay.begin(time)
        if begin is None:
            return None
        (rests if stay.rests else begins).append(begin)
        waiting += begin - time
        lateness += begin - stay.due if is_later(begin, stay.due) else 0.0
        time = leaves[stay.place] = begin + stay.length
    places = tuple(arrivals.values()), tuple(rests), tuple(begins), tuple(leaves.values())
    return Timeline(departure, time, lateness, waiting, *places)


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
