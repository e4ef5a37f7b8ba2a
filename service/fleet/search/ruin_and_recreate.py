"""Take strings of neighbouring stops out of a plan, and put them in again where they cost least.

Christiaens and Vanden Berghe (2020), "Slack induction by string removals for vehicle routing
problems".
"""

import math

import numpy as np
from numpy.typing import NDArray

from service.fleet.search.changes import (
    begin_iteration,
    measure_changed,
    restore,
    save_slot,
)
from service.fleet.search.found import Found, offer
from service.fleet.search.insertion import best_place
from service.fleet.search.problem import Problem
from service.fleet.search.route import measure, measure_with
from service.fleet.search.rows import write_point
from service.fleet.search.working_plan import (
    BLINKS,
    MISSING,
    OUTSIDE,
    REMOVED,
    STAMP,
    UNTIL_BLINK,
    USED,
    State,
    WorkingPlan,
    leave_out,
    link,
    take_in,
    total_cost,
    unlink,
)
from service.jit import compiled, inlined
from service.search.local_search import random_below

Array = NDArray[np.float64]

_REMOVED = 10  # stops that an iteration takes out, on the mean
_LONGEST_STRING = 10
_SPLIT = 2  # one string in so many leaves stops in its middle
_STAYING = 100  # one time in so many, more of them
_MOST_OUTSIDE = 10  # stops outside that an iteration tries to put in
# How stops are sorted before they are inserted: at random, the largest first, the farthest or the
# nearest from where the first vehicle starts, or by their windows. Those that work best are drawn
# most often.
RANDOM, LARGE, FAR, NEAR, NARROW, SOON, OPENING = 0, 4, 6, 7, 8, 9, 10
ORDERS = 11
_FEW_BLINKS, _MANY_BLINKS = 100, 4  # one place in so many for a stop is passed by
_CHANCES = 20  # see _most()
_OFTEN = 10  # one iteration in so many passes by many places
_LONGEST_FIRST = 4  # one ruin in so many begins in the longest route, where that counts


@inlined
def uniform(random: NDArray[np.int64]) -> float:
    """Draw a number above 0 and below 1."""
    return (random_below(random, 1 << 30) + 0.5) / (1 << 30)


@inlined
def remove(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    """Take a stop out of its route, to be inserted later. The route is not measured."""
    unlink(plan, stop)
    leave_out(problem, plan, stop)
    plan.removed[plan.counts[REMOVED]] = stop
    plan.counts[REMOVED] += 1


@inlined
def ruin(state: State) -> None:
    """Take strings of stops out of some routes near a random stop."""
    problem, plan, _ = state
    clients, used = len(problem.clients), plan.counts[USED]
    if used == 0:
        return
    inside = clients - plan.counts[OUTSIDE]
    longest = min(float(_LONGEST_STRING), inside / used)
    most = 4.0 * _REMOVED / (1.0 + longest) - 1.0
    strings = int(1 + uniform(plan.random) * max(0.0, most))
    seed = _seed(state)
    left = strings
    if plan.route[seed] >= 0:
        _take_string(state, seed, longest)
        left -= 1
    for number in range(problem.near.shape[1]):
        if left <= 0:
            return
        stop = problem.near[seed, number]
        slot = plan.route[stop]
        if slot >= 0 and plan.touched[slot] != plan.counts[STAMP]:
            _take_string(state, stop, longest)
            left -= 1


@inlined
def _seed(state: State) -> int:
    """Return a random stop, sometimes one of the longest route where that is over its limit."""
    problem, plan, direction = state
    if direction.longest < np.inf and random_below(plan.random, _LONGEST_FIRST) == 0:
        longest, found = -1.0, plan.used[0]
        for number in range(plan.counts[USED]):
            length = plan.value[plan.used[number], problem.swept]
            if length > longest:
                longest, found = length, plan.used[number]
        node = plan.next[len(problem.demand) + 2 * found]
        for _ in range(random_below(plan.random, plan.size[found])):
            node = plan.next[node]
        return node
    return problem.clients[random_below(plan.random, len(problem.clients))]


@compiled
def _take_string(state: State, stop: int, longest: float) -> None:
    """Take a string of stops around a stop out of its route."""
    problem, plan, _ = state
    slot = plan.route[stop]
    save_slot(problem, plan, slot)
    start = len(problem.demand) + 2 * slot
    size, at = 0, 0
    node = plan.next[start]
    while node != start + 1:
        if node == stop:
            at = size
        plan.buffer[size] = node
        size += 1
        node = plan.next[node]
    length = int(1 + uniform(plan.random) * min(float(size), longest))
    length = min(length, size)
    staying = 0
    if length > 1 and random_below(plan.random, _SPLIT) == 0:
        staying = 1
        while length + staying < size and random_below(plan.random, _STAYING) == 0:
            staying += 1
        staying = min(staying, size - length)
    reach = length + staying
    first = max(0, at - reach + 1)
    first += random_below(plan.random, min(at, size - reach) - first + 1)
    gap = first + 1 + random_below(plan.random, max(1, length - 1))
    for place in range(first, first + reach):
        if not gap <= place < gap + staying:
            remove(problem, plan, plan.buffer[place])
    if not measure(state, slot):
        _dissolve(state, slot)


@compiled
def _dissolve(state: State, slot: int) -> None:
    """Take all stops out of a route."""
    problem, plan, _ = state
    save_slot(problem, plan, slot)
    start = len(problem.demand) + 2 * slot
    while plan.next[start] != start + 1:
        remove(problem, plan, plan.next[start])
    measure(state, slot)


@compiled
def limit_routes(state: State) -> None:
    """Take all stops out of the routes of the fewest, until there are no more than is allowed."""
    _, plan, direction = state
    begin_iteration(plan)
    for _ in range(plan.counts[USED] - direction.routes):
        shortest = plan.used[0]
        for number in range(plan.counts[USED]):
            if plan.size[plan.used[number]] < plan.size[shortest]:
                shortest = plan.used[number]
        _dissolve(state, shortest)


@inlined
def recreate(state: State, order: int) -> None:
    """Insert the removed stops, sorted in an order, where each costs the least."""
    problem, plan, _ = state
    often = random_below(plan.random, _OFTEN) == 0
    plan.counts[BLINKS] = _MANY_BLINKS if often else _FEW_BLINKS
    plan.counts[UNTIL_BLINK] = 1 + random_below(plan.random, 2 * plan.counts[BLINKS] - 1)
    _sort(problem, plan, order)
    for number in range(plan.counts[REMOVED]):
        stop = plan.removed[number]
        place = best_place(state, stop, _most(problem, plan, stop))
        if place.slot < 0:
            continue
        save_slot(problem, plan, place.slot)
        take_in(problem, plan, stop)
        link(plan, place.slot, stop, place.before)
        if not measure_with(state, place.slot, stop):
            # A rounding apart from what was worked out before: a place like any other that is none.
            unlink(plan, stop)
            leave_out(problem, plan, stop)
            measure(state, place.slot)


@inlined
def _most(problem: Problem, plan: WorkingPlan, stop: int) -> float:
    """Return what a stop may cost: its price, or at times anything or nothing if it is optional.

    Two optional stops may pay together where neither does alone.
    """
    if problem.prize[stop] < np.inf:
        chance = random_below(plan.random, _CHANCES)
        if chance == 0:
            return np.inf
        if chance == 1:
            return -np.inf
    return plan.price[stop]


@inlined
def _sort(problem: Problem, plan: WorkingPlan, order: int) -> None:
    """Sort the removed stops in an order."""
    count = plan.counts[REMOVED]
    for place in range(count):
        plan.key[place] = _key(problem, plan, plan.removed[place], order)
    # Shell's sort.
    gap = count // 2
    while gap > 0:
        for place in range(gap, count):
            stop, key, to = plan.removed[place], plan.key[place], place
            while to >= gap and plan.key[to - gap] > key:
                plan.removed[to], plan.key[to] = plan.removed[to - gap], plan.key[to - gap]
                to -= gap
            plan.removed[to], plan.key[to] = stop, key
        gap //= 2


@inlined
def _key(problem: Problem, plan: WorkingPlan, stop: int, order: int) -> float:
    """Return by what a stop is sorted."""
    if order == OPENING:
        return problem.opens[stop]
    if order == SOON:
        return min(problem.closes[stop], problem.due[stop])
    if order == NARROW:
        return problem.closes[stop] - problem.opens[stop]
    if order >= FAR:
        there = problem.place[len(problem.demand)]
        away = problem.costs[max(there, 0), stop, 0]
        return away if order == NEAR else -away
    if order >= LARGE and problem.demand.shape[1] > 0:
        return -float(problem.demand[stop, 0])
    return uniform(plan.random)


@inlined
def _raise_prices(state: State) -> None:
    """Raise the prices of the stops outside that must be visited."""
    problem, plan, direction = state
    for place in range(plan.counts[OUTSIDE]):
        stop = plan.outside[place]
        if problem.prize[stop] == np.inf:
            plan.price[stop] += direction.required


@inlined
def _try_outside(plan: WorkingPlan) -> None:
    """Add some of the stops outside to those that are inserted."""
    outside = plan.counts[OUTSIDE]
    for number in range(min(outside, _MOST_OUTSIDE)):
        place = number
        if outside > _MOST_OUTSIDE:
            place = random_below(plan.random, outside)
        stop = plan.outside[place]
        known = False
        for other in range(plan.counts[REMOVED]):
            known |= plan.removed[other] == stop
        if not known:
            plan.removed[plan.counts[REMOVED]] = stop
            plan.counts[REMOVED] += 1


@compiled
def set_prices(state: State) -> None:
    """Set what each stop costs outside, at first."""
    problem, plan, direction = state
    for number in range(len(problem.clients)):
        stop = problem.clients[number]
        required = problem.prize[stop] == np.inf
        plan.price[stop] = direction.required if required else direction.prize * problem.prize[stop]


@compiled
def insert_all(state: State, order: int) -> None:
    """Insert all stops that are outside, in an order, if they fit."""
    plan = state.plan
    begin_iteration(plan)
    for place in range(plan.counts[OUTSIDE]):
        plan.removed[place] = plan.outside[place]
    plan.counts[REMOVED] = plan.counts[OUTSIDE]
    recreate(state, order)


@compiled
def anneal(
    state: State,
    found: Found,
    ruins: int,
    heat: float,
    cooling: float,
) -> float:
    """Ruin and recreate a plan so many times, and offer each plan that is made.

    Args:
        state: The fleet, the plan to change, and what counts.
        found: Gets all plans that visit all required stops and are nondominated.
        ruins: How often.
        heat: The temperature at first.
        cooling: The factor of the temperature in each iteration.

    Returns:
        The temperature at the end.
    """
    problem, plan, _ = state
    beyond = _beyond(state, found)
    for _ in range(ruins):
        before = total_cost(plan) + beyond
        begin_iteration(plan)
        _try_outside(plan)
        ruin(state)
        recreate(state, random_below(plan.random, ORDERS))
        exceeding = _beyond(state, found)
        after = total_cost(plan) + exceeding
        if plan.counts[MISSING] > 0:
            _raise_prices(state)
        else:
            offer(problem, plan, found)
        if after > before - heat * math.log(uniform(plan.random)):
            restore(state)
        else:
            beyond = exceeding
            measure_changed(state)
        heat *= cooling
    return heat


@inlined
def _beyond(state: State, found: Found) -> float:
    """Write the point of a plan, and return what it costs that it is beyond bounds."""
    problem, plan, direction = state
    if plan.counts[MISSING] > 0:
        return 0.0
    write_point(problem, plan, found.point)
    cost = 0.0
    for objective in range(len(direction.bounds)):
        if found.point[objective] > direction.bounds[objective]:
            excess = found.point[objective] - direction.bounds[objective]
            cost += direction.strict[objective] * excess
    return cost
