"""The lengths of all routes that visit neighbours in a sequence of stops. Compiled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.instance import OBJECTIVES
from service.jit import allocating, compiled, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
_ROUNDING = 1e-10  # relative, of sums of costs; less than what the check of plans allows


class FleetArrays(NamedTuple):
    """A fleet as arrays: of n stops, v types of vehicles, and d dimensions. Without shipments."""

    costs: Array  # (2, n, n)
    clock: int  # -1 for none
    limited: int  # the objective that `longest` bounds; -1 for none
    demand: Indices  # (n, d)
    service: Array  # (n,)
    window: Array  # (n, 2)
    ends: Indices  # (v, 2), start and end of each type; -1 for none
    capacity: Indices  # (v, d)
    shift: Array  # (v, 2)
    longest: Array  # (v,)


def arrays_of(fleet: Fleet) -> FleetArrays:
    """Return the arrays of a fleet, of the one type and layout that is compiled."""
    rules = fleet.rules
    none = (0,) * rules.dimensions
    limited = rules.maximum if rules.clock is None else rules.clock
    ends = [[-1 if end is None else end for end in (v.start, v.end)] for v in rules.vehicles]
    return FleetArrays(
        costs=np.array(fleet.costs, order="C"),
        clock=-1 if rules.clock is None else rules.clock,
        limited=-1 if limited is None else limited,
        demand=_whole([visit.demand or none for visit in rules.visits], rules.dimensions),
        service=np.array([visit.service for visit in rules.visits]),
        window=np.array([visit.window for visit in rules.visits], np.float64),
        ends=np.array(ends, np.int64),
        capacity=_whole([vehicle.capacity for vehicle in rules.vehicles], rules.dimensions),
        shift=np.array([vehicle.shift for vehicle in rules.vehicles], np.float64),
        longest=np.array([vehicle.longest for vehicle in rules.vehicles]),
    )


def _whole(rows: list[tuple[int, ...]], dimensions: int) -> Indices:
    return np.array(rows, np.int64).reshape(len(rows), dimensions)


@allocating
def most_stops(fleet: FleetArrays, sequence: Indices) -> int:
    """Return how many neighbours in a cyclic sequence fit one vehicle, at most; 1 at least."""
    most = 1
    for vehicle in range(len(fleet.ends)):
        for place in range(len(sequence)):
            most = max(most, _fitting(fleet, sequence, vehicle, place))
    return most


@allocating
def route_table(fleet: FleetArrays, sequence: Indices, most: int) -> Array:
    """Return the lengths of each route that visits neighbours in a cyclic sequence, in its order.

    O(v c most).

    Args:
        fleet: The fleet.
        sequence: The c stops, shape (c,). The first follows the last.
        most: The stops of a route, at most.

    Returns:
        Shape (v, c, most, 2): both lengths of the route of each type of vehicles from each place in
        the sequence, with so many stops, one at least; infinite where it breaks a rule.
    """
    types, c = len(fleet.ends), len(sequence)
    table = np.full((types, c, most, OBJECTIVES), np.inf)
    for vehicle in range(types):
        for place in range(c):
            fitting = min(most, _fitting(fleet, sequence, vehicle, place))
            _fill(fleet, sequence, vehicle, place, table[vehicle, place, :fitting])
    return table


@allocating
def _fitting(fleet: FleetArrays, sequence: Indices, vehicle: int, place: int) -> int:
    """Return how many stops from a place on a vehicle can visit by its capacity."""
    loads = np.zeros(fleet.demand.shape[1], np.int64)
    for count in range(len(sequence)):
        stop = sequence[(place + count) % len(sequence)]
        for dimension in range(len(loads)):
            loads[dimension] += fleet.demand[stop, dimension]
            if loads[dimension] > fleet.capacity[vehicle, dimension]:
                return count
    return len(sequence)


class _Begun(NamedTuple):
    """The begin of a route that is nowhere late."""

    first: float  # its lengths
    second: float
    time: float  # from its departure, with waiting; no departure has less
    early: float  # the departures with this time, from and to
    late: float
    stop: int  # where it is; -1 for anywhere
    in_time: bool


@compiled
def _fill(fleet: FleetArrays, sequence: Indices, vehicle: int, place: int, lengths: Array) -> None:
    """Write the lengths of a vehicle's routes from a place on, shape (most, 2)."""
    departs, returns = fleet.shift[vehicle]
    start, end = fleet.ends[vehicle]
    longest = fleet.longest[vehicle] * (1 + _ROUNDING)
    begun = _Begun(0.0, 0.0, 0.0, departs, returns, start, True)
    for count in range(len(lengths)):
        stop = sequence[(place + count) % len(sequence)]
        opens, closes = fleet.window[stop]
        begun = _extended(fleet, begun, stop, opens, closes, fleet.service[stop])
        if not begun.in_time or _limited(fleet, begun) > longest:
            return
        route = _extended(fleet, begun, end, 0.0, returns, 0.0)
        if route.in_time and _limited(fleet, route) <= longest:
            lengths[count, 0] = route.time if fleet.clock == 0 else route.first
            lengths[count, 1] = route.time if fleet.clock == 1 else route.second


@inlined
def _extended(
    fleet: FleetArrays, begun: _Begun, stop: int, opens: float, closes: float, service: float
) -> _Begun:
    """Return a route after one more stop.

    The stop is reached when its window opens or later, as late as that saves waiting: Vidal et al.
    (2013), time-window segments.
    """
    first, second = begun.first, begun.second
    leg = 0.0
    if begun.stop >= 0 and stop >= 0:
        first += fleet.costs[0, begun.stop, stop]
        second += fleet.costs[1, begun.stop, stop]
        leg = fleet.costs[max(fleet.clock, 0), begun.stop, stop]
    if fleet.clock < 0:
        return _Begun(first, second, 0.0, 0.0, 0.0, stop, True)
    until = begun.time + leg
    arrival = begun.early + until
    waiting = max(0.0, opens - until - begun.late)
    return _Begun(
        first,
        second,
        until + waiting + service,
        max(begun.early, opens - until) - waiting,
        min(begun.late, closes - until),
        stop,
        arrival <= closes + _ROUNDING * arrival,
    )


@inlined
def _limited(fleet: FleetArrays, begun: _Begun) -> float:
    """Return the length that the longest route bounds."""
    if fleet.limited == fleet.clock:
        return begun.time
    return begun.first if fleet.limited == 0 else begun.second
