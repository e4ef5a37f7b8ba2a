"""Where a stop costs the least: in the routes of its neighbours, or in one of its own."""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import Direction, Problem
from service.fleet.search.working_plan import (
    BLINKS,
    FIRST,
    LATE,
    LOADED,
    RELEASED,
    SECOND,
    USED,
    Span,
    WorkingPlan,
    free_slot,
    head_at,
    joined,
    leg,
    route_cost,
    stay,
    tail_at,
)
from service.jit import compiled, inlined
from service.search.local_search import random_below

_is_over = inlined(is_over)

_NEIGHBOURS = 40  # beside which a stop is tried
_FEW = 8  # of them that are in routes: then all routes are tried


class Place(NamedTuple):
    """Where a stop may go: what it costs there, the slot, and the node before it."""

    cost: float
    slot: int
    before: int


@compiled
def best_place(
    problem: Problem, plan: WorkingPlan, direction: Direction, stop: int, most: float
) -> Place:
    """Return the cheapest place for a stop that costs less than `most`; slot -1 if there is none.

    One place in `counts[BLINKS]` is passed by at random.
    """
    best = Place(most, -1, -1)
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
        best = _better(problem, plan, direction, stop, slot, beside, best)
        best = _better(problem, plan, direction, stop, slot, plan.previous[beside], best)
    if tried < _FEW or best.slot < 0:
        best = _anywhere(problem, plan, direction, stop, best)
    if plan.counts[USED] < direction.routes:
        for kind in range(len(problem.capacity)):
            slot = free_slot(problem, plan, kind)
            if slot >= 0 and has_room(problem, plan, stop, slot):
                start = len(problem.demand) + 2 * slot
                best = _better(problem, plan, direction, stop, slot, start, best)
    return best


@inlined
def _anywhere(
    problem: Problem, plan: WorkingPlan, direction: Direction, stop: int, best: Place
) -> Place:
    """Return the cheapest place in all routes."""
    n = len(problem.demand)
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        if not has_room(problem, plan, stop, slot):
            continue
        node = n + 2 * slot
        while node != n + 2 * slot + 1:
            best = _better(problem, plan, direction, stop, slot, node, best)
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
    problem: Problem,
    plan: WorkingPlan,
    direction: Direction,
    stop: int,
    slot: int,
    before: int,
    best: Place,
) -> Place:
    """Return the better of two places: the best so far, and that after a node."""
    if random_below(plan.random, plan.counts[BLINKS]) == 0:
        return best
    cost = insertion_cost(problem, plan, direction, stop, slot, before, best.cost)
    return Place(cost, slot, before) if cost < best.cost else best


@compiled
def insertion_cost(
    problem: Problem,
    plan: WorkingPlan,
    direction: Direction,
    stop: int,
    slot: int,
    before: int,
    most: float,
) -> float:
    """Return what the cost of a route grows by with a stop after a node; inf if a rule forbids it.

    What costs at least `most` may be told as more.
    """
    kind = problem.kind[slot]
    after = plan.next[before]
    a, b = problem.place[before], problem.place[after]
    to = leg(problem, a, stop, 0)
    first = to + leg(problem, stop, b, 0) - leg(problem, a, b, 0)
    second = leg(problem, a, stop, 1) + leg(problem, stop, b, 1) - leg(problem, a, b, 1)
    if first >= 0.5 * problem.forbidden:
        return np.inf
    loaded = plan.value[slot, LOADED]
    if direction.load_distance > 0:
        brought = problem.demand[stop, 0]
        loaded += brought * (plan.along[before] + to) + plan.ahead[after] * first
    overtime = 0.0
    if problem.clock < 0:
        first += plan.value[slot, FIRST]
        second += plan.value[slot, SECOND]
        length = first if problem.limited == 0 else second
        if _is_over(length, problem.longest[kind]):
            return np.inf
    else:
        there = leg(problem, a, stop, problem.clock)
        onward = leg(problem, stop, b, problem.clock)
        span, kept = joined(head_at(plan, before), there, stay(problem, stop))
        if not kept:
            return np.inf
        span, kept = joined(span, onward, tail_at(plan, after))
        departs = max(span.early, problem.release[stop], plan.value[slot, RELEASED])
        if not kept or _is_over(departs, span.late, departs + span.time):
            return np.inf
        end = departs + span.time
        first = span.time if problem.clock == 0 else first + plan.value[slot, FIRST]
        second = span.time if problem.clock == 1 else second + plan.value[slot, SECOND]
        length = first if problem.limited == 0 else second
        if _is_over(length, problem.longest[kind], end):
            return np.inf
        overtime = max(0.0, end - problem.shift_end[kind])
    late = plan.value[slot, LATE]
    cost = route_cost(problem, direction, kind, first, second, overtime, late, loaded)
    cost -= plan.cost[slot]
    if cost < most and direction.lateness > 0:
        late = _lateness(problem, plan, slot, stop, before)
        cost = route_cost(problem, direction, kind, first, second, overtime, late, loaded)
        cost -= plan.cost[slot]
    return cost


@inlined
def _lateness(problem: Problem, plan: WorkingPlan, slot: int, stop: int, before: int) -> float:
    """Return the lateness of a route with a stop after a node."""
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
    return late


@inlined
def _visited(
    problem: Problem, node: int, stop: int, ready: float, late: float
) -> tuple[float, float]:
    """Return when the visit of a stop ends, and the lateness after it."""
    way = leg(problem, problem.place[node], stop, problem.clock)
    begin = max(ready + way, problem.opens[stop])
    if _is_over(begin, problem.due[stop]):
        late += begin - problem.due[stop]
    return begin + problem.service[stop], late
