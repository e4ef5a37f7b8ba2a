"""Place the breaks of a vehicle on its route, so that it is done as early as possible."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple, TypeVar

from service.fleet.rounding import excess, is_over
from service.fleet.vehicles import ALWAYS, Break, Span, VehicleType

_ALWAYS = (ALWAYS,)
Leg = TypeVar("Leg")


class Stay(NamedTuple):
    """What a route asks of its vehicle at a stop."""

    windows: tuple[Span, ...]
    service: float
    due: float
    hold: float = inf  # which no later departure may make the visit miss, due or earlier


class Placed(NamedTuple):
    """A break on the way: at a place of the route, before or after the visit there."""

    number: int
    place: int
    after: bool


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
    """

    time: float
    lateness: float
    work: float
    latest: float
    departure: float
    placed: tuple[Placed, ...]

    def dominates(self, other: "_State") -> bool:
        """Return whether no way to go on from here ends better after the other state."""
        time = self.time
        return (
            time <= other.time
            and not excess(self.lateness, other.lateness, time)
            and not excess(self.work, other.work, time)
            and not excess(other.latest, self.latest, time)
        )


def place_breaks(
    stays: Sequence[Stay],
    driven: Sequence[float],
    span: Span,
    vehicle: VehicleType,
    early: bool,
) -> tuple[float, tuple[Placed, ...]] | None:
    """Return a departure and where breaks are taken so that a route ends as early as possible.

    Among the ways to end then, it is one of the least lateness; among these, one that allows to
    leave the latest, or if `early` the earliest. None if the breaks fit nowhere.

    A vehicle takes its breaks in order, between two visits, and none while it drives. A break that
    can be taken before the departure, or after the end, is not on the way. This is dynamic
    programming over the places of the route and the breaks taken, where states are kept that no
    other one dominates.

    Args:
        stays: What is asked for at each of the m places.
        driven: The times of the m - 1 legs between them.
        span: The earliest departure, and the latest end.
        vehicle: The vehicle, with k breaks by ascending time.
        early: Whether it leaves as early as it may.
    """
    begin, last = span
    leaves_by, breaks = vehicle.leaves_by, vehicle.breaks
    states: list[list[_State]] = [_departing(begin, leaves_by, early)]
    for opens, _, length in breaks:
        begin = max(begin, opens + length)
        states.append(_departing(begin, leaves_by, early))
    for place, (stay, leg) in enumerate(zip(stays, [*driven, 0.0], strict=True)):
        _rest(states, breaks, place, after=False)
        states = [each and _served(each, stay) for each in states]
        _rest(states, breaks, place, after=True)
        if leg:
            states = [[_driven(state, leg) for state in each] for each in states]
    closes = [*(each[1] for each in breaks), last]  # of the next break, which is after the end
    ended = [
        state
        for next_closes, each in zip(closes, states, strict=True)
        for state in each
        if not is_over(state.time, min(last, next_closes))
    ]
    if not ended:
        return None
    end = min(state.time for state in ended)
    first = [state for state in ended if not is_over(state.time, end)]
    lateness = min(state.lateness for state in first)
    least = [state for state in first if not is_over(state.lateness, lateness, end)]
    best = max(least, key=lambda state: min(state.latest, end - state.work))
    return best.departure, best.placed


def _departing(begin: float, leaves_by: float, early: bool) -> list[_State]:
    """Return the state of a vehicle that may leave from a time on, if it may leave then.

    Of vehicles that leave early, those that leave the earliest count as the latest.
    """
    if is_over(begin, leaves_by):
        return []
    return [_State(begin, 0.0, 0.0, -begin if early else leaves_by, begin, ())]


def _driven(state: _State, leg: float) -> _State:
    time, lateness, work, latest, departure, placed = state
    return _State(time + leg, lateness, work + leg, latest, departure, placed)


def _rest(states: list[list[_State]], breaks: Sequence[Break], place: int, *, after: bool) -> None:
    """Let the vehicle take one break after another at a place."""
    for number, (opens, closes, length) in enumerate(breaks):
        for time, lateness, work, latest, departure, placed in states[number]:
            if time > closes and is_over(time, closes):
                continue
            ends, until = max(time, opens) + length, closes - work
            latest = until if until < latest else latest
            taken = (*placed, Placed(number, place, after))
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


def with_breaks(
    stays: Sequence[Stay],
    driven: Sequence[Leg],
    breaks: Sequence[Break],
    placed: Sequence[Placed],
    still: Leg,
) -> tuple[list[Stay], list[Leg], list[int], list[int]]:
    """Return the stays and legs of a route with breaks as stays.

    The leg to or from a break is `still`, which takes no time. With them come, for each stay of the
    route, the place where the vehicle arrives for it, maybe at a break before it, and its own
    place.
    """
    found, legs = list[Stay](), list[Leg]()
    arrivals, places = list[int](), list[int]()
    for place, stay in enumerate(stays):
        here = [each for each in placed if each.place == place]
        group = [_resting(breaks[each.number]) for each in here if not each.after]
        arrivals.append(len(found))
        places.append(len(found) + len(group))
        group += [stay, *(_resting(breaks[each.number]) for each in here if each.after)]
        found += group
        legs += [still] * (len(group) - 1) + list(driven[place : place + 1])
    return found, legs, arrivals, places


def _resting(each: Break) -> Stay:
    opens, closes, length = each
    return Stay(((opens, closes),), length, inf)
