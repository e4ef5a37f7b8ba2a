"""Legs over the day, as plans are checked with them: arrivals of all departures at once."""

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay

Array = NDArray[np.float64]


class DayLeg:
    """The way between two stops over the day.

    Within a slice a vehicle drives at the speed of that slice. So the share of the way that it has
    driven since the first slice ended is a piecewise linear function of the time, and it arrives
    when this has grown by 1.

    Args:
        begins: When each slice but the first begins, shape (s - 1,).
        seconds: How long the way takes at the speed of each slice, shape (s,).
    """

    def __init__(self, begins: Array, seconds: Array) -> None:
        differs = np.flatnonzero(np.diff(seconds))
        self.begins = begins[differs]
        self._seconds = seconds[[0, *(differs + 1)]]

    @cached_property
    def _shares(self) -> Array:
        """The shares of the way driven until each of the begins, shape (s - 1,)."""
        spent = np.diff(self.begins) / self._seconds[1:-1]
        return np.concatenate(([0.0], np.cumsum(spent)))

    @cached_property
    def changes(self) -> Array:
        """The arrivals at which it becomes slower or faster to arrive later."""
        if self._seconds.all():
            return self.begins
        # Where all of the way takes no time in a slice, who leaves just before waits for it.
        return np.concatenate((self.begins, np.nextafter(self.begins, -np.inf)))

    def arrivals(self, times: Array) -> Array:
        """Return when who leaves at these times arrives."""
        if not len(self.begins):
            return times + self._seconds[0]
        if not self._seconds.all():
            return np.array([self.arrival(time) for time in times.tolist()])
        return self._times(self._shares_at(times) + 1.0)

    def departures(self, arrivals: Array) -> Array:
        """Return when who arrives at these times has left."""
        if not len(self.begins):
            return arrivals - self._seconds[0]
        if not self._seconds.all():
            return np.array([self._departure(time) for time in arrivals.tolist()])
        return self._times(self._shares_at(arrivals) - 1.0)

    def _shares_at(self, times: Array) -> Array:
        begins, seconds, shares = self.begins, self._seconds, self._shares
        found = np.interp(times, begins, shares)
        found += np.minimum(times - begins[0], 0.0) / seconds[0]
        found += np.maximum(times - begins[-1], 0.0) / seconds[-1]
        return found

    def _times(self, shares_at: Array) -> Array:
        begins, seconds, shares = self.begins, self._seconds, self._shares
        found = np.interp(shares_at, shares, begins)
        found += np.minimum(shares_at, 0.0) * seconds[0]
        found += np.maximum(shares_at - shares[-1], 0.0) * seconds[-1]
        return found

    def arrival(self, time: float) -> float:
        """Return when who leaves at a time arrives, slice by slice."""
        left = 1.0
        first = int(np.searchsorted(self.begins, time, "right"))
        slices = self.begins[first:].tolist(), self._seconds[first:-1].tolist()
        for ends, seconds in zip(*slices, strict=True):
            if time + left * seconds <= ends:
                return time + left * seconds
            left -= (ends - time) / seconds
            time = ends
        return time + left * float(self._seconds[-1])

    def _departure(self, time: float) -> float:
        left = 1.0
        first = int(np.searchsorted(self.begins, time, "left"))
        slices = self.begins[:first][::-1].tolist(), self._seconds[first:0:-1].tolist()
        for begins, seconds in zip(*slices, strict=True):
            if time - left * seconds >= begins:
                return time - left * seconds
            left -= (time - begins) / seconds
            time = begins
        return time - left * float(self._seconds[0])


class LegByBreakpoints:
    """The way between two stops by breakpoints.

    Args:
        times: When they begin, shape (k,), ascending.
        seconds: How long the way takes then, shape (k,). Who leaves later never arrives earlier.
    """

    def __init__(self, times: Array, seconds: Array) -> None:
        self._leaves, self._seconds = times, seconds
        self.changes = np.maximum.accumulate(times + seconds)
        """The arrivals at which it becomes slower or faster to arrive later."""

    def arrivals(self, times: Array) -> Array:
        """Return when who leaves at these times arrives."""
        return times + np.interp(times, self._leaves, self._seconds)

    def departures(self, arrivals: Array) -> Array:
        """Return when who arrives at these times has left at the latest."""
        first, last = self.changes[[0, -1]]
        found: Array = np.interp(arrivals, self.changes, self._leaves)
        found += np.minimum(arrivals - first, 0.0) + np.maximum(arrivals - last, 0.0)
        return found

    def arrival(self, time: float) -> float:
        """Return when who leaves at a time arrives."""
        return time + float(np.interp(time, self._leaves, self._seconds))


Leg = DayLeg | LegByBreakpoints


def leg_of(costs: CostsOfDay, a: int, b: int, speed: float = 1.0) -> Leg:
    """Return the leg between two stops, as a vehicle of a speed drives it."""
    if costs.pairs is not None and costs.pairs.has(a, b):
        times, seconds = costs.pairs.of(a, b)
        return LegByBreakpoints(times, seconds / speed)
    seconds = costs.factors * costs.matrices[costs.layers, a, b] / speed
    if np.isinf(seconds).any():  # there is no way
        return DayLeg(np.empty(0), seconds[:1])
    return DayLeg(costs.begins[1:], seconds)


STILL = DayLeg(np.empty(0), np.zeros(1))  # between a stop and a break there
