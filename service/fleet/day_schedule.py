"""The times of a route over the day: its best departure, and when its vehicle arrives and waits.

A vehicle leaves when its route takes the least time, as early as that may be. But it does not leave
so late that it misses a window, that visits begin later after they are due, or that it ends later
after its shift, than if it left as early as it may.

The time that a route takes is a piecewise linear function of its departure. So it is least where
something changes on the way: where a slice of the day begins as the vehicle leaves or arrives, or
where a window opens or closes. These times are followed back to the departures that lead to them,
and all of these are tried.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.breaks import Placed, Stay, with_breaks
from service.fleet.day_legs import STILL, Array, Leg
from service.fleet.rounding import ROUNDING, excess, is_over
from service.fleet.times import Schedule
from service.fleet.vehicles import Break, VehicleType

_EQUAL = 10 * ROUNDING  # durations that differ by less, relative to the end, count as equal


class _Chain(NamedTuple):
    """A route whose breaks, if it has any, are stays.

    Attributes:
        stays: What is asked for at each of the m places.
        legs: The m - 1 legs between them.
        begin: The earliest departure.
        leaves_by: The latest departure.
        last: The latest end.
        shift_end: The end of the shift, after which a route has overtime.
    """

    stays: Sequence[Stay]
    legs: Sequence[Leg]
    begin: float
    leaves_by: float
    last: float
    shift_end: float


def times_over_the_day(
    legs: Sequence[Leg],
    stays: Sequence[Stay],
    begin: float,
    vehicle: VehicleType,
    early: bool,
) -> Schedule:
    """Return the times of a route that leaves at its best departure, or as early as it may.

    Breaks are taken where it ends as early as possible if it leaves as early as it may. Without a
    place for a break it is late by inf.

    Args:
        legs: The m - 1 legs.
        stays: What is asked for at each of the m places.
        begin: The earliest departure.
        vehicle: The vehicle.
        early: Whether it leaves as early as it may.
    """
    chain = _Chain(stays, legs, begin, vehicle.leaves_by, vehicle.way[1], vehicle.shift[1])
    if not vehicle.breaks:
        return _best_times(chain, early)
    found = list(_with_breaks(chain, vehicle.breaks, early))
    if not found:
        plain = _best_times(chain, early)
        return replace(plain, late=plain.late or inf)
    if early:
        return min(found, key=lambda times: (times.end, times.lateness))
    shift_end = vehicle.shift[1]
    return min(found, key=lambda t: (t.lateness, excess(t.end, shift_end), t.duration))


def _best_times(chain: _Chain, early: bool) -> Schedule:
    """Return the times after the best departure; if no departure is in time, the earliest."""
    first = _times_from(chain, chain.begin)
    if is_over(chain.begin, chain.leaves_by):
        return replace(first, late=max(first.late, chain.begin - chain.leaves_by))
    if first.late or early:
        return first
    departure = _best_departure(chain, first)
    return first if departure == chain.begin else _times_from(chain, departure, first.end)


def _times_from(chain: _Chain, departure: float, reach: float = 0.0) -> Schedule:
    """Return the times of a route that leaves at a time.

    `reach` is the largest time from which the departure was computed.
    """
    time, waiting, late, lateness = departure, 0.0, 0.0, 0.0
    arrivals, used, begins, leaves = [], [], [], []
    for place, (windows, service, due, _) in enumerate(chain.stays):
        number = 0
        while number + 1 < len(windows) and is_over(time, windows[number][1], reach):
            number += 1
        opens, closes = windows[number]
        late = max(late, excess(time, closes, reach))
        begin = max(time, opens)
        waiting += begin - time
        lateness += excess(begin, due, reach)
        arrivals.append(time)
        used.append(number)
        begins.append(begin)
        leaves.append(begin + service)
        if place < len(chain.legs):
            time = chain.legs[place].arrival(begin + service)
    end = leaves[-1]
    late = max(late, excess(end, chain.last, reach))
    rows = tuple(begins), (), tuple(leaves)
    return Schedule(tuple(arrivals), end, late, waiting, 0.0, lateness, tuple(used), -1, *rows)


def _best_departure(chain: _Chain, first: Schedule) -> float:
    """Return the earliest departure of least duration, given the times after the earliest."""
    tried = _candidates(chain, first)
    ends, late, lateness = _ends(chain, tried, first.end)
    bound = max(chain.shift_end, first.end)
    slack = _EQUAL * first.end
    allowed = ~late & (lateness <= first.lateness + slack) & (ends <= bound + slack)
    durations = np.where(allowed, ends - tried, inf)
    best = int(np.argmax(durations <= durations.min() + _EQUAL * first.end))
    return float(tried[best])


def _candidates(chain: _Chain, first: Schedule) -> Array:
    """Return the departures after which something changes on the way, ascending."""
    times = np.array([chain.last, max(chain.shift_end, first.end)])  # when the last visit ends
    for place in range(len(chain.stays) - 1, -1, -1):
        windows, service, due, _ = chain.stays[place]
        if place < len(chain.legs):
            leg = chain.legs[place]
            times = np.concatenate(
                (leg.departures(np.concatenate((times, leg.changes))), leg.changes)
            )
        bounds = [time for window in windows for time in window]
        times = np.concatenate((times - service, bounds, [due, max(due, first.begins[place])]))
        times = times[(times > first.arrivals[place]) & (times <= chain.last)]
        times = np.unique(times)
    inside = times[(times > chain.begin) & (times < chain.leaves_by)]
    ends = [chain.begin, *([chain.leaves_by] if chain.leaves_by < inf else [])]
    return np.unique(np.concatenate((ends, inside)))


def _ends(chain: _Chain, departures: Array, reach: float) -> tuple[Array, NDArray[np.bool_], Array]:
    """Return when routes end that leave at these times, whether they are late, and how late."""
    time = departures
    late = np.zeros(len(time), np.bool_)
    lateness = np.zeros(len(time))
    slack = ROUNDING * reach
    for place, (windows, service, due, _) in enumerate(chain.stays):
        (opens, closes), *others = windows
        begin = np.maximum(time, opens)
        for later_opens, later_closes in others:
            begin = np.where(time > closes + slack, np.maximum(time, later_opens), begin)
            closes = later_closes
        late |= time > closes + slack
        if due < inf:
            lateness += np.maximum(0.0, begin - due)
        time = begin + service
        if place < len(chain.legs):
            time = chain.legs[place].arrivals(time)
    return time, late | (time > chain.last + slack), lateness


def _with_breaks(chain: _Chain, breaks: Sequence[Break], early: bool) -> Iterator[Schedule]:
    """Yield the best times with some breaks before the departure and others on the way."""
    begin = chain.begin
    for taken in range(len(breaks) + 1):
        if taken:
            opens, _, length = breaks[taken - 1]
            begin = max(begin, opens + length)
        if is_over(begin, chain.leaves_by):
            return
        placed = _placed(chain, breaks, taken, begin)
        if placed is None:
            continue
        after = taken + len(placed)
        last = min(chain.last, breaks[after][1]) if after < len(breaks) else chain.last
        stays, legs, begins, places = with_breaks(chain.stays, chain.legs, breaks, placed, STILL)
        whole = _Chain(stays, legs, begin, chain.leaves_by, last, chain.shift_end)
        times = _best_times(whole, early)
        rests = [place for place in range(len(stays)) if place not in places]
        leaving = [*(place - 1 for place in begins[1:]), len(stays) - 1]
        yield replace(
            times,
            arrivals=tuple(times.arrivals[place] for place in begins),
            windows=tuple(times.windows[place] for place in places),
            begins=tuple(times.begins[place] for place in places),
            breaks=tuple(times.begins[place] for place in rests),
            leaves=tuple(times.leaves[place] for place in leaving),
        )


class _State(NamedTuple):
    """A way to be at a place with some of the breaks taken: the earliest time, and how late."""

    time: float
    lateness: float
    placed: tuple[Placed, ...]


def _placed(
    chain: _Chain, breaks: Sequence[Break], taken: int, departure: float
) -> tuple[Placed, ...] | None:
    """Return where the breaks after the first `taken` are taken for the earliest end.

    Of these, where visits are the least late; None if a break fits nowhere.
    """
    states: list[list[_State]] = [[] for _ in range(len(breaks) + 1)]
    states[taken].append(_State(departure, 0.0, ()))
    for place, stay in enumerate(chain.stays):
        _rest(states, breaks, place, after=False)
        states = [_kept(_served(each, stay)) for each in states]
        _rest(states, breaks, place, after=True)
        if place < len(chain.legs):
            leg = chain.legs[place]
            states = [[each._replace(time=leg.arrival(each.time)) for each in s] for s in states]
    ended = [
        each
        for (closes, found) in zip([*(b[1] for b in breaks), inf], states, strict=True)
        for each in found
        if not is_over(each.time, min(chain.last, closes))
    ]
    return min(ended, key=lambda each: each[:2]).placed if ended else None


def _rest(states: list[list[_State]], breaks: Sequence[Break], place: int, *, after: bool) -> None:
    """Let the vehicle take one break after another at a place."""
    for number, (opens, closes, length) in enumerate(breaks):
        rested = [
            _State(
                max(each.time, opens) + length,
                each.lateness,
                (*each.placed, Placed(number, place, after)),
            )
            for each in states[number]
            if not is_over(each.time, closes)
        ]
        states[number + 1] = _kept([*states[number + 1], *rested])


def _served(states: Sequence[_State], stay: Stay) -> list[_State]:
    """Return the states after a visit in the first window that is not over."""
    found = []
    for time, lateness, placed in states:
        opens = next((a for a, b in stay.windows if not is_over(time, b)), None)
        if opens is not None:
            begin = max(time, opens)
            late = lateness + excess(begin, stay.due)
            found.append(_State(begin + stay.service, late, placed))
    return found


def _kept(states: Sequence[_State]) -> list[_State]:
    """Return the states that no other is as good as, by ascending time."""
    kept: list[_State] = []
    for each in sorted(states, key=lambda state: state[:2]):
        if not kept or each.lateness < kept[-1].lateness:
            kept.append(each)
    return kept
