"""The times of a route: what it asks of its vehicle, and where that is when."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from service.fleet.day_legs import Leg
from service.fleet.rounding import excess, is_over
from service.fleet.vehicles import Span


class Stay(NamedTuple):
    """What a route asks of its vehicle at a stop."""

    windows: tuple[Span, ...]
    service: float
    due: float
    hold: float = inf  # which no later departure may make the visit miss, due or earlier


class Chain(NamedTuple):
    """A route as a chain of stays, among which may be breaks.

    Attributes:
        stays: What is asked for at each of the m places.
        legs: The m - 1 legs between them: how long they take, or legs over the day.
        begin: The earliest departure.
        leaves_by: The latest departure.
        last: The latest end.
        shift_end: The end of the shift, after which a route has overtime.
        early: Whether the vehicle leaves as early as it may.
        over_the_day: Whether legs are those over the day.
    """

    stays: Sequence[Stay]
    legs: Sequence[float | Leg]
    begin: float
    leaves_by: float
    last: float
    shift_end: float
    early: bool
    over_the_day: bool


@dataclass(frozen=True)
class Schedule:
    """The times of a route: when the vehicle reaches each stop, and when it is done.

    Attributes:
        arrivals: The arrival at each stop of `path_of`; at the first stop, the departure. The
            vehicle may wait at a stop until its window opens.
        end: The end of the route.
        late: The largest delay at a window, or at the end of the shift with its overtime; 0 if it
            is a rounding.
        waiting: The time that the vehicle waits.
        slack: How much later it may leave without being late, if it is never late, and if its legs
            then take as long.
        lateness: The sum of the times by which visits begin after they are due.
        windows: The number of the window used at each stop of `path_of`.
        tightest: The place in `path_of` of the stop that limits the slack by a window that is not
            its last; -1 if something else does.
        begins: When the visit at each stop of `path_of` begins.
        leaves: When the vehicle leaves each stop of `path_of`, after any break there.
        breaks: When each break on the way begins.
    """

    arrivals: tuple[float, ...]
    end: float
    late: float
    waiting: float
    slack: float
    lateness: float
    windows: tuple[int, ...]
    tightest: int
    begins: tuple[float, ...]
    leaves: tuple[float, ...]
    breaks: tuple[float, ...] = ()

    @property
    def duration(self) -> float:
        """The time from the departure to the end."""
        return self.end - self.arrivals[0]


def drive(
    chain: Chain, departure: float, reach: float = 0.0, allowed: Sequence[int] | None = None
) -> Schedule:
    """Return the times of a route that leaves at a time.

    At each stop the vehicle takes the first window that is not over, else the last one.

    Args:
        reach: The largest time from which the departure was computed.
        allowed: The number of the first window that it may take at each stop; by default 0.
    """
    time, waiting, slack, late, lateness, tightest = departure, 0.0, inf, 0.0, 0.0, -1
    arrivals, used, begins, leaves = [], [], [], []
    # Every solution of the search comes through here: branches cost less than calls of max().
    for place, ((windows, service, due, hold), leg) in enumerate(
        zip(chain.stays, [*chain.legs, 0.0], strict=True)
    ):
        number = allowed[place] if allowed else 0
        if windows[number][1] < time:
            number = _open_window(windows, number, time, reach)
        opens, closes = windows[number]
        arrivals.append(time)
        used.append(number)
        begin = time
        if opens > time:
            waiting += opens - time
            begin = opens
        begins.append(begin)
        until = closes
        if hold < inf:
            lateness += excess(begin, due, reach)
            until = min(closes, max(hold, begin))
        if until - begin + waiting < slack:
            slack = until - begin + waiting
            tightest = place if until == closes and number + 1 < len(windows) else -1
        if time > closes:
            late = max(late, excess(time, closes, reach))
        end = begin + service
        leaves.append(end)
        time = end + leg if isinstance(leg, float) else leg.arrival(end)
    if chain.last - end + waiting < slack:
        slack, tightest = chain.last - end + waiting, -1
    late = max(late, excess(end, chain.last, reach))
    found = tuple(arrivals), end, late, waiting, slack, lateness, tuple(used), tightest
    return Schedule(*found, tuple(begins), tuple(leaves))


def _open_window(windows: Sequence[Span], number: int, time: float, reach: float) -> int:
    """Return the first window that is not over, from a number on; else the last one."""
    while number + 1 < len(windows) and is_over(time, windows[number][1], reach):
        number += 1
    return number
