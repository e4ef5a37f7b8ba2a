"""Place the breaks of a vehicle on its route, so that it is done as early as possible."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from service.fleet.vehicles import Break, Span


class Stay(NamedTuple):
    """What a route asks of its vehicle at a stop."""

    windows: tuple[Span, ...]
    service: float
    due: float


class Placed(NamedTuple):
    """A break on the way: at a place of the route, before or after the visit there."""

    number: int
    place: int
    after: bool


class _State(NamedTuple):
    """The earliest time of a state, and how it was reached."""

    time: float
    departure: float
    placed: tuple[Placed, ...]


def place_breaks(
    stays: Sequence[Stay],
    driven: Sequence[float],
    span: Span,
    leaves_by: float,
    breaks: Sequence[Break],
) -> tuple[float, tuple[Placed, ...]] | None:
    """Return a departure and where breaks are taken so that a route ends as early as possible.

    None if the breaks fit nowhere.

    A vehicle takes its breaks in order, between two visits, and none while it drives. A break that
    can be taken before the departure, or after the end, is not on the way. This is dynamic
    programming over the places of the route and the breaks taken: to be at a place earlier is never
    worse. O(m k) for m places and k breaks.

    Args:
        stays: What is asked for at each of the m places.
        driven: The times of the m - 1 legs between them.
        span: The earliest departure, and the latest end.
        leaves_by: The latest departure.
        breaks: The k breaks, by ascending time.
    """
    begin, last = span
    states: list[_State | None] = [None] * (len(breaks) + 1)
    if begin <= leaves_by:
        states[0] = _State(begin, begin, ())
    for number, (opens, _, length) in enumerate(breaks, start=1):
        begin = max(begin, opens + length)
        if begin <= leaves_by:
            states[number] = _State(begin, begin, ())
    for place, (stay, leg) in enumerate(zip(stays, [*driven, 0.0], strict=True)):
        _rest(states, breaks, place, after=False)
        states = [_served(state, stay) for state in states]
        _rest(states, breaks, place, after=True)
        states = [each and each._replace(time=each.time + leg) for each in states]
    ended = [
        state
        for number, state in enumerate(states)
        if state is not None
        and state.time <= last
        and (number == len(breaks) or state.time <= breaks[number][1])
    ]
    if not ended:
        return None
    _, departure, placed = min(ended, key=lambda state: state.time)
    return departure, placed


def _rest(states: list[_State | None], breaks: Sequence[Break], place: int, *, after: bool) -> None:
    """Let the vehicle take one break after another at a place."""
    for number, (opens, closes, length) in enumerate(breaks):
        state = states[number]
        if state is None or state.time > closes:
            continue
        ends = max(state.time, opens) + length
        known = states[number + 1]
        if known is None or ends < known.time:
            placed = (*state.placed, Placed(number, place, after))
            states[number + 1] = _State(ends, state.departure, placed)


def _served(state: _State | None, stay: Stay) -> _State | None:
    """Return the state after a visit; None if all of its windows are over."""
    if state is None:
        return None
    window = next((each for each in stay.windows if each[1] >= state.time), None)
    if window is None:
        return None
    return state._replace(time=max(state.time, window[0]) + stay.service)


def with_breaks(
    stays: Sequence[Stay],
    driven: Sequence[float],
    breaks: Sequence[Break],
    placed: Sequence[Placed],
) -> tuple[list[Stay], list[float], list[int], list[int]]:
    """Return the stays and legs of a route with breaks as stays.

    The leg to or from a break takes no time. With them come, for each stay of the route, the place
    where the vehicle arrives for it, maybe at a break before it, and its own place.
    """
    found, legs = list[Stay](), list[float]()
    arrivals, places = list[int](), list[int]()
    for place, stay in enumerate(stays):
        here = [each for each in placed if each.place == place]
        group = [_resting(breaks[each.number]) for each in here if not each.after]
        arrivals.append(len(found))
        places.append(len(found) + len(group))
        group += [stay, *(_resting(breaks[each.number]) for each in here if each.after)]
        found += group
        legs += [0.0] * (len(group) - 1) + list(driven[place : place + 1])
    return found, legs, arrivals, places


def _resting(each: Break) -> Stay:
    opens, closes, length = each
    return Stay(((opens, closes),), length, inf)
