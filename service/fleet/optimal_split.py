"""The optimal split of sequences of stops into the routes of a fleet (Prins, 2004). Compiled.

First the lengths of all routes that visit neighbours in a sequence; then dynamic programming over
the stops of a sequence and the vehicles used. No other plan whose routes follow the sequence costs
less.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import LAYERS, Array, Fleet
from service.fleet.loads import loads_of
from service.fleet.plans import Plan, Route
from service.fleet.rounding import is_over
from service.fleet.rules import Rules
from service.jit import allocating, compiled, inlined

Indices = NDArray[np.int64]
_is_over = inlined(is_over)


class FleetArrays(NamedTuple):
    """A fleet as arrays: n stops, v types of vehicles and d dimensions of loads.

    It has no shipments, and each stop has one window. No vehicle loads again.
    """

    costs: Array  # (2, n, n)
    clock: int  # -1 for none
    limited: int  # the number of the costs that `longest` bounds; -1 for none
    demand: Indices  # (n, d)
    service: Array  # (n,)
    release: Array  # (n,)
    window: Array  # (n, 2)
    ends: Indices  # (v, 2), start and end of each type; -1 for none
    capacity: Indices  # (v, d)
    shift: Array  # (v, 2)
    leaves_by: Array  # (v,), the latest departure
    early: bool  # whether vehicles leave as early as they may
    longest: Array  # (v,)


def arrays_of(fleet: Fleet) -> FleetArrays:
    """Return a fleet as arrays, in the types and layouts for which the code is compiled."""
    rules = fleet.rules
    loads = loads_of(rules)
    ends = [[-1 if end is None else end for end in (v.start, v.end)] for v in rules.vehicles]
    return FleetArrays(
        costs=np.array(fleet.matrices(), order="C"),
        clock=-1 if rules.clock is None else rules.clock,
        limited=-1 if rules.limited is None else rules.limited,
        demand=loads.demand,
        service=np.array([visit.service for visit in rules.visits]),
        release=np.array([visit.release for visit in rules.visits]),
        window=np.array([windows[0] for windows in rules.windows], np.float64),
        ends=np.array(ends, np.int64),
        capacity=loads.capacity - loads.initial,
        shift=np.array([vehicle.way for vehicle in rules.vehicles], np.float64),
        leaves_by=np.array([vehicle.leaves_by for vehicle in rules.vehicles]),
        early=rules.leave == "early",
        longest=np.array([vehicle.longest for vehicle in rules.vehicles]),
    )


@allocating
def most_stops(fleet: FleetArrays, sequence: Indices) -> int:
    """Return the most neighbours in a cyclic sequence that fit one vehicle; at least 1."""
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
        most: The most stops of a route.

    Returns:
        Shape (v, c, most, 2): the length of the route in both costs, by the type of vehicles, the
        first place in the sequence, and the number of stops less one; infinite if the route breaks
        a rule.
    """
    types, c = len(fleet.ends), len(sequence)
    table = np.full((types, c, most, LAYERS), np.inf)
    for vehicle in range(types):
        for place in range(c):
            fitting = min(most, _fitting(fleet, sequence, vehicle, place))
            _write_lengths(fleet, sequence, vehicle, place, table[vehicle, place, :fitting])
    return table


@allocating
def _fitting(fleet: FleetArrays, sequence: Indices, vehicle: int, place: int) -> int:
    """Return the number of stops, from a place on, that the capacity of a vehicle allows."""
    loads = np.zeros(fleet.demand.shape[1], np.int64)
    for count in range(len(sequence)):
        stop = sequence[(place + count) % len(sequence)]
        for dimension in range(len(loads)):
            loads[dimension] += fleet.demand[stop, dimension]
            if loads[dimension] > fleet.capacity[vehicle, dimension]:
                return count
    return len(sequence)


class _Begun(NamedTuple):
    """The first part of a route."""

    first: float  # its lengths
    second: float
    departs: float  # the first departure
    time: float  # the least time from a departure, with waiting
    early: float  # the first and the last departure that need only this time
    late: float
    stop: int  # the latest stop; -1 for anywhere
    in_time: bool


@compiled
def _write_lengths(
    fleet: FleetArrays, sequence: Indices, vehicle: int, place: int, lengths: Array
) -> None:
    """Write the lengths of a vehicle's routes from a place on, shape (most, 2)."""
    departs, returns = fleet.shift[vehicle]
    start, end = fleet.ends[vehicle]
    longest = fleet.longest[vehicle]
    latest = min(returns, fleet.leaves_by[vehicle])
    begun = _Begun(0.0, 0.0, departs, 0.0, departs, latest, start, True)
    for count in range(len(lengths)):
        stop = sequence[(place + count) % len(sequence)]
        opens, closes = fleet.window[stop]
        begun = _released(begun, fleet.release[stop])
        begun = _extended(fleet, begun, stop, opens, closes, fleet.service[stop])
        if not begun.in_time or _too_long(fleet, begun, longest):
            return
        route = _extended(fleet, begun, end, 0.0, returns, 0.0)
        if route.in_time and not _too_long(fleet, route, longest):
            lengths[count, 0] = _time(fleet, route) if fleet.clock == 0 else route.first
            lengths[count, 1] = _time(fleet, route) if fleet.clock == 1 else route.second


@inlined
def _time(fleet: FleetArrays, begun: _Begun) -> float:
    """Return the time from the departure of a route to its end."""
    return begun.early + begun.time - begun.departs if fleet.early else begun.time


@inlined
def _released(begun: _Begun, release: float) -> _Begun:
    """Return a route that departs no earlier than what it brings to a stop is released."""
    early, departs = max(begun.early, release), max(begun.departs, release)
    in_time = begun.in_time and not _is_over(early, begun.late, early + begun.time)
    first, second, stop = begun.first, begun.second, begun.stop
    return _Begun(first, second, departs, begun.time, early, begun.late, stop, in_time)


@inlined
def _extended(
    fleet: FleetArrays, begun: _Begun, stop: int, opens: float, closes: float, service: float
) -> _Begun:
    """Return a route after one more stop.

    The vehicle departs as late as that saves waiting: Vidal et al. (2013), time-window segments.
    """
    first, second = begun.first, begun.second
    leg = 0.0
    if begun.stop >= 0 and stop >= 0:
        first += fleet.costs[0, begun.stop, stop]
        second += fleet.costs[1, begun.stop, stop]
        leg = fleet.costs[max(fleet.clock, 0), begun.stop, stop]
    if fleet.clock < 0:
        return _Begun(first, second, 0.0, 0.0, 0.0, 0.0, stop, True)
    until = begun.time + leg
    arrival = begun.early + until
    if closes < opens:  # whoever is there in time waits: see Rules.windows
        opens, service = closes, service + opens - closes
    waiting = max(0.0, opens - until - begun.late)
    return _Begun(
        first,
        second,
        begun.departs,
        until + waiting + service,
        max(begun.early, opens - until) - waiting,
        min(begun.late, closes - until),
        stop,
        begun.in_time and not _is_over(arrival, closes),
    )


@inlined
def _too_long(fleet: FleetArrays, begun: _Begun, longest: float) -> bool:
    """Return whether a route exceeds a limit on its time, or on its length without a clock."""
    length = begun.first if fleet.limited == 0 else begun.second
    if fleet.limited == fleet.clock:
        length = _time(fleet, begun)
    return _is_over(length, longest, begun.early + begun.time)


class Stock(NamedTuple):
    """The available vehicles of v types, and how the vehicles in use are encoded as a number.

    The number is below `states`: each vehicle in use adds the step of its type. The vehicles of a
    type are not counted, and its step is 0, if there is one for every stop.
    """

    available: Indices  # (v,)
    step: Indices  # (v,)
    states: int


def states_of(rules: Rules) -> int:
    """Return the number of states of the stock of a fleet: maybe too many for an array."""
    clients = len(rules.clients)
    counted = (vehicle.count for vehicle in rules.vehicles if vehicle.count < clients)
    return math.prod(count + 1 for count in counted)


def stock_of(rules: Rules) -> Stock:
    """Return the stock of a fleet with few states."""
    available = [vehicle.count for vehicle in rules.vehicles]
    steps, states = [], 1
    for count in available:
        counted = count < len(rules.clients)
        steps.append(states if counted else 0)
        states *= count + 1 if counted else 1
    return Stock(np.array(available, np.int64), np.array(steps, np.int64), states)


class RouteCosts(NamedTuple):
    """The costs of the routes along a cyclic sequence of c stops.

    Routes have the indices of route_table().
    """

    cost: Array  # (v, c, most), infinite if a route breaks a rule
    bounded: Array  # (v, c, most), the length that must stay below the limit
    skipping: Array  # (c,), the cost of leaving a stop out; infinite if that is not allowed


def best_split(
    stock: Stock, routes: RouteCosts, begins: int, limit: float
) -> tuple[float, Indices]:
    """Return the least cost of a plan whose routes follow a sequence, and these routes.

    Args:
        stock: The vehicles.
        routes: The routes to choose from.
        begins: The number of places, from the start of the sequence, at which the first route may
            begin. The plan is the best of all if no route has more stops than that.
        limit: Each route must be shorter.

    Returns:
        The cost, infinite if there is no plan; and the routes, shape (m, 3): type, first place,
        and number of stops.
    """
    c = len(routes.skipping)
    cost = np.where(routes.bounded < limit, routes.cost, np.inf)
    partials = PartialPlans(
        np.empty((c + 1, stock.states)), np.empty((c + 1, stock.states, 3), np.int64)
    )
    found = np.empty((c, 3), np.int64)
    best, count = _write_best(stock, cost, routes.skipping, begins, partials, found)
    return best, found[:count][::-1]


class PartialPlans(NamedTuple):
    """The least costs of visiting the first stops after a begin.

    Indices are the number of stops, and the state of the stock. A choice is the last step: the type
    of the last route, or -1 if the last stop is left out; its number of stops; the state before.
    """

    least: Array  # (c + 1, states)
    choices: Indices  # (c + 1, states, 3)


@compiled
def _write_best(
    stock: Stock,
    cost: Array,
    skipping: Array,
    begins: int,
    partials: PartialPlans,
    found: Indices,
) -> tuple[float, int]:
    """Write the routes of the best plan, the last one first; return its cost and their number."""
    best, count = np.inf, 0
    for begin in range(begins):
        _write_partials(stock, cost, skipping, begin, partials)
        least = partials.least[-1]
        used = 0
        for state in range(1, stock.states):
            if least[state] < least[used]:
                used = state
        if least[used] < best:
            best, count = least[used], _write_routes(partials.choices, begin, used, found)
    return best, count


@compiled
def _write_partials(
    stock: Stock, cost: Array, skipping: Array, begin: int, partials: PartialPlans
) -> None:
    """Write the partial plans after a begin, from routes with these costs."""
    least, choices = partials
    c = len(skipping)
    least[:] = np.inf
    least[0, 0] = 0.0
    for visited in range(c):
        place = (begin + visited) % c
        for used in range(stock.states):
            if least[visited, used] == np.inf:
                continue
            if least[visited, used] + skipping[place] < least[visited + 1, used]:
                least[visited + 1, used] = least[visited, used] + skipping[place]
                _set(choices[visited + 1, used], -1, 1, used)
            _add_routes(stock, cost[:, place], partials, visited, used)


@inlined
def _add_routes(stock: Stock, cost: Array, partials: PartialPlans, visited: int, used: int) -> None:
    """Write the partial plans that add one more route, of cost (v, most), to a partial plan."""
    least, choices = partials
    types, most = cost.shape
    for vehicle in range(types):
        step, available = stock.step[vehicle], stock.available[vehicle]
        if step and used // step % (available + 1) == available:
            continue
        for count in range(1, min(most, len(least) - 1 - visited) + 1):
            extended = least[visited, used] + cost[vehicle, count - 1]
            if extended < least[visited + count, used + step]:
                least[visited + count, used + step] = extended
                _set(choices[visited + count, used + step], vehicle, count, used)


@inlined
def _set(row: Indices, first: int, second: int, third: int) -> None:
    """Set three numbers: numba compiles 10 functions for an assignment of all."""
    row[0], row[1], row[2] = first, second, third


@compiled
def _write_routes(choices: Indices, begin: int, used: int, found: Indices) -> int:
    """Write the routes of the partial plan of all stops in a state; return their number."""
    c = visited = len(choices) - 1
    m = 0
    while visited > 0:
        vehicle, count, before = choices[visited, used]
        visited -= count
        used = before
        if vehicle >= 0:
            _set(found[m], vehicle, (begin + visited) % c, count)
            m += 1
    return m


def plan_of(sequence: Indices, routes: Indices) -> Plan:
    """Return the plan of routes, shape (m, 3), along a cyclic sequence."""
    places = len(sequence)
    return Plan(
        tuple(
            Route(vehicle, tuple(sequence[(first + np.arange(count)) % places].tolist()))
            for vehicle, first, count in routes.tolist()
        )
    )
