"""When a vehicle leaves and arrives on a route, found by trying every window and place of a break.

Nothing here is the service's: the guide says when a vehicle leaves, waits, rests and is late.
"""

from collections.abc import Iterator
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

TOLERANCE = 1e-9  # of the largest time

Json = dict[str, Any]
Bounds = dict[int, tuple[float, float]]  # by stop: from when on a visit begins, and its hold


class Event(NamedTuple):
    """A visit or a break: when it may begin, how long it takes, and the way before it."""

    opens: float
    closes: float
    length: float
    due: float
    leg: float
    stop: int  # the place in the route; for a break -1, or -2 after the visit at a place
    hold: float = inf  # until when it begins, so that no visit of another route is later for it


class Timeline(NamedTuple):
    """The times of a route."""

    departure: float
    end: float
    lateness: float
    waiting: float
    arrivals: tuple[float, ...]
    breaks: tuple[float, ...]
    begins: tuple[float, ...]  # of the visits
    leaves: tuple[float, ...] = ()  # over the day, when it leaves each place


def is_later(a: float, b: float) -> bool:
    """Return whether a time is later than another by more than a rounding."""
    return a - b > TOLERANCE * max(1e-6, abs(a), 0.0 if b == inf else abs(b))


def span_of(vehicle: Json) -> tuple[float, float]:
    """Return the earliest departure and the latest end of a vehicle, given with its shift."""
    begin, end = vehicle.get("shift") or (0.0, inf)
    return begin, end + vehicle.get("max_overtime", 0.0)


def trips_of(vehicle: Json, stops: list[int]) -> list[list[int]]:
    """Return the visits from one loading to the next."""
    trips: list[list[int]] = [[]]
    for stop in stops:
        if stop in vehicle.get("reload", ()):
            trips.append([])
        else:
            trips[-1].append(stop)
    return trips


def best_timelines(
    request: Json, times: Any, vehicle: Json, stops: list[int], bounds: Bounds
) -> list[Timeline]:
    """Return the best times of a route by the clock, or none where it cannot be in time.

    They end as early as possible, then are the least late, then leave as late as possible, or as
    early where the request says so.

    Args:
        request: The request, whose references to stops are numbers.
        times: The costs that are time.
        vehicle: The vehicle, with one `shift` at most.
        stops: The visits, and where it loads again.
        bounds: Of the visits that wait for others, and of those that others wait for.
    """
    begin, last = span_of(vehicle)
    trips = trips_of(vehicle, stops)
    begin = max(begin, released(request, trips[0]))
    rests, early = vehicle.get("breaks", []), request.get("leave") == "early"
    places = places_of(request, times, vehicle, stops, bounds)
    if not all(places):  # a window that is over before the day begins
        return []
    found, soonest = list[Timeline](), [inf] * len(places)
    for first in range(len(rests) + 1):
        if first:
            opens, length = rests[first - 1]["window"][0], rests[first - 1]["length"]
            begin = max(begin, opens + length)
        for after in range(first, len(rests) + 1):
            until = min([last, *(each["window"][1] for each in rests[after:])])
            for events in _ways(places, rests[first:after], [], begin):
                timeline = _timed(events, begin, until, early)
                if timeline is None:
                    continue
                found.append(timeline)
                earliest = _timed(events, begin, until, early=True) if bounds else timeline
                soonest = [*map(min, soonest, earliest.begins)]
    if not found:
        return []
    holds = [max(a, each[0].hold) for a, each in zip(soonest, places, strict=True)]
    found = [each for each in found if not any(map(is_later, each.begins, holds))]
    end = min(each.end for each in found)
    found = [each for each in found if not is_later(each.end, end)]
    lateness = min(each.lateness for each in found)
    rounding = TOLERANCE * max(1.0, end)
    found = [each for each in found if each.lateness <= lateness + rounding]
    departures = [each.departure for each in found]
    departure = min(departures) if early else max(departures)
    return [each for each in found if abs(each.departure - departure) <= rounding]


def released(request: Json, trip: list[int]) -> float:
    return max((request["stops"][stop].get("release", 0.0) for stop in trip), default=0.0)


def places_of(
    request: Json, times: Any, vehicle: Json, stops: list[int], bounds: Bounds
) -> list[list[Event]]:
    """Return the visit at each place of a route, once for each window."""
    start, end = vehicle.get("start"), vehicle.get("end")
    path = [*([] if start is None else [start]), *stops, *([] if end is None else [end])]
    speed = vehicle.get("speed_factor", 1.0)
    legs = [0.0, *(times[a][b] / speed for a, b in pairwise(path))]
    found = []
    for place, stop in enumerate(path):
        visit = request["stops"][stop]
        due = visit.get("due", inf)
        latest = due[1] if isinstance(due, list) else due
        rest = (service_of(visit, vehicle), latest, legs[place], place)
        since, hold = bounds.get(stop, (0.0, inf))
        windows = _windows(request, vehicle, stops, path, place)
        open_then = [each for each in windows if not is_later(since, each[1])]
        found.append([Event(max(a, since), b, *rest, hold) for a, b in open_then])
    return found


def service_of(visit: Json, vehicle: Json) -> float:
    """Return how long a vehicle takes to visit a stop."""
    own = {each["vehicle"]: each["service"] for each in visit.get("services", ())}
    service = own.get(vehicle["id"], visit.get("service", 0.0))
    return float(service * vehicle.get("service_factor", 1.0))


def _ways(
    places: list[list[Event]], rests: list[Json], events: list[Event], time: float
) -> Iterator[list[Event]]:
    """Yield the visits and breaks of a route in every window, with breaks at every place.

    Args:
        places: The visits left.
        rests: The breaks left.
        events: What came before, until `time` at the earliest.
        time: The earliest time.
    """
    before = bool(events) and events[-1].stop == -1
    if rests and places:  # before a visit
        leg = 0.0 if before else places[0][0].leg
        yield from _after(Event(*_rest(rests[0]), leg, -1), places, rests[1:], events, time)
    for visit in places[0] if places else ():
        event = visit._replace(leg=0.0) if before else visit
        yield from _after(event, places[1:], rests, events, time)
    if rests and events and not before:  # after a visit
        yield from _after(Event(*_rest(rests[0]), 0.0, -2), places, rests[1:], events, time)
    if not places and not rests:
        yield events


def _rest(rest: Json) -> tuple[float, float, float, float]:
    return (*rest["window"], rest["length"], inf)


def _after(
    event: Event, places: list[list[Event]], rests: list[Json], events: list[Event], time: float
) -> Iterator[list[Event]]:
    """Yield the ways to go on after an event, if it is in time."""
    time += event.leg
    if not is_later(time, event.closes):
        ends = max(time, event.opens) + event.length
        yield from _ways(places, rests, [*events, event], ends)


def _windows(
    request: Json, vehicle: Json, stops: list[int], path: list[int], place: int
) -> list[tuple[float, float]]:
    """Return when the visit at a place may begin: one of these."""
    stop, first = path[place], vehicle.get("start") is not None
    if stop in vehicle.get("reload", ()) and 0 <= place - first < len(stops):
        trip = trips_of(vehicle, stops[place - first + 1 :])[0]
        return [(released(request, trip), inf)]
    visit, slack = request["stops"][stop], request.get("slack", 0.0)
    one = [visit["window"]] if visit.get("window") else []
    return [(a, b - slack) for a, b in visit.get("windows") or one] or [(0.0, inf)]


def _timed(events: list[Event], begin: float, last: float, early: bool) -> Timeline | None:
    """Return the times with the earliest end and then the latest departure, or None.

    If `early`, it is the first departure.
    """
    earliest = _forward(events, begin)
    if earliest is None:
        return None
    begins, end = earliest
    if is_later(end, last):
        return None
    latest = end
    for event, started in zip(reversed(events), reversed(begins), strict=True):
        latest = min(latest - event.length, event.closes, max(min(event.due, event.hold), started))
        latest -= event.leg
    departure = begin if early else max(begin, latest)
    again = _forward(events, departure)
    assert again is not None
    begins, end = again
    return _timeline(events, begins, departure, end)


def _forward(events: list[Event], departure: float) -> tuple[list[float], float] | None:
    time, begins = departure, []
    for event in events:
        time += event.leg
        if is_later(time, event.closes):
            return None
        time = max(time, event.opens)
        begins.append(time)
        time += event.length
    return begins, time


def _timeline(events: list[Event], begins: list[float], departure: float, end: float) -> Timeline:
    lateness = sum(
        begin - event.due
        for event, begin in zip(events, begins, strict=True)
        if is_later(begin, event.due)
    )
    arrivals, rests, waiting, time = list[float](), list[float](), 0.0, departure
    arrived: float | None = None
    for event, begin in zip(events, begins, strict=True):
        here = time + event.leg
        waiting += begin - here
        if event.stop < 0:
            rests.append(begin)
        if event.stop == -1 and arrived is None:
            arrived = here
        if event.stop >= 0:
            arrivals.append(here if arrived is None else arrived)
            arrived = None
        time = begin + event.length
    pairs = zip(events, begins, strict=True)
    of_visits = tuple(begin for event, begin in pairs if event.stop >= 0)
    return Timeline(departure, end, lateness, waiting, tuple(arrivals), tuple(rests), of_visits)
