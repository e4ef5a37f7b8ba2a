"""The best departure of a route over the day.

A vehicle leaves when its route takes the least time, as early as that may be. But it does not leave
so late that it misses a window, that visits begin later after they are due, or that it ends later
after its shift, than if it left as early as it may.

The time that a route takes is a piecewise linear function of its departure. So it is least where
something changes on the way: where a slice of the day begins as the vehicle leaves or arrives, or
where a window opens or closes. These times are followed back to the departures that lead to them,
and all of these are tried.
"""

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from service.fleet.day_legs import Array, Leg
from service.fleet.rounding import ROUNDING
from service.fleet.times import Chain, Schedule

_EQUAL = 10 * ROUNDING  # durations that differ by less, relative to the end, count as equal


def best_departure(chain: Chain, first: Schedule) -> float:
    """Return the earliest departure of least duration, given the times after the earliest."""
    tried = _candidates(chain, first)
    ends, late, lateness = _ends(chain, tried, first.end)
    bound = max(chain.shift_end, first.end)
    slack = _EQUAL * first.end
    allowed = ~late & (lateness <= first.lateness + slack) & (ends <= bound + slack)
    durations = np.where(allowed, ends - tried, inf)
    best = int(np.argmax(durations <= durations.min() + _EQUAL * first.end))
    return float(tried[best])


def _candidates(chain: Chain, first: Schedule) -> Array:
    """Return the departures after which something changes on the way, ascending."""
    legs = _legs_of(chain)
    times = np.array([chain.last, max(chain.shift_end, first.end)])  # when the last visit ends
    for place in range(len(chain.stays) - 1, -1, -1):
        windows, service, due, _ = chain.stays[place]
        if place < len(legs):
            leg = legs[place]
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


def _ends(chain: Chain, departures: Array, reach: float) -> tuple[Array, NDArray[np.bool_], Array]:
    """Return when routes end that leave at these times, whether they are late, and how late."""
    time, legs = departures, _legs_of(chain)
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
        if place < len(legs):
            time = legs[place].arrivals(time)
    return time, late | (time > chain.last + slack), lateness


def _legs_of(chain: Chain) -> Sequence[Leg]:
    """Return the legs of a route over the day."""
    return [leg for leg in chain.legs if not isinstance(leg, float)]
