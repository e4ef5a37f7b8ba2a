"""Bounds on the times of routes with one more stop, at all its places and in all slots at once.

They leave out breaks and the order's release, so no route is done earlier than they say, and none
that they call too late is in time. What they let through is judged one by one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Array
from service.fleet.plans import Route, path_of
from service.fleet.schedule import trips_of
from service.fleet.vehicles import Span, Visit
from service.offers.places import Places
from service.offers.slots import SlottedFleet


@dataclass(frozen=True, eq=False)
class Bounds:
    """What is known of the routes with the order at each of p places, in each of s slots.

    Attributes:
        late: By how much the route is late or too long at least, shape (p, s); 0 where it may be
            neither.
        duration: The least time of the route, shape (p, s).
        lateness: The least sum of times by which visits begin after they are due, shape (p, s).
        end: The earliest end, shape (p, s).
    """

    late: Array
    duration: Array
    lateness: Array
    end: Array


@dataclass(frozen=True, eq=False)
class _Path:
    """The stops of a route with its ends, and what is known of it without the order.

    Attributes:
        stops: The stops, the start and the end included.
        first: The number of stops before the first place: 1 with a start, else 0.
        legs: The times between these stops.
        windows: When each visit may begin.
        visits: What each stop asks for.
        begins: The earliest begin at each stop.
        late: By how much the route is late at least up to each stop.
        lateness: The sum of the times after stops are due, up to each stop.
        reached: The time of legs and visits before each stop.
        departures: The latest departure that keeps the windows up to each stop.
    """

    stops: tuple[int, ...]
    first: int
    legs: list[float]
    windows: list[tuple[Span, ...]]
    visits: list[Visit]
    begins: list[float]
    late: list[float]
    lateness: list[float]
    reached: list[float]
    departures: list[float]


def bounds(slotted: SlottedFleet, places: Places) -> Bounds:
    """Return bounds on the routes with the order at each place, in each slot.

    The fleet has a clock.
    """
    return _Screen(slotted, places).bounds()


class _Screen:
    """The bounds for one sequence of stops. Rows are places, columns are slots."""

    def __init__(self, slotted: SlottedFleet, places: Places) -> None:
        rules = slotted.fleet.rules
        assert rules.clock is not None
        self._fleet, self._rules = slotted.fleet, rules
        self._order, self._visit = slotted.order, rules.visits[slotted.order]
        self._kind, self._vehicle = places.vehicle, rules.vehicles[places.vehicle]
        self._lenient = slotted.lenient
        self._opens, closes = np.array(slotted.slots, np.float64).T
        self._closes = closes - rules.slack
        self._path = self._known(places)
        self._places = np.array(places.places) + self._path.first

    def bounds(self) -> Bounds:
        """Return the bounds."""
        path, places = self._path, self._places
        to, back = self._legs_to(places - 1), self._legs_from(places)
        begin, late, lateness = self._visited(to)
        reached = self._reached(places) + to
        arrival = begin + self._serving(self._visit)
        end, late, lateness = self._driven(arrival, back, late, lateness)
        replaced = np.array([path.legs[i - 1] if 0 < i < len(path.stops) else 0.0 for i in places])
        longer = to + back + self._serving(self._visit) - replaced
        own = path.reached[-1] + self._service(-1) if path.stops else 0.0
        total = own + longer
        departure = self._departures(places, longer, reached, total)
        waited = np.where(np.isfinite(departure), end - departure, 0.0)
        duration = np.maximum(waited, total[:, np.newaxis] + self._rests(departure, end))
        if self._rules.limited == self._rules.clock:
            late = np.maximum(late, duration - self._vehicle.longest)
        late = np.where(late > self._lenient, late, 0.0)
        return Bounds(late, duration, lateness, end)

    def _known(self, places: Places) -> _Path:
        """Return the path without the order. Forbidden legs count as 0: the judge forbids them."""
        route = Route(places.vehicle, places.stops)
        stops = path_of(self._rules, route)
        first = 0 if self._vehicle.start is None else 1
        legs = [self._leg(a, b) for a, b in pairwise(stops)]
        visits = [self._rules.visits[stop] for stop in stops]
        windows = [self._rules.windows[stop] for stop in stops]
        released = self._released(route)
        for place, stop in enumerate(places.stops):
            if stop in self._vehicle.reload:
                windows[first + place] = ((released[place], inf),)
        spent = [self._serving(visit) + leg for visit, leg in zip(visits, legs, strict=False)]
        reached = list(accumulate(spent, initial=0.0))[: len(stops)]
        closing = (each[-1][1] - at for each, at in zip(windows, reached, strict=True))
        departures = list(accumulate(closing, min))
        begins, late, lateness = self._forward(visits, windows, legs, released.get(-1, 0.0))
        return _Path(
            stops, first, legs, windows, visits, begins, late, lateness, reached, departures
        )

    def _released(self, route: Route) -> dict[int, float]:
        """Return when the load of each trip is released, by the place where it is loaded.

        The first trip begins at place -1.
        """
        trips = trips_of(self._rules, route)
        visits = self._rules.visits
        loads = [max((visits[stop].release for stop in trip), default=0.0) for trip in trips]
        reload = self._vehicle.reload
        at = [-1, *(place for place, stop in enumerate(route.stops) if stop in reload)]
        return dict(zip(at, loads, strict=True))

    def _forward(
        self,
        visits: Sequence[Visit],
        windows: Sequence[tuple[Span, ...]],
        legs: Sequence[float],
        released: float,
    ) -> tuple[list[float], list[float], list[float]]:
        """Return the earliest begins along a path, and how late it is up to each stop."""
        time, late, lateness = max(self._vehicle.way[0], released), 0.0, 0.0
        self._departs = time
        found: tuple[list[float], list[float], list[float]] = ([], [], [])
        for visit, spans, leg in zip(visits, windows, [*legs, 0.0], strict=False):
            begin = next((max(time, a) for a, b in spans if time <= b + self._lenient), time)
            late = max(late, time - spans[-1][1])
            lateness += max(0.0, begin - visit.due)
            for values, value in zip(found, (begin, late, lateness), strict=True):
                values.append(value)
            time = begin + self._serving(visit) + leg
        return found

    def _leg(self, a: int, b: int) -> float:
        assert self._rules.clock is not None
        leg = self._fleet.leg(self._rules.clock, a, b, self._kind)
        leg /= self._vehicle.speed_factor
        return leg if isfinite(leg) else 0.0

    def _legs_to(self, before: NDArray[np.int64]) -> Array:
        """Return the legs from the stops before to the order, shape (p,); 0 where none is."""
        stops = self._path.stops
        return np.array([self._leg(stops[i], self._order) if i >= 0 else 0.0 for i in before])

    def _legs_from(self, after: NDArray[np.int64]) -> Array:
        stops = self._path.stops
        n = len(stops)
        return np.array([self._leg(self._order, stops[i]) if i < n else 0.0 for i in after])

    def _service(self, at: int) -> float:
        return self._serving(self._path.visits[at])

    def _serving(self, visit: Visit) -> float:
        """Return how long the vehicle takes for a visit."""
        return visit.service_by(self._kind) * self._vehicle.service_factor

    def _reached(self, places: NDArray[np.int64]) -> Array:
        """Return the time of legs and visits before the leg to the order, shape (p,)."""
        reached = self._path.reached
        return np.array([reached[i - 1] + self._service(i - 1) if i else 0.0 for i in places])

    def _visited(self, to: Array) -> tuple[Array, Array, Array]:
        """Return the begin of the visit to the order, and how late the route is by then."""
        path, places = self._path, self._places
        before = [i - 1 for i in places]
        leaves = [path.begins[i] + self._service(i) if i >= 0 else self._departs for i in before]
        arrival = (np.array(leaves) + to)[:, np.newaxis]
        begin = np.maximum(arrival, self._opens)
        late = np.array([path.late[i] if i >= 0 else 0.0 for i in before])[:, np.newaxis]
        lateness = np.array([path.lateness[i] if i >= 0 else 0.0 for i in before])[:, np.newaxis]
        lateness = lateness + np.maximum(begin - self._visit.due, 0.0)
        return begin, np.maximum(late, arrival - self._closes), lateness

    def _driven(
        self, time: Array, back: Array, late: Array, lateness: Array
    ) -> tuple[Array, Array, Array]:
        """Return the end of each route, how late it is, and its lateness, from the order on."""
        path, places = self._path, self._places
        for at in range(path.first, len(path.stops)):
            rows = int(np.searchsorted(places, at, "right"))  # with the order before this stop
            if not rows:
                continue
            leg = path.legs[at - 1] if at else 0.0
            steps = np.where(places[:rows] == at, back[:rows], leg)[:, np.newaxis]
            arrival = time[:rows] + steps
            begin = _opened(arrival, path.windows[at], self._lenient)
            late[:rows] = np.maximum(late[:rows], arrival - path.windows[at][-1][1])
            lateness[:rows] += np.maximum(begin - path.visits[at].due, 0.0)
            time[:rows] = begin + self._service(at)
        return time, np.maximum(late, time - self._vehicle.way[1]), lateness

    def _departures(
        self, places: NDArray[np.int64], longer: Array, reached: Array, total: Array
    ) -> Array:
        """Return the latest departure that keeps all windows, shape (p, s)."""
        path, vehicle = self._path, self._vehicle
        before = np.array([path.departures[i - 1] if i else inf for i in places])
        closing = [each[-1][1] - at for each, at in zip(path.windows, path.reached, strict=True)]
        later = list(accumulate([inf, *reversed(closing)], min))[::-1]  # from each stop on
        after = np.array([later[i] for i in places]) - longer
        bound = np.minimum(np.minimum(before, after), vehicle.way[1] - total)
        bound = np.minimum(bound, vehicle.leaves_by)
        return np.minimum(bound[:, np.newaxis], self._closes - reached[:, np.newaxis])

    def _rests(self, departure: Array, end: Array) -> Array:
        """Return the time of the breaks that come while the vehicle is on its way for certain."""
        rests = np.zeros(end.shape)
        for opens, closes, length in self._vehicle.breaks:
            rests += np.where((departure < opens) & (end > closes), length, 0.0)
        return rests


def _opened(time: Array, windows: Sequence[Span], lenient: float) -> Array:
    """Return the first times, from these on, at which a window is open; else the times."""
    if len(windows) == 1:
        return np.maximum(time, windows[0][0])
    opens, closes = np.array(windows).T
    number = np.minimum(np.searchsorted(closes + lenient, time), len(windows) - 1)
    return np.maximum(time, opens[number])
