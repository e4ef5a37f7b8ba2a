"""The optimal split of sequences of stops into the routes of a fleet (Prins, 2004). Compiled.

First the lengths of all routes that visit neighbours in a sequence; then dynamic programming over
the stops of a sequence and the vehicles used. No other plan whose routes follow the sequence costs
less.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import LAYERS, Array
from service.fleet.plans import Plan, Route
from service.fleet.rounding import is_over
from service.fleet.rules import Rules
from service.fleet.search.problem import Problem
from service.fleet.search.spans import Span, joined, stay, times_of
from service.fleet.search.working_plan import leg
from service.jit import allocating, compiled, inlined

Indices = NDArray[np.int64]
_is_over = inlined(is_over)


@allocating
def most_stops(problem: Problem, sequence: Indices) -> int:
    """Return the most neighbours in a cyclic sequence that fit one vehicle; at least 1."""
    most = 1
    for vehicle in range(len(problem.capacity)):
        for place in range(len(sequence)):
            most = max(most, _fitting(problem, sequence, vehicle, place))
    return most


@allocating
def route_table(problem: Problem, sequence: Indices, most: int) -> Array:
    """Return the lengths of each route that visits neighbours in a cyclic sequence, in its order.

    O(v c most).

    Args:
        problem: A fleet without shipments, whose stops have one window each, and whose vehicles
            neither load again nor have breaks.
        sequence: The c stops, shape (c,). The first follows the last.
        most: The most stops of a route.

    Returns:
        Shape (v, c, most, 2): the length of the route in both costs, by the type of vehicles, the
        first place in the sequence, and the number of stops less one; infinite if the route breaks
        a rule.
    """
    types, c = len(problem.capacity), len(sequence)
    table = np.full((types, c, most, LAYERS), np.inf)
    for vehicle in range(types):
        for place in range(c):
            fitting = min(most, _fitting(problem, sequence, vehicle, place))
            _write_lengths(problem, sequence, vehicle, place, table[vehicle, place, :fitting])
    return table


@allocating
def _fitting(problem: Problem, sequence: Indices, vehicle: int, place: int) -> int:
    """Return the number of stops, from a place on, that the capacity of a vehicle allows."""
    loads = np.zeros(problem.demand.shape[1], np.int64)
    for count in range(len(sequence)):
        stop = sequence[(place + count) % len(sequence)]
        for dimension in range(len(loads)):
            loads[dimension] += problem.demand[stop, dimension]
            if loads[dimension] > problem.capacity[vehicle, dimension]:
                return count
    return len(sequence)


class _Begun(NamedTuple):
    """The first part of a route: the sums of both costs of its legs, and when it may be driven."""

    first: float
    second: float
    span: Span


@compiled
def _write_lengths(
    problem: Problem, sequence: Indices, vehicle: int, place: int, lengths: Array
) -> None:
    """Write the lengths of a vehicle's routes from a place on, shape (most, 2)."""
    slot = problem.slots[vehicle]
    profile, node = problem.profile[slot], len(problem.demand) + 2 * slot
    at, end = problem.place[node], problem.place[node + 1]
    begun = _Begun(0.0, 0.0, Span(0.0, problem.departs[vehicle], problem.leaves_by[vehicle]))
    returned = Span(0.0, 0.0, problem.returns[vehicle])
    released = 0.0
    for count in range(len(lengths)):
        stop = sequence[(place + count) % len(sequence)]
        released = max(released, problem.release[stop])
        begun, in_time = _extended(problem, profile, begun, at, stop, stay(problem, profile, stop))
        if not (in_time and _lengths_of(problem, vehicle, begun, released)[2]):
            return
        route, in_time = _extended(problem, profile, begun, stop, end, returned)
        first, second, fits = _lengths_of(problem, vehicle, route, released)
        if in_time and fits:
            lengths[count, 0], lengths[count, 1] = first, second
        at = stop


@inlined
def _extended(
    problem: Problem, profile: int, begun: _Begun, a: int, b: int, part: Span
) -> tuple[_Begun, bool]:
    """Return a route after one more leg and the part behind it, and whether it keeps windows."""
    first, second = leg(problem, profile, a, b, 0), leg(problem, profile, a, b, 1)
    span, in_time = begun.span, True
    if problem.clock >= 0:
        span, in_time = joined(span, first if problem.clock == 0 else second, part)
    return _Begun(begun.first + first, begun.second + second, span), in_time


@inlined
def _lengths_of(
    problem: Problem, vehicle: int, route: _Begun, released: float
) -> tuple[float, float, bool]:
    """Return both lengths of a route, and whether no limit and no forbidden leg is against it."""
    first, second, span = route
    fits, end = first < problem.forbidden, 0.0
    if problem.clock >= 0:
        time, end = times_of(problem, vehicle, span, released)
        fits &= time < np.inf
        first, second = (time, second) if problem.clock == 0 else (first, time)
    length = first if problem.limited == 0 else second
    return first, second, fits and not _is_over(length, problem.longest[vehicle], end)


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
