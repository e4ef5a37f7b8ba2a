"""Find where a shipment costs the least: a place for its pick-up, and a later one to deliver.

Pairs of places in a route are tried one after another, so that each costs a few sums.
"""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay
from service.fleet.search.insertion import blinks, new_slot
from service.fleet.search.problem import (
    FIRST,
    LOADED,
    SECOND,
    Problem,
)
from service.fleet.search.route import measure
from service.fleet.search.spans import Span, head_at, joined, stay, times_with
from service.fleet.search.spots import Place, nowhere
from service.fleet.search.values import Values, drives_too_far, grown_cost, values_of
from service.fleet.search.weighed import weighed_with
from service.fleet.search.working_plan import (
    TRY,
    TYPE,
    TYPES_END,
    USED,
    State,
    WorkingPlan,
    leg,
    link,
    unlink,
    way,
)
from service.jit import compiled, inlined, standalone

_is_over = inlined(is_over)

_NEIGHBOURS = 30  # of each stop, in whose routes a shipment is tried
_FEW = 4  # routes of neighbours: then all routes are tried


class _Begun(NamedTuple):
    """A route with a pick-up after a node, up to a later node.

    Attributes:
        before: The node before the pick-up.
        at: The later node; the pick-up itself at first.
        span: The times of the route up to it.
        first: What the first costs of the legs grow by so far; until the end of the leg after it.
        second: The same of the second costs.
        carried: The first costs from the pick-up to the later node.
    """

    before: int
    at: int
    span: Span
    first: float
    second: float
    carried: float


@inlined
def best_pair(state: State, pickup: int, most: float) -> Place:
    """Return the cheapest places for a shipment that costs less than `most`; slot -1 if none is."""
    problem, plan, _ = state
    best = nowhere(most)
    plan.counts[TRY] += 1
    best, tried = _near(state, pickup, pickup, best)
    best, more = _near(state, pickup, problem.delivery[pickup], best)
    if tried + more < _FEW or best.slot < 0:
        for number in range(plan.counts[USED]):
            best = _in_route(state, pickup, plan.used[number], best)
    for kind in range(plan.counts[TYPE], plan.counts[TYPES_END]):
        slot = new_slot(state, kind)
        if slot >= 0:
            best = _in_route(state, pickup, slot, best)
    return best


@compiled
def _near(state: State, pickup: int, stop: int, best: Place) -> tuple[Place, int]:
    """Return the best place so far or in the routes of a stop's neighbours, and how many."""
    problem, plan, _ = state
    tried = 0
    for number in range(min(_NEIGHBOURS, problem.near.shape[1])):
        slot = plan.route[problem.near[stop, number]]
        if slot >= 0 and plan.tried[len(problem.demand) + 2 * slot] != plan.counts[TRY]:
            tried += 1
            best = _in_route(state, pickup, slot, best)
    return best, tried


@standalone
def _in_route(state: State, pickup: int, slot: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and the best in a route not tried yet."""
    problem, plan, _ = state
    start = len(problem.demand) + 2 * slot
    if plan.tried[start] == plan.counts[TRY]:
        return best
    plan.tried[start] = plan.counts[TRY]
    before = start
    while before != start + 1:
        if _holds(problem, plan, pickup, slot, before):
            best = _picked_up(state, pickup, slot, before, best)
        before = plan.next[before]
    return best


@inlined
def _holds(problem: Problem, plan: WorkingPlan, pickup: int, slot: int, node: int) -> bool:
    """Return whether a vehicle that leaves a node can hold the load of a shipment as well."""
    kind, fits = problem.kind[slot], True
    for dimension in range(plan.on.shape[1]):
        load = plan.on[node, dimension] + problem.demand[pickup, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@inlined
def _picked_up(state: State, pickup: int, slot: int, before: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and the best with the pick-up here."""
    problem, plan, _ = state
    end, profile = len(problem.demand) + 2 * slot + 1, problem.profile[slot]
    a, following = problem.place[before], plan.next[before]
    span, kept = Span(0.0, 0.0, 0.0), True
    if problem.clock >= 0:
        there = leg(problem, profile, a, pickup, problem.clock)
        span, kept = joined(head_at(plan, before), there, stay(problem, profile, pickup))
    if not kept:
        return best
    b = problem.place[following]
    first = way(problem, profile, a, pickup, b, 0) - plan.step[following, 0]
    second = way(problem, profile, a, pickup, b, 1) - plan.step[following, 1]
    at, carried = pickup, 0.0
    for _ in range(plan.size[slot] + 1):
        begun = _Begun(before, at, span, first, second, carried)
        best = _delivered(state, pickup, slot, begun, best)
        if following == end or not _holds(problem, plan, pickup, slot, following):
            break
        carried += leg(problem, profile, at, following, 0)
        if problem.clock >= 0:
            time = leg(problem, profile, at, following, problem.clock)
            span, kept = joined(span, time, stay(problem, profile, following))
            if not kept:
                break
        at = following
        following = plan.next[following]
    return best


@inlined
def _delivered(state: State, pickup: int, slot: int, begun: _Begun, best: Place) -> Place:
    """Return the better of two places: the best so far, and that with the delivery next."""
    problem, plan, direction = state
    if blinks(plan):
        return best
    delivery, at, profile = problem.delivery[pickup], begun.at, problem.profile[slot]
    after = plan.next[begun.before if at == pickup else at]
    b, known = problem.place[after], values_of(plan, slot)
    to, away = leg(problem, profile, at, delivery, 0), leg(problem, profile, delivery, b, 0)
    detour = to + away - leg(problem, profile, at, b, 0)
    first = begun.first + detour
    second = way(problem, profile, at, delivery, b, 1) - leg(problem, profile, at, b, 1)
    if _is_too_far(problem.day, problem, plan, slot, (first, second + begun.second)):
        return best
    loaded = plan.value[slot, LOADED]
    if direction.load_distance > 0:
        onto = plan.ahead[plan.next[begun.before]]
        loaded += problem.demand[pickup, 0] * (begun.carried + to)
        loaded += onto * begun.first + plan.ahead[after] * detour
    first, end = first + plan.value[slot, FIRST], 0.0
    second += begun.second + plan.value[slot, SECOND]
    if problem.clock >= 0:
        time, end = _timed(problem, plan, slot, begun, delivery)
        if time == np.inf:
            return best
        first = time if problem.clock == 0 else first
        second = time if problem.clock == 1 else second
    kind = problem.kind[slot]
    if _is_over(first if problem.limited == 0 else second, problem.longest[kind], end):
        return best
    late, weighed = max(0.0, end - problem.shift_end[kind]), weighed_with(state, pickup, slot, at)
    values = Values(first, second, late, known.lateness, loaded, weighed)
    cost = grown_cost(state, slot, 2, values)
    if cost < best.cost and (problem.tried[kind] or problem.choice or direction.lateness > 0):
        cost = _tried(state, pickup, slot, begun.before, at)
    return Place(cost, slot, begun.before, -1, -1, at) if cost < best.cost else best


@inlined
def _is_too_far(
    day: FleetDay | None,
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    legs: tuple[float, float],
) -> bool:
    """Return whether a route has a forbidden leg, or is too far, with so much more of both costs.

    Over the day only a trial says how far it is.
    """
    if legs[0] >= 0.5 * problem.forbidden:
        return True
    if day is None:
        return problem.capped and drives_too_far(problem, plan, slot, legs[0], legs[1])
    return False


@inlined
def _timed(
    problem: Problem, plan: WorkingPlan, slot: int, begun: _Begun, delivery: int
) -> tuple[float, float]:
    """Return the time that a route takes with the delivery next, and when it ends.

    The time is infinite where a window is missed.
    """
    profile, before = problem.profile[slot], begun.at
    after = plan.next[begun.before if before == problem.pickup[delivery] else before]
    there = leg(problem, profile, before, delivery, problem.clock)
    onward = leg(problem, profile, delivery, problem.place[after], problem.clock)
    return times_with(problem, plan, (slot, delivery, after), begun.span, (there, onward))


@compiled
def _tried(state: State, pickup: int, slot: int, before: int, last: int) -> float:
    """Return what a shipment costs in a route; infinite if it breaks a rule there."""
    problem, plan, _ = state
    cost = -plan.cost[slot]
    link(plan, slot, pickup, before)
    link(plan, slot, problem.delivery[pickup], last)
    fits = measure(state, slot)
    cost += plan.cost[slot]
    unlink(plan, problem.delivery[pickup])
    unlink(plan, pickup)
    measure(state, slot)
    return cost if fits else np.inf
