"""The optimal split of sequences of stops into the routes of a fleet (Prins, 2004). Compiled.

Dynamic programming over the stops of a sequence and the vehicles used: no other plan whose routes
follow the sequence costs less.
"""

import math
from typing import NamedTuple

import numpy as np

from service.fleet.fleet import Rules
from service.fleet.plans import Plan, Route
from service.fleet.splitting.route_table import Array, Indices
from service.jit import allocating, compiled, inlined


class Stock(NamedTuple):
    """The vehicles that there are, of v types, and numbers for what is used of them.

    What is used is one number below `states`: each used vehicle adds the step of its type. Of a
    type with one vehicle for every stop nothing is counted, and the step is 0.
    """

    available: Indices  # (v,)
    step: Indices  # (v,)
    states: int


def states_of(rules: Rules) -> int:
    """Return how many states the stock of a fleet has, which may be more than an array can."""
    clients = len(rules.clients)
    counted = (vehicle.count for vehicle in rules.vehicles if vehicle.count < clients)
    return math.prod(count + 1 for count in counted)


def stock_of(rules: Rules) -> Stock:
    """Return the vehicles of a fleet that has few states."""
    counts, steps, states = [], [], 1
    for vehicle in rules.vehicles:
        enough = vehicle.count >= len(rules.clients)
        counts.append(vehicle.count)
        steps.append(0 if enough else states)
        states *= 1 if enough else vehicle.count + 1
    return Stock(np.array(counts, np.int64), np.array(steps, np.int64), states)


class RouteCosts(NamedTuple):
    """The costs of the routes along a cyclic sequence of c stops.

    Routes are indexed as in a table of routes: by type, first place, and number of stops less one.
    """

    cost: Array  # (v, c, most), infinite where a route breaks a rule
    bounded: Array  # (v, c, most), the length that a limit bounds
    skipping: Array  # (c,), what it costs to leave a stop out; infinite where that is not allowed


@allocating
def best_split(
    stock: Stock, routes: RouteCosts, begins: int, limit: float
) -> tuple[float, Indices]:
    """Return the least cost of a plan whose routes follow a sequence, and these routes.

    Args:
        stock: The vehicles.
        routes: The routes to choose from.
        begins: How many places the first route may begin at: the first ones of the sequence. With
            as many as the longest route has stops the plan is the best of all.
        limit: What each route must be shorter than.

    Returns:
        The cost, infinite where there is no plan; and the routes, shape (m, 3): type, first place,
        and number of stops.
    """
    c = len(routes.skipping)
    cost = np.where(routes.bounded < limit, routes.cost, np.inf)
    partials = PartialPlans(
        np.empty((c + 1, stock.states)), np.empty((c + 1, stock.states, 3), np.int64)
    )
    best, best_routes = np.inf, np.empty((0, 3), np.int64)
    for begin in range(begins):
        _fill(stock, cost, routes.skipping, begin, partials)
        used = partials.least[c].argmin()
        if partials.least[c, used] < best:
            best = partials.least[c, used]
            best_routes = _read(partials.choices, begin, used)
    return best, best_routes


class PartialPlans(NamedTuple):
    """The least costs of visiting the first stops after a begin, by how many and by what is used.

    A choice is the last step there: the type of the last route, -1 where the last stop is left
    out; its number of stops; and what was used before.
    """

    least: Array  # (c + 1, states)
    choices: Indices  # (c + 1, states, 3)


@compiled
def _fill(stock: Stock, cost: Array, skipping: Array, begin: int, partials: PartialPlans) -> None:
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
                choices[visited + 1, used] = -1, 1, used
            _add_routes(stock, cost[:, place], partials, visited, used)


@inlined
def _add_routes(stock: Stock, cost: Array, partials: PartialPlans, visited: int, used: int) -> None:
    """Write what one more route, with a cost of shape (v, most), leads to from a partial plan."""
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
                choices[visited + count, used + step] = vehicle, count, used


@allocating
def _read(choices: Indices, begin: int, used: int) -> Indices:
    """Return the routes that lead to a place in the last row of choices, shape (m, 3)."""
    c = visited = len(choices) - 1
    found = np.empty((c, 3), np.int64)
    m = 0
    while visited > 0:
        vehicle, count, before = choices[visited, used]
        visited -= count
        used = before
        if vehicle >= 0:
            found[m] = vehicle, (begin + visited) % c, count
            m += 1
    return found[:m][::-1].copy()


def plan_of(sequence: Indices, routes: Indices) -> Plan:
    """Return the plan of routes, shape (m, 3), along a cyclic sequence."""
    places = len(sequence)
    return Plan(
        tuple(
            Route(vehicle, tuple(sequence[(first + np.arange(count)) % places].tolist()))
            for vehicle, first, count in routes.tolist()
        )
    )
