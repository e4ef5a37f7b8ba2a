"""Take the breaks of a vehicle on its route so that it is done as early as possible."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import accumulate
from math import inf
from typing import NamedTuple

from service.fleet.day_legs import STILL, Leg
from service.fleet.rounding import excess, is_over
from service.fleet.times import Chain, Schedule, Stay
from service.fleet.vehicles import ALWAYS, Break

_ALWAYS = (ALWAYS,)


class _Placed(NamedTuple):
    """A break on the way: at a place of the route, before or after the visit there."""

    number: int
    place: int
    after: bool


class _Way(NamedTuple):
    """A way to take breaks: some before the earliest departure, and others on the route."""

    begin: float
    last: float  # the latest end
    placed: tuple[_Placed, ...]


def with_breaks(
    chain: Chain, breaks: Sequence[Break], timed: Callable[[Chain], Schedule]
) -> Schedule:
    """Return the times of a route with breaks; late by inf without a place for one.

    A vehicle takes its breaks in order, between two visits, and none while it drives. A break that
    can be taken before the departure, or after the end, is not on the way.

    Args:
        chain: The route without its k breaks.
        breaks: The breaks, by ascending time.
        timed: Returns the times of a route whose breaks are stays.
    """
    ways = _ways_over_the_day(chain, breaks) if chain.over_the_day else _ways(chain, breaks)
    found = [_times_of(way, chain, breaks, timed) for way in ways]
    if not found:
        plain = timed(chain)
        return replace(plain, late=plain.late or inf)
    shift_end = chain.shift_end
    if chain.early:
        return _least(found, lambda times: (times.end, times.lateness))
    return _least(found, lambda t: (t.lateness, excess(t.end, shift_end), t.duration))


def _least(found: Sequence[Schedule], key: Callable[[Schedule], Sequence[float]]) -> Schedule:
    """Return the times of the least key, whose numbers are equal if they differ by a rounding."""
    reach = max(each.end for each in found)
    for number in range(len(key(found[0]))):
        least = min(key(each)[number] for each in found)
        found = [each for each in found if not is_over(key(each)[number], least, reach)]
    return found[0]


class _State(NamedTuple):
    """A way to be at a place of the route, with some of the breaks taken.

    Attributes:
        time: The earliest time.
        lateness: The sum of the times by which visits begin after they are due.
        work: How long the legs, visits and breaks since the departure take.
        latest: The latest departure that makes no visit or break so far too late, or later than
            due.
        departure: The earliest departure.
        placed: The breaks taken on the way.

    Over the day a state has left at a known time: then no other one leaves later.
    """

    time: float
    lateness: float
    work: float
    latest: float
    departure: float
    placed: tuple[_Placed, ...]

    def dominates(self, other: "_State") -> bool:
        """Return whether no way to go on from here ends better after the other state."""
        time = self.time
        return (
            time <= other.time
            and not excess(self.lateness, other.lateness, time)
            and not excess(self.work, other.work, time)
            and not excess(other.latest, self.latest, time)
        )


def _ways(chain: Chain, breaks: Sequence[Break]) -> Iterator[_Way]:
    """Yield a way to take breaks with which a route ends as early as possible, if they fit.

    Among the ways to end then, it is one of the least lateness; among these, one that allows to
    leave the latest, or if the vehicle leaves early, the earliest.
    """
    states = [_departing(chain, begin) for begin in _begins(chain, breaks)]
    if not (ended := _ended(chain, breaks, states)):
        return
    end = min(state.time for state in ended)
    best = max(_soonest(ended), key=lambda state: min(state.latest, end - state.work))
    yield _Way(best.departure, chain.last, best.placed)


def _ways_over_the_day(chain: Chain, breaks: Sequence[Break]) -> Iterator[_Way]:
    """Yield ways to take breaks, some before the departure and others on the way.

    These are taken where the route ends as early as possible if it leaves as early as it may, and
    of these where visits are the least late.
    """
    for taken, begin in enumerate(_begins(chain, breaks)):
        if is_over(begin, chain.leaves_by):
            return
        states: list[list[_State]] = [[] for _ in range(len(breaks) + 1)]
        states[taken].append(_State(begin, 0.0, 0.0, -inf, begin, ()))
        if ended := _ended(chain, breaks, states):
            placed = _soonest(ended)[0].placed
            after = taken + len(placed)
            last = min(chain.last, breaks[after][1]) if after < len(breaks) else chain.last
            yield _Way(begin, last, placed)


def _soonest(ended: Sequence[_State]) -> list[_State]:
    """Return the states that end as early as possible, and of these those that are the least late.

    Those that differ by a rounding are equal.
    """
    end = min(state.time for state in ended)
    first = [state for state in ended if not is_over(state.time, end)]
    lateness = min(state.lateness for state in first)
    return [state for state in first if not is_over(state.lateness, lateness, end)]


def _begins(chain: Chain, breaks: Sequence[Break]) -> Iterator[float]:
    """Yield the earliest departure after no break, after the first one, and so on."""
    ends = (opens + length for opens, _, length in breaks)
    return accumulate(ends, max, initial=chain.begin)


def _departing(chain: Chain, begin: float) -> list[_State]:
    """Return the state of a vehicle that may leave from a time on, if it may leave then.

    Of vehicles that leave early, those that leave the earliest count as the latest.
    """
    if is_over(begin, chain.leaves_by):
        return []
    return [_State(begin, 0.0, 0.0, -begin if chain.early else chain.leaves_by, begin, ())]


def _ended(chain: Chain, breaks: Sequence[Break], states: list[list[_State]]) -> Sequence[_State]:
    """Return the states at the end of a route, in time, given those at its departure.

    States are lists by the number of breaks taken. This is dynamic programming over the places of
    the route and the breaks taken, where states are kept that no other one dominates.
    """
    for place, (stay, leg) in enumerate(zip(chain.stays, [*chain.legs, 0.0], strict=True)):
        _rest(states, breaks, place, after=False)
        states = [each and _served(each, stay) for each in states]
        _rest(states, breaks, place, after=True)
        if leg:
            states = [[_driven(state, leg) for state in each] for each in states]
    closes = [*(each[1] for each in breaks), chain.last]  # of the next break, after the end
    return [
        state
        for next_closes, each in zip(closes, states, strict=True)
        for state in each
        if not is_over(state.time, min(chain.last, next_closes))
    ]


def _driven(state: _State, leg: float | Leg) -> _State:
    time, lateness, work, latest, departure, placed = state
    if isinstance(leg, float):
        return _State(time + leg, lateness, work + leg, latest, departure, placed)
    return _State(leg.arrival(time), lateness, work, latest, departure, placed)


def _rest(states: list[list[_State]], breaks: Sequence[Break], place: int, *, after: bool) -> None:
    """Let the vehicle take one break after another at a place."""
    for number, (opens, closes, length) in enumerate(breaks):
        for time, lateness, work, latest, departure, placed in states[number]:
            if time > closes and is_over(time, closes):
                continue
            ends, until = max(time, opens) + length, closes - work
            latest = until if until < latest else latest
            taken = (*placed, _Placed(number, place, after))
            rested = _State(ends, lateness, work + length, latest, departure, taken)
            _add(rested, states[number + 1])


def _served(states: list[_State], stay: Stay) -> list[_State]:
    """Return the states after a visit in any window that is not over."""
    windows, service, due, _ = stay
    if not service and due == inf and windows == _ALWAYS:
        return states
    found: list[_State] = []
    for time, lateness, work, latest, departure, placed in states:
        for opens, closes in windows:
            if time > closes and is_over(time, closes):
                continue
            begin = opens if opens > time else time
            late, until = lateness, closes
            if due < inf:
                late += excess(begin, due)
                until = min(closes, max(due, begin))
            until -= work
            least = until if until < latest else latest
            served = _State(begin + service, late, work + service, least, departure, placed)
            _add(served, found)
    return found


def _add(state: _State, states: list[_State]) -> None:
    """Add a state to others, unless one of them dominates it; drop those that it dominates."""
    for each in states:
        if each.dominates(state):
            return
    states[:] = [each for each in states if not state.dominates(each)]
    states.append(state)


def _times_of(
    way: _Way, chain: Chain, breaks: Sequence[Break], timed: Callable[[Chain], Schedule]
) -> Schedule:
    """Return the times of a route that takes its breaks in a way: at each stop, and of breaks."""
    stays, legs = list[Stay](), list[float | Leg]()
    arrivals, places = list[int](), list[int]()  # maybe at a break before the stop, and its own
    still = STILL if chain.over_the_day else 0.0
    for place, stay in enumerate(chain.stays):
        here = [each for each in way.placed if each.place == place]
        before = [_resting(breaks[each.number]) for each in here if not each.after]
        arrivals.append(len(stays))
        places.append(len(stays) + len(before))
        group = [*before, stay, *(_resting(breaks[each.number]) for each in here if each.after)]
        stays += group
        legs += [still] * (len(group) - 1) + list(chain.legs[place : place + 1])
    times = timed(chain._replace(stays=stays, legs=legs, begin=way.begin, last=way.last))
    leaving = [*(place - 1 for place in arrivals[1:]), len(stays) - 1]
    return replace(
        times,
        arrivals=tuple(times.arrivals[place] for place in arrivals),
        windows=tuple(times.windows[place] for place in places),
        begins=tuple(times.begins[place] for place in places),
        leaves=tuple(times.leaves[place] for place in leaving),
        breaks=tuple(times.begins[i] for i in range(len(stays)) if i not in places),
    )


def _resting(each: Break) -> Stay:
    opens, closes, length = each
    return Stay(((opens, closes),), length, inf)
