"""Place the breaks of a vehicle on its route, so that it is done as early as possible."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

from service.fleet.rules import Break, Span


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


# The earliest time of a state, and how it was reached: the breaks taken so far.
_State = tuple[float, tuple[Placed, ...]]


def place_breaks(
    stays: Sequence[Stay],
    driven: Sequence[float],
    begin: float,
    last: float,
    breaks: Sequence[Break],
) -> tuple[Placed, ...] | None:
    """Return where breaks are taken so that a route ends as early as possible; None if nowhere.

    A vehicle takes its breaks in order, between two visits, and none while it drives. A break that
    can be taken before the departure, or after the end, is not on the way. This is dynamic
    programming over the places of the route and the breaks taken: to be at a place earlier is never
    worse. O(m k) for m places and k breaks.

    Args:
        stays: What is asked for at each of the m places.
        driven: The times of the m - 1 legs between them.
        begin: The earliest departure.
        last: The latest end.
        breaks: The k breaks, by ascending time.
    """
    states: list[_State | None] = [None] * (len(breaks) + 1)
    before = next((i for i, each in enumerate(breaks) if each[0] + each[2] > begin), len(breaks))
    states[before] = (begin, ())
    for place, (stay, leg) in enumerate(zip(stays, [*driven, 0.0], strict=True)):
        _rest(states, breaks, place, after=False)
        states = [_served(state, stay) for state in states]
        _rest(states, breaks, place, after=True)
        states = [None if each is None else (each[0] + leg, each[1]) for each in states]
    ended = [
        state
        for number, state in enumerate(states)
        if state is not None
        and state[0] <= last
        and (number == len(breaks) or state[0] <= breaks[number][1])
    ]
    return min(ended, key=lambda state: state[0])[1] if ended else None


def _rest(states: list[_State | None], breaks: Sequence[Break], place: int, *, after: bool) -> None:
    """Let the vehicle take one break after another at a place."""
    for number, (opens, closes, length) in enumerate(breaks):
        state = states[number]
        if state is None or state[0] > closes:
            continue
        ends = max(state[0], opens) + length
        known = states[number + 1]
        if known is None or ends < known[0]:
            states[number + 1] = (ends, (*state[1], Placed(number, place, after)))


def _served(state: _State | None, stay: Stay) -> _State | None:
    """Return the state after a visit; None if all of its windows are over."""
    if state is None:
        return None
    window = next((each for each in stay.windows if each[1] >= state[0]), None)
    if window is None:
        return None
    return max(state[0], window[0]) + stay.service, state[1]


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
