"""Measure a route: what is known up to each stop and from it on, and what it costs."""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay
from service.fleet.search.on_board import gather
from service.fleet.search.problem import (
    FIRST,
    LATENESS,
    LOADED,
    OVERTIME,
    RELEASED,
    SECOND,
    Array,
    Problem,
)
from service.fleet.search.rests import rested
from service.fleet.search.routes_of_day import drive_over_the_day
from service.fleet.search.spans import Span, head_at, joined, stay, tail_at, times_of
from service.fleet.search.values import drives_too_far, lacking, route_cost, values_of
from service.fleet.search.weighed import weigh
from service.fleet.search.working_plan import (
    USED,
    State,
    WorkingPlan,
    begin_at,
    leg,
    mark_used,
    service_at,
    way,
)
from service.jit import compiled, inlined, standalone

_is_over = inlined(is_over)


@inlined
def _set_span(rows: Array, node: int, span: Span) -> None:
    """Write what is known of a route up to a node, or from it on."""
    rows[node, 0], rows[node, 1], rows[node, 2] = span.time, span.early, span.late


@standalone
def measure(state: State, slot: int) -> bool:
    """Work out what is known along a route and its cost; return whether it keeps all rules."""
    problem, plan, _ = state
    start = len(problem.demand) + 2 * slot
    if plan.next[start] == start + 1:
        _set_empty(problem, plan, slot, start)
        return True
    mark_used(plan, slot)
    fits = gather(problem, plan, slot, start)
    first, second = _sum_legs(problem, plan, slot, start)
    fits &= first < problem.forbidden
    plan.value[slot, FIRST], plan.value[slot, SECOND] = first, second
    if problem.plain:
        _set_ends(problem, plan, slot)
        fits &= set_times(problem, plan, slot, (plan.next[start], plan.previous[start + 1]))
    elif problem.clock >= 0:
        fits &= _drive(problem.day, problem, plan, slot)
        _backward(problem, plan, slot, start)
    if problem.capped:
        fits &= not drives_too_far(problem, plan, slot, 0.0, 0.0)
    if problem.weighs and fits:
        weigh(state, slot)
    fits &= set_cost(state, slot, start + 1)
    plan.plain[slot] = plan.cost[slot]
    if fits and problem.rests[problem.kind[slot]] > 0:
        return _rest(state, slot, start + 1)
    return fits


@inlined
def _set_ends(problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Write when a route may begin and end."""
    start, kind = len(problem.demand) + 2 * slot, problem.kind[slot]
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    _set_span(plan.head, start, Span(0.0, departs, problem.leaves_by[kind]))
    _set_span(plan.tail, start + 1, Span(0.0, 0.0, problem.returns[kind]))


@inlined
def set_times(problem: Problem, plan: WorkingPlan, slot: int, changed: tuple[int, int]) -> bool:
    """Write the plain times along a route; return whether it keeps all windows.

    `changed` are its first and last stop that are new: other times are those before and after them.
    """
    start, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    (node, last), profile = changed, problem.profile[slot]
    span = head_at(plan, plan.previous[node])
    while node != end:
        span, _ = joined(span, plan.step[node, problem.clock], stay(problem, profile, node))
        _set_span(plan.head, node, span)
        node = plan.next[node]
    span, _ = joined(span, plan.step[end, problem.clock], tail_at(plan, end))
    kind, released = problem.kind[slot], plan.value[slot, RELEASED]
    time, plan.ready[end] = times_of(problem, kind, span, released)
    plan.value[slot, problem.clock], plan.late[end] = time, 0.0
    node, span = last, tail_at(plan, plan.next[last])
    while node != start:
        onward = plan.step[plan.next[node], problem.clock]
        span, _ = joined(stay(problem, profile, node), onward, span)
        _set_span(plan.tail, node, span)
        node = plan.previous[node]
    return time < np.inf


@inlined
def _drive(day: FleetDay | None, problem: Problem, plan: WorkingPlan, slot: int) -> bool:
    """Write the times up to each node of a route and how long it takes; return whether it is kept.

    One branch is left where this is compiled: that of the type of the day.
    """
    start = len(problem.demand) + 2 * slot
    if day is None:
        duration, in_time = _forward(problem, plan, slot, start)
        plan.value[slot, problem.clock] = duration
        return in_time
    in_time = drive_over_the_day(day, problem, plan, slot)
    _set_heads(problem, plan, slot, start)
    return in_time


@inlined
def _set_heads(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> None:
    """Write the route up to each node, with the legs as they are at its times."""
    kind, profile = problem.kind[slot], problem.profile[slot]
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    span = Span(0.0, departs, problem.leaves_by[kind])
    _set_span(plan.head, start, span)
    at, node = problem.place[start], plan.next[start]
    while node != start + 1:
        leg_to = plan.step[node, problem.clock]
        if plan.via[node] >= 0:
            away = min(leg_to, leg(problem, profile, at, plan.via[node], problem.clock))
            leg_to -= away
            span, _ = joined(span, away, Span(0.0, plan.released[node], np.inf))
        span, _ = joined(span, leg_to, stay(problem, profile, node))
        _set_span(plan.head, node, span)
        at, node = node, plan.next[node]


@inlined
def _rest(state: State, slot: int, end: int) -> bool:
    """Work out the cost of a route with the breaks of its vehicle; return whether they fit."""
    problem, plan, _ = state
    times = rested(problem, plan, slot)
    if times.end == np.inf:
        return False
    plan.ready[end], plan.late[end] = times.end, times.late
    plan.value[slot, problem.clock] = times.duration
    return set_cost(state, slot, end)


@inlined
def set_cost(state: State, slot: int, end: int) -> bool:
    """Write the cost of a route whose lengths are known; return whether it is short enough."""
    problem, plan, _ = state
    kind = problem.kind[slot]
    reach = overtime = 0.0
    if problem.clock >= 0:
        reach = plan.ready[end]
        overtime = max(0.0, reach - problem.shift_end[kind])
    plan.value[slot, OVERTIME], plan.value[slot, LATENESS] = overtime, plan.late[end]
    plan.cost[slot] = route_cost(state, kind, values_of(plan, slot))
    if problem.bounded_below:
        plan.cost[slot] += lacking(state, kind, plan.size[slot], values_of(plan, slot))
    length = plan.value[slot, FIRST] if problem.limited == 0 else plan.value[slot, SECOND]
    return not _is_over(length, problem.longest[kind], reach)


@inlined
def _set_empty(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> None:
    """Set what is known of a route without stops."""
    end = start + 1
    place = plan.use[slot]
    if place >= 0:
        plan.counts[USED] -= 1
        last = plan.used[plan.counts[USED]]
        plan.used[place] = last
        plan.use[last] = place
        plan.use[slot] = -1
    plan.size[slot] = 0
    plan.cost[slot] = plan.plain[slot] = 0.0
    plan.trips[slot] = 1
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] = 0
        plan.on[start, dimension] = plan.most[start, dimension] = 0
        if problem.takes:
            plan.later[start, dimension] = 0
    for column in range(plan.value.shape[1]):
        plan.value[slot, column] = 0.0
    kind, profile = problem.kind[slot], problem.profile[slot]
    _set_span(plan.head, start, Span(0.0, problem.departs[kind], problem.leaves_by[kind]))
    _set_span(plan.tail, end, Span(0.0, 0.0, problem.returns[kind]))
    plan.ready[start] = problem.departs[kind]
    plan.late[start] = 0.0
    plan.along[start] = 0.0
    plan.ahead[end] = problem.initial[kind]
    for layer in range(plan.step.shape[1]):
        whole = leg(problem, profile, problem.place[start], problem.place[end], layer)
        plan.step[end, layer] = whole


@inlined
def _sum_legs(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> tuple[float, float]:
    """Return the sums of both costs of the legs; write what is known of the first up to each."""
    first = second = loaded = 0.0
    first_trip, kind, profile = True, problem.kind[slot], problem.profile[slot]
    plan.along[start] = 0.0
    at, node = problem.place[start], start
    while node != start + 1:
        node = plan.next[node]
        there, via = problem.place[node], plan.via[node]
        if via >= 0:
            # What was on board from the start, if anything, is unloaded there.
            away = leg(problem, profile, at, via, 0)
            loaded += away * (problem.initial[kind] if first_trip else 0)
            plan.step[node, 0] = away + leg(problem, profile, via, there, 0)
            loaded += (plan.step[node, 0] - away) * plan.ahead[node]
            first_trip = False
        else:
            plan.step[node, 0] = leg(problem, profile, at, there, 0)
            if plan.load.shape[1] > 0:
                loaded += plan.step[node, 0] * plan.ahead[node]
        first += plan.step[node, 0]
        plan.along[node] = first
        plan.step[node, 1] = way(problem, profile, at, via, there, 1)
        second += plan.step[node, 1]
        at = there
    plan.value[slot, LOADED] = loaded
    return first, second


@inlined
def _forward(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> tuple[float, bool]:
    """Write the times up to each node of a route.

    Returns:
        The time from the departure, as early as it may be or as late as makes neither the end later
        nor a visit later than due; and whether the route keeps all windows.
    """
    kind, profile, end = problem.kind[slot], problem.profile[slot], start + 1
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    span = Span(0.0, departs, problem.leaves_by[kind])
    in_time = not _is_over(departs, problem.leaves_by[kind])
    _set_span(plan.head, start, span)
    ready, late = departs, 0.0
    plan.ready[start], plan.late[start] = ready, late
    at, node = problem.place[start], plan.next[start]
    while node != end:
        leg_to = plan.step[node, problem.clock]
        if plan.via[node] >= 0:
            away = leg(problem, profile, at, plan.via[node], problem.clock)
            leg_to -= away
            span, _ = joined(span, away, Span(0.0, plan.released[node], np.inf))
            ready = max(ready + away, plan.released[node])
        begin = begin_at(problem, node, ready + leg_to)
        if _is_over(begin, problem.due[node]):
            late += begin - problem.due[node]
        ready = begin + service_at(problem, profile, node)
        span, _ = joined(span, leg_to, stay(problem, profile, node))
        _set_span(plan.head, node, span)
        plan.ready[node], plan.late[node] = ready, late
        at, node = node, plan.next[node]
    ready += plan.step[end, problem.clock]
    plan.ready[end], plan.late[end] = ready, late
    if not in_time or ready == np.inf or _is_over(ready, problem.returns[kind]):
        return ready - departs, False
    if problem.early:
        return ready - departs, True
    leaves = min(_latest_departure(problem, plan, start, profile), problem.leaves_by[kind])
    return ready - max(departs, leaves), True


@inlined
def _latest_departure(problem: Problem, plan: WorkingPlan, start: int, profile: int) -> float:
    """Return the latest departure of a route that neither ends later nor is later than due."""
    time = plan.ready[start + 1] - plan.step[start + 1, problem.clock]
    node = plan.previous[start + 1]
    while node != start:
        service = service_at(problem, profile, node)
        begin = plan.ready[node] - service
        limit = min(time - service, max(problem.extras.holds[node], begin))
        latest = begin
        if problem.narrow:
            latest = _reached_by(problem, node, begin, plan.ready[node])
        for number in range(problem.windows.shape[1]):
            if problem.windows[node, number, 0] <= limit:
                latest = max(latest, min(limit, problem.windows[node, number, 1]))
        time = latest - plan.step[node, problem.clock]
        node = plan.previous[node]
    return time


@compiled
def _reached_by(problem: Problem, stop: int, begin: float, end: float) -> float:
    """Return the latest arrival at a stop for a visit that begins as its window opens, or later."""
    for number in range(problem.windows.shape[1]):
        opens = problem.windows[stop, number, 0]
        if not (_is_over(opens, begin, end) or _is_over(begin, opens, end)):
            return min(begin, problem.windows[stop, number, 1])
    return begin


@inlined
def _backward(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> None:
    """Write what is known from each node of a route on."""
    span, end = Span(0.0, 0.0, problem.returns[problem.kind[slot]]), start + 1
    profile = problem.profile[slot]
    _set_span(plan.tail, end, span)
    node = plan.previous[end]
    while node != start:
        after = plan.next[node]
        leg_from = plan.step[after, problem.clock]
        if plan.via[after] >= 0:
            away = leg(problem, profile, node, plan.via[after], problem.clock)
            onward = leg_from - away
            span, _ = joined(Span(0.0, plan.released[after], np.inf), onward, span)
            leg_from = away
        span, _ = joined(stay(problem, profile, node), leg_from, span)
        _set_span(plan.tail, node, span)
        node = plan.previous[node]
