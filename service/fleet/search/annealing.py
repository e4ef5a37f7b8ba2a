"""Change a plan by ruin and recreate, and accept what is made by simulated annealing."""

import math

from service.fleet.rounding import is_over
from service.fleet.search.changes import begin_iteration, measure_changed, recall
from service.fleet.search.ejection import eject
from service.fleet.search.found import Found, offer
from service.fleet.search.other_vehicle import SELDOM, change_vehicles, choose_type
from service.fleet.search.recreate import ORDERS, raise_prices, recreate, try_outside
from service.fleet.search.rows import write_point
from service.fleet.search.ruin import ruin, uniform
from service.fleet.search.values import lacking, values_of
from service.fleet.search.waits import settle
from service.fleet.search.working_plan import (
    MISSING,
    MORE_TRIPS,
    OUTSIDE,
    SAVED,
    SAVED_OUTSIDE,
    USED,
    State,
    leave_out,
    take_in,
    total_cost,
)
from service.jit import compiled, inlined
from service.search.local_search import random_below

_is_over = inlined(is_over)

_MORE_TRIPS = 2  # one iteration in so many lets vehicles load once more


@compiled
def anneal(
    state: State,
    found: Found,
    ruins: int,
    heat: float,
    cooling: float,
    ends_whole: bool,
) -> tuple[float, int]:
    """Ruin and recreate a plan so many times, and offer each plan that is made.

    Args:
        state: The fleet, the plan to change, and what counts.
        found: Gets all plans that visit all required stops and are nondominated.
        ruins: How often.
        heat: The temperature at first.
        cooling: The factor of the temperature in each iteration.
        ends_whole: Whether to end with the first plan that visits all required stops.

    Returns:
        The temperature at the end, and how often it was done.
    """
    problem, plan, direction = state
    beyond = _beyond(state, found)
    for number in range(ruins):
        before = total_cost(plan) + beyond
        begin_iteration(plan)
        lacked = plan.counts[MISSING] > 0
        _make_another(state)
        kept = not problem.waits.given or settle(state, False)
        exceeding = _beyond(state, found)
        after = total_cost(plan) + exceeding
        lacks = plan.counts[MISSING] > 0
        if lacks and (lacked or not direction.steady):
            raise_prices(state)
        if not lacks and kept and keeps_rules(state):
            offer(problem, plan, found)
        if not kept or after > before - heat * math.log(uniform(plan.random)):
            restore(state)
        else:
            beyond = exceeding
            measure_changed(state)
        heat *= cooling
        if ends_whole and plan.counts[MISSING] == 0:
            return heat, number + 1
    return heat, ruins


@inlined
def _make_another(state: State) -> None:
    """Ruin and recreate the plan."""
    problem, plan, _ = state
    lacked = plan.counts[MISSING] > 0
    try_outside(plan)
    ruin(state)
    if problem.mixed:
        choose_type(state)
    more = problem.reloads and random_below(plan.random, _MORE_TRIPS) == 0
    plan.counts[MORE_TRIPS] = more
    recreate(state, random_below(plan.random, ORDERS))
    if problem.mixed and random_below(plan.random, SELDOM) == 0:
        change_vehicles(state)
    if lacked and plan.counts[MISSING] > 0:
        eject(state)


@inlined
def keeps_rules(state: State) -> bool:
    """Return whether no route is too long or too short, or ends too late."""
    problem, plan, direction = state
    if problem.bounded_below:
        for number in range(plan.counts[USED]):
            slot = plan.used[number]
            if lacking(state, problem.kind[slot], plan.size[slot], values_of(plan, slot)) > 0:
                return False
    if direction.beyond > 0:
        for number in range(plan.counts[USED]):
            slot = plan.used[number]
            values, kind = values_of(plan, slot), problem.kind[slot]
            length = values.first if problem.limited == 0 else values.second
            reach = plan.ready[len(problem.demand) + 2 * slot + 1]
            if _is_over(length, problem.most_length[kind], reach):
                return False
            if _is_over(values.overtime, problem.most_overtime[kind], reach):
                return False
    return True


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


@inlined
def restore(state: State) -> None:
    """Return to the plan before this iteration."""
    problem, plan, _ = state
    counts, n = plan.counts, len(problem.demand)
    while counts[OUTSIDE] > 0:
        take_in(problem, plan, plan.outside[counts[OUTSIDE] - 1])
    for place in range(counts[SAVED_OUTSIDE]):
        stop = plan.saved_outside[place]
        leave_out(problem, plan, stop)
        plan.route[stop] = plan.via[stop] = -1
        if problem.delivery[stop] >= 0:
            plan.route[problem.delivery[stop]] = -1
    first = 0
    for number in range(counts[SAVED]):
        slot = plan.saved[number]
        start, end = n + 2 * slot, n + 2 * slot + 1
        before = start
        for place in range(first, first + plan.saved_size[number]):
            stop = plan.saved_stops[place]
            plan.next[before], plan.previous[stop] = stop, before
            plan.route[stop] = slot
            plan.via[stop] = plan.saved_via[place]
            before = stop
        plan.next[before], plan.previous[end] = end, before
        first += plan.saved_size[number]
    recall(state)  # once all know again which stops ride with them
    if problem.waits.given:
        settle(state, True)
