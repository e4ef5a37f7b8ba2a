"""Choose anew where a vehicle loads again on its route: a shortest path over its stops."""

import numpy as np

from service.fleet.search.problem import Problem
from service.fleet.search.route import measure
from service.fleet.search.values import at_prices
from service.fleet.search.working_plan import State, WorkingPlan, leg, way
from service.jit import inlined, standalone

SELDOM = 2  # load_anew() is called one time in so many: so plans that load elsewhere are met too


@standalone
def load_anew(state: State, slot: int) -> None:
    """Let the vehicle of a route load where that adds the least to its legs, if that costs less.

    Where the route would break another rule, it stays as it is.
    """
    problem, plan, _ = state
    if problem.reload[problem.kind[slot], 0] < 0 or plan.size[slot] == 0:
        return
    size = _list_stops(problem, plan, slot)
    before = plan.cost[slot]
    if not _find_trips(state, slot, size):
        return
    changed, end = False, size
    for place in range(size):
        plan.via[plan.buffer[place]] = -1
    while end > 0:
        begin = plan.begins[end]
        plan.via[plan.buffer[begin]] = plan.loads_at[end]
        end = begin
    for place in range(size):
        changed |= plan.via[plan.buffer[place]] != plan.vias[place]
    if changed and (not measure(state, slot) or plan.cost[slot] > before):
        for place in range(size):
            plan.via[plan.buffer[place]] = plan.vias[place]
        measure(state, slot)


@inlined
def _list_stops(problem: Problem, plan: WorkingPlan, slot: int) -> int:
    """Write the stops of a route and where its vehicle loads before each; return their number."""
    start, size = len(problem.demand) + 2 * slot, 0
    node = plan.next[start]
    while node != start + 1:
        plan.buffer[size], plan.vias[size] = node, plan.via[node]
        size += 1
        node = plan.next[node]
    return size


@inlined
def _find_trips(state: State, slot: int, size: int) -> bool:
    """Write where the last trip to each stop begins; return whether every trip fits.

    The cheapest way to have served so many stops, when a trip ends there, leads on to each stop
    that the next trip can end at.
    """
    problem, plan, _ = state
    for end in range(1, size + 1):
        plan.least[end] = np.inf
    plan.least[0] = 0.0
    for begin in range(size):
        if plan.least[begin] == np.inf:
            continue
        if begin == 0:
            _reach(problem, plan, slot, (0, size), (-1, 0.0))
        via, detour = _loading(state, slot, begin)
        _reach(problem, plan, slot, (begin, size), (via, plan.least[begin] + detour))
    return plan.least[size] < np.inf


@inlined
def _loading(state: State, slot: int, place: int) -> tuple[int, float]:
    """Return where a vehicle loads best before the stop at a place of its route, and the detour."""
    problem, plan, direction = state
    kind, profile, stop = problem.kind[slot], problem.profile[slot], plan.buffer[place]
    start = problem.place[len(problem.demand) + 2 * slot]
    before = plan.buffer[place - 1] if place > 0 else start
    best, least = -1, np.inf
    for number in range(problem.reload.shape[1]):
        via = problem.reload[kind, number]
        if via < 0:
            break
        first = way(problem, profile, before, via, stop, 0)
        first -= leg(problem, profile, before, stop, 0)
        second = way(problem, profile, before, via, stop, 1)
        second -= leg(problem, profile, before, stop, 1)
        detour = direction.costs[0] * first + direction.costs[1] * second
        if problem.priced:
            detour += direction.fixed * at_prices(problem, kind, first, second)
        if detour < least:
            best, least = via, detour
    return best, least


@inlined
def _reach(
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    span: tuple[int, int],
    loading: tuple[int, float],
) -> None:
    """Note all trips from a place of a route on whose load the vehicle can hold."""
    begin, size = span
    via, cost = loading
    kind = problem.kind[slot]
    for dimension in range(plan.load.shape[1]):
        plan.held[dimension] = 0
    for place in range(begin, size):
        fits = True
        for dimension in range(plan.load.shape[1]):
            plan.held[dimension] += problem.demand[plan.buffer[place], dimension]
            most = (problem.whole if via >= 0 else problem.capacity)[kind, dimension]
            fits &= plan.held[dimension] <= most
        if not fits:
            break
        if cost < plan.least[place + 1]:
            plan.least[place + 1] = cost
            plan.begins[place + 1], plan.loads_at[place + 1] = begin, via
