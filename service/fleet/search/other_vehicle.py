"""Give a whole route to a vehicle of another type: where that costs less, or to fill it."""

import numpy as np

from service.fleet.search.changes import save_slot
from service.fleet.search.problem import Problem
from service.fleet.search.route import measure
from service.fleet.search.values import route_cost, values_of
from service.fleet.search.waits import bound
from service.fleet.search.working_plan import (
    SAVED,
    TYPE,
    TYPES_END,
    USED,
    State,
    WorkingPlan,
    any_type,
    free_slot,
)
from service.jit import compiled, inlined, standalone
from service.search.local_search import random_below

SELDOM = 4  # change_vehicles() is called one time in so many
_ONE_TYPE = 4  # one iteration in so many begins routes of one type alone
_ANY_TYPE = 4  # and one in so many of these, of any type, not of one in use


@standalone
def change_vehicles(state: State) -> None:
    """Let vehicles of other types drive the routes that changed, where that costs less."""
    for number in range(state.plan.counts[SAVED]):
        _change_vehicle(state, state.plan.saved[number])


@compiled
def _change_vehicle(state: State, slot: int) -> None:
    """Let a vehicle of another type drive a route, if one is free and it costs less."""
    problem, plan, _ = state
    if plan.size[slot] == 0:
        return
    best, least = -1, plan.cost[slot]
    for kind in range(len(problem.capacity)):
        other = free_slot(problem, plan, kind) if kind != problem.kind[slot] else -1
        if other < 0 or not _holds(problem, plan, slot, kind):
            continue
        cost = _cost_by(state, slot, other)
        if cost < least:
            best, least = other, cost
    if best >= 0:
        _exchange(state, slot, best, plan.cost[slot])


@standalone
def choose_type(state: State) -> None:
    """Choose at random whether this iteration begins routes of one type of vehicles, and of which.

    A route that lost stops is then given to that type, so that a larger vehicle can be filled.
    """
    problem, plan, _ = state
    any_type(problem, plan)
    if random_below(plan.random, _ONE_TYPE) > 0:
        return
    kind = random_below(plan.random, len(problem.capacity))
    if plan.counts[USED] > 0 and random_below(plan.random, _ANY_TYPE) > 0:
        kind = problem.kind[plan.used[random_below(plan.random, plan.counts[USED])]]
    plan.counts[TYPE], plan.counts[TYPES_END] = kind, kind + 1
    if plan.counts[SAVED] > 0:
        _give(state, plan.saved[random_below(plan.random, plan.counts[SAVED])], kind)


@standalone
def _give(state: State, slot: int, kind: int) -> None:
    """Give a route to a type of vehicles, if one is free and can drive it, at any cost."""
    problem, plan, _ = state
    other = free_slot(problem, plan, kind) if kind != problem.kind[slot] else -1
    if other < 0 or plan.size[slot] == 0 or not _holds(problem, plan, slot, kind):
        return
    _exchange(state, slot, other, np.inf)


@compiled
def _exchange(state: State, slot: int, other: int, most: float) -> None:
    """Put a route into a slot without stops, unless it breaks a rule there or costs more."""
    problem, plan, _ = state
    save_slot(problem, plan, slot)
    save_slot(problem, plan, other)
    _move(problem, plan, slot, other)
    measure(state, slot)
    if not measure(state, other) or plan.cost[other] > most:
        _move(problem, plan, other, slot)
        measure(state, other)
        measure(state, slot)


@inlined
def _holds(problem: Problem, plan: WorkingPlan, slot: int, kind: int) -> bool:
    """Return whether a type of vehicles may hold what a route of one trip brings.

    Where vehicles load again differs by type, so routes of more trips stay with theirs.
    """
    fits = plan.trips[slot] <= 1
    if problem.ships:
        return fits
    start = len(problem.demand) + 2 * slot
    for dimension in range(plan.load.shape[1]):
        load = plan.later[start, dimension] if problem.takes else plan.load[slot, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@inlined
def _cost_by(state: State, slot: int, other: int) -> float:
    """Return what a route costs in another slot; infinite if it breaks a rule there.

    Of a vehicle that drives alike it is known without a trial, but for its times.
    """
    problem, plan, _ = state
    n = len(problem.demand)
    alike = problem.profile[slot] == problem.profile[other]
    for end in range(2):
        alike &= problem.place[n + 2 * slot + end] == problem.place[n + 2 * other + end]
    if alike and problem.clock < 0 and not problem.weighs:
        return route_cost(state, problem.kind[other], values_of(plan, slot))
    return _tried(state, slot, other)


@compiled
def _tried(state: State, slot: int, other: int) -> float:
    """Return what a route costs in another slot, by moving it there and back."""
    problem, plan, _ = state
    _move(problem, plan, slot, other)
    measure(state, slot)
    fits = measure(state, other)
    cost = plan.cost[other]
    _move(problem, plan, other, slot)
    measure(state, other)
    measure(state, slot)
    return cost if fits else np.inf


@inlined
def _move(problem: Problem, plan: WorkingPlan, slot: int, other: int) -> None:
    """Put all stops of a route into a slot without stops."""
    n = len(problem.demand)
    start, to = n + 2 * slot, n + 2 * other
    first, last = plan.next[start], plan.previous[start + 1]
    plan.next[to], plan.previous[first] = first, to
    plan.next[last], plan.previous[to + 1] = to + 1, last
    plan.next[start], plan.previous[start + 1] = start + 1, start
    node = first
    while node != to + 1:
        plan.route[node] = other
        node = plan.next[node]
    if problem.waits.given:  # once all know which stops ride with them
        node = first
        while node != to + 1:
            bound(problem, plan, node, other)
            node = plan.next[node]
