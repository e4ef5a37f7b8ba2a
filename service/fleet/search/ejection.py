"""Put a stop that fits nowhere in place of others that are left outside less often.

Nagata and Bräysy (2009), "A powerful route minimization heuristic for the vehicle routing problem
with time windows". What they count by stop are the prices of stops outside, which rise with each
plan that lacks them.
"""

import numpy as np

from service.fleet.search.changes import save_slot
from service.fleet.search.insertion import in_route
from service.fleet.search.recreate import insert
from service.fleet.search.route import measure
from service.fleet.search.spots import Place, nowhere
from service.fleet.search.working_plan import OUTSIDE, TRY, State, leave_out, link, unlink
from service.jit import compiled, standalone
from service.search.local_search import random_below

_SELDOM = 3  # one time in so many, it is tried
_NEIGHBOURS = 40  # with which strings begin
_LONGEST_STRING = 3  # stops that are put outside for one


@standalone
def eject(state: State) -> None:
    """Put a stop that must be visited in place of some near it, if these cost less outside.

    It is tried with one of the stops outside, at random, and not each time. Fleets with shipments,
    stops that ride together, or reloads are left as they are.
    """
    problem, plan, _ = state
    if problem.ships or problem.grouped or problem.reloads or random_below(plan.random, _SELDOM):
        return
    stop = plan.outside[random_below(plan.random, plan.counts[OUTSIDE])]
    if problem.prize[stop] < np.inf:
        return
    best, first, size = nowhere(plan.price[stop]), -1, 0
    for number in range(min(_NEIGHBOURS, problem.near.shape[1])):
        beside = problem.near[stop, number]
        if plan.route[beside] < 0:
            continue
        found, length = _in_place_of(state, stop, beside, best)
        if length > 0:
            best, first, size = found, beside, length
    if size == 0:
        return
    save_slot(problem, plan, best.slot)
    for _ in range(size):
        following = plan.next[first]
        unlink(plan, first)
        leave_out(problem, plan, first)
        first = following
    measure(state, best.slot)
    insert(state, stop, best)


@compiled
def _in_place_of(state: State, stop: int, first: int, best: Place) -> tuple[Place, int]:
    """Return the better of two places, and the length of the string that makes room for it.

    Args:
        state: The search. What it knows of the plan is the same after this.
        stop: The stop.
        first: The first stop of the strings to try.
        best: The best place so far. Its cost has the price of what is put outside in it.

    Returns:
        The better place, and how many stops from the first on make room; 0 for the place so far.
    """
    problem, plan, _ = state
    slot, before, n = plan.route[first], plan.previous[first], len(problem.demand)
    known, price, length, size = plan.cost[slot], 0.0, 0, 0
    most = min(_LONGEST_STRING, plan.size[slot] - 1)
    node = first
    while size < most and node < n and price + plan.price[node] < best.cost:
        price += plan.price[node]
        unlink(plan, node)
        plan.buffer[size] = node
        size += 1
        node = plan.next[before]
        if not measure(state, slot):
            continue
        spared = price + plan.cost[slot] - known
        plan.counts[TRY] += 1
        place = in_route(state, stop, slot, nowhere(best.cost - spared))
        if place.slot >= 0:
            best = Place(place.cost + spared, place.slot, place.before, place.via, place.onward, -1)
            length = size
    for place_in_string in range(size - 1, -1, -1):
        link(plan, slot, plan.buffer[place_in_string], before)
    if size > 0:
        measure(state, slot)
    return best, length
