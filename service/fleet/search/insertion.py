"""Find where a stop costs the least: in the routes of its neighbours, or in one of its own."""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import (
    FIRST,
    LATENESS,
    LOADED,
    RELEASED,
    SECOND,
    Problem,
)
from service.fleet.search.route import (
    Values,
    begin_at,
    head_at,
    joined,
    route_cost,
    stay,
    tail_at,
)
from service.fleet.search.working_plan import (
    BLINKS,
    TRY,
    UNTIL_BLINK,
    USED,
    State,
    WorkingPlan,
    free_slot,
    leg,
)
from service.jit import compiled, inlined
from service.search.local_search import random_below

_is_over = inlined(is_over)

_NEIGHBOURS = 30  # beside which a stop is tried
_FEW = 8  # of them that are in routes: then all routes are tried


class Place(NamedTuple):
    """Where a stop may go: what it costs there, the slot, and the node before it."""

    cost: float
    slot: int
    before: int


@inlined
def best_place(state: State, stop: int, most: float) -> Place:
    """Return the cheapest place for a stop that costs less than `most`; slot -1 if there is none.

    One place in `counts[BLINKS]` is passed by, on the mean.
    """
    problem, plan, direction = state
    best = Place(most, -1, -1)
    plan.counts[TRY] += 1
    tried = 0
    neighbours = min(_NEIGHBOURS, problem.near.shape[1])
    for number in range(neighbours):
        beside = problem.near[stop, number]
        slot = plan.route[beside]
        if slot < 0:
            continue
        tried += 1
        if not has_room(problem, plan, stop, slot):
            continue
        best = _better(state, stop, slot, beside, best)
        best = _better(state, stop, slot, plan.previous[beside], best)
    if tried < _FEW or best.slot < 0:
        best = _anywhere(state, stop, best)
    if plan.counts[USED] < direction.routes:
        for kind in range(len(problem.capacity)):
            slot = free_slot(problem, plan, kind)
            if slot >= 0 and has_room(problem, plan, stop, slot):
                start = len(problem.demand) + 2 * slot
                best = _better(state, stop, slot, start, best)
    return best


@inlined
def _anywhere(state: State, stop: int, best: Place) -> Place:
    """Return the cheapest place in all routes."""
    problem, plan, _ = state
    n = len(problem.demand)
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        if not has_room(problem, plan, stop, slot):
            continue
        node = n + 2 * slot
        while node != n + 2 * slot + 1:
            best = _better(state, stop, slot, node, best)
            node = plan.next[node]
    return best


@inlined
def has_room(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Return whether a vehicle can carry one more stop's load."""
    kind = problem.kind[slot]
    fits = True
    for dimension in range(plan.load.shape[1]):
        load = plan.load[slot, dimension] + problem.demand[stop, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@inlined
def _better(
    state: State,
    stop: int,
    slot: int,
    before: int,
    best: Place,
) -> Place:
    """Return the better of two places: the best so far, and that after a node."""
    plan = state.plan
    if plan.tried[before] == plan.counts[TRY]:
        return best
    plan.tried[before] = plan.counts[TRY]
    plan.counts[UNTIL_BLINK] -= 1
    if plan.counts[UNTIL_BLINK] <= 0:
        plan.counts[UNTIL_BLINK] = 1 + random_below(plan.random, 2 * plan.counts[BLINKS] - 1)
        return best
    cost = insertion_cost(state, stop, slot, before, best.cost)
    return Place(cost, slot, before) if cost < best.cost else best


@compiled
def insertion_cost(state: State, stop: int, slot: int, before: int, most: float) -> float:
    """Return what the cost of a route grows by with a stop after a node; inf if a rule forbids it.

    What costs at least `most` may be told as more. If a visit is due, a route may turn out longer:
    then its vehicle cannot leave as late as is assumed here.
    """
    problem, plan, direction = state
    after = plan.next[before]
    a, b = problem.place[before], problem.place[after]
    first = leg(problem, a, stop, 0) + leg(problem, stop, b, 0) - plan.step[after, 0]
    if first >= 0.5 * problem.forbidden:
        return np.inf
    second = leg(problem, a, stop, 1) + leg(problem, stop, b, 1) - plan.step[after, 1]
    loaded = plan.value[slot, LOADED]
    if direction.load_distance > 0:
        loaded += _loaded(problem, plan, stop, before, first)
    first += plan.value[slot, FIRST]
    second += plan.value[slot, SECOND]
    kind, end = problem.kind[slot], 0.0
    if problem.clock >= 0:
        time, end = _timed(problem, plan, stop, slot, before)
        if time == np.inf:
            return np.inf
        first = time if problem.clock == 0 else first
        second = time if problem.clock == 1 else second
    if _is_over(first if problem.limited == 0 else second, problem.longest[kind], end):
        return np.inf
    overtime = max(0.0, end - problem.shift_end[kind])
    late = plan.value[slot, LATENESS]
    cost = route_cost(state, kind, Values(first, second, overtime, late, loaded))
    cost -= plan.cost[slot]
    if cost < most and (problem.choice or direction.lateness > 0):
        later = _lateness(problem, plan, slot, stop, before)
        return np.inf if later == np.inf else cost + direction.lateness * (later - late)
    return cost


@inlined
def _loaded(problem: Problem, plan: WorkingPlan, stop: int, before: int, detour: float) -> float:
    """Return what loads times distances grow by with a stop after a node."""
    to = plan.along[before] + leg(problem, problem.place[before], stop, 0)
    return problem.demand[stop, 0] * to + plan.ahead[plan.next[before]] * detour


@inlined
def _timed(
    problem: Problem, plan: WorkingPlan, stop: int, slot: int, before: int
) -> tuple[float, float]:
    """Return the time that a route takes with a stop after a node, and when it ends.

    The time is infinite where a window is missed.
    """
    after = plan.next[before]
    there = leg(problem, problem.place[before], stop, problem.clock)
    span, kept = joined(head_at(plan, before), there, stay(problem, stop))
    if not kept:
        return np.inf, 0.0
    onward = leg(problem, stop, problem.place[after], problem.clock)
    span, kept = joined(span, onward, tail_at(plan, after))
    departs = max(span.early, problem.release[stop], plan.value[slot, RELEASED])
    end = departs + span.time
    if not kept or _is_over(departs, span.late, end):
        return np.inf, 0.0
    return span.time, end


@inlined
def _lateness(problem: Problem, plan: WorkingPlan, slot: int, stop: int, before: int) -> float:
    """Return the lateness of a route with a stop after a node; infinite if a window is missed."""
    end = len(problem.demand) + 2 * slot + 1
    late, ready, node = plan.late[before], plan.ready[before], before
    released = problem.release[stop]
    if released > plan.value[slot, RELEASED] and released > problem.departs[problem.kind[slot]]:
        # The vehicle leaves later, so all times change.
        late, ready, node = 0.0, released, end - 1
        while node != before:
            ready, late = _visited(problem, node, plan.next[node], ready, late)
            node = plan.next[node]
    ready, late = _visited(problem, before, stop, ready, late)
    here, node = stop, plan.next[before]
    while node != end:
        ready, late = _visited(problem, here, node, ready, late)
        if ready <= plan.ready[node]:
            return late + plan.late[end] - plan.late[node]
        here, node = node, plan.next[node]
    ready += leg(problem, problem.place[here], problem.place[end], problem.clock)
    missed = ready == np.inf or _is_over(ready, problem.returns[problem.kind[slot]])
    return np.inf if missed else late


@inlined
def _visited(
    problem: Problem, node: int, stop: int, ready: float, late: float
) -> tuple[float, float]:
    """Return when the visit of a stop ends, and the lateness after it."""
    way = leg(problem, problem.place[node], stop, problem.clock)
    begin = begin_at(problem, stop, ready + way)
    if _is_over(begin, problem.due[stop]):
        late += begin - problem.due[stop]
    return begin + problem.service[stop], late
