"""Drive routes over the day: their costs and times."""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay, Moment, driven, slice_of
from service.fleet.search.departures import best_departure
from service.fleet.search.problem import (
    ARRIVAL,
    EARLINESS,
    FIRST,
    LOADED,
    RELEASED,
    SECOND,
    Problem,
)
from service.fleet.search.working_plan import (
    AS_BEFORE,
    WorkingPlan,
    begin_at,
    service_at,
    slot_of,
)
from service.jit import compiled, inlined, standalone

_is_over = inlined(is_over)


@standalone
def drive_over_the_day(day: FleetDay, problem: Problem, plan: WorkingPlan, slot: int) -> bool:
    """Write the costs and times along a route that leaves at its best departure.

    Return whether it keeps all windows. With `counts[AS_BEFORE]`, it leaves when it did before if
    it keeps them so: its best departure takes several times as long to find.
    """
    kind, start = problem.kind[slot], len(problem.demand) + 2 * slot
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    in_time = not _is_over(departs, problem.leaves_by[kind])
    if in_time and not problem.early and problem.leaves_by[kind] > departs:
        leaves = plan.ready[start]
        kept = plan.counts[AS_BEFORE] and departs < leaves <= problem.leaves_by[kind]
        if kept and drive_from(day, problem, plan, slot, leaves):
            return True
        leaves = best_departure(day, problem, plan, slot)
        if leaves > departs and drive_from(day, problem, plan, slot, leaves):
            return True
    return drive_from(day, problem, plan, slot, departs) and in_time


@compiled
def drive_from(
    day: FleetDay, problem: Problem, plan: WorkingPlan, slot: int, departure: float
) -> bool:
    """Write the costs and times along a route that leaves at a time; return whether it is in time.

    Of a route that misses a window nothing is known from there on.
    """
    kind = problem.kind[slot]
    start, end = _ends(problem, slot)
    first, second, loaded, first_trip = 0.0, 0.0, 0.0, True
    moment = _moment(day, departure)
    plan.ready[start], plan.late[start], plan.along[start] = departure, 0.0, 0.0
    plan.value[slot, EARLINESS] = plan.value[slot, ARRIVAL] = 0.0
    at, node = problem.place[start], plan.next[start]
    while True:
        away, on = 0.0, 0.0
        if plan.via[node] >= 0:
            # What was on board from the start, if anything, is unloaded there.
            moment = driven(day, (at, plan.via[node]), kind, moment.time, moment.slice)
            away, on = moment.first, moment.second
            loaded += away * (problem.initial[kind] if first_trip else 0)
            first_trip, at = False, plan.via[node]
            moment = _moment(day, max(moment.time, plan.released[node]))
        moment = driven(day, (at, problem.place[node]), kind, moment.time, moment.slice)
        loaded += moment.first * plan.ahead[node]
        plan.step[node, 0], plan.step[node, 1] = away + moment.first, on + moment.second
        first, second = first + plan.step[node, 0], second + plan.step[node, 1]
        plan.along[node] = first
        if node == end:
            break
        ready = _visited(problem, plan, slot, node, moment.time)
        if ready == np.inf:
            return False
        moment = _moment(day, ready)
        at, node = node, plan.next[node]
    plan.ready[end], plan.late[end] = moment.time, plan.late[plan.previous[end]]
    plan.value[slot, FIRST], plan.value[slot, SECOND], plan.value[slot, LOADED] = (
        first,
        second,
        loaded,
    )
    plan.value[slot, day.clock] = moment.time - departure
    return not _is_over(moment.time, problem.returns[kind])


@compiled
def driven_with(
    day: FleetDay, problem: Problem, plan: WorkingPlan, where: tuple[int, int], leaves: float
) -> tuple[float, float, float]:
    """Return both costs of a route with one more stop, and when it ends.

    Its vehicle loads once. The end is infinite if a visit is late.

    Args:
        day: The day.
        problem: The fleet.
        plan: Where the route is; it is not changed.
        where: The stop, and the node after which it is put.
        leaves: When the vehicle leaves, as now or before.
    """
    stop, before = where
    slot = slot_of(problem, plan, before)
    kind, (start, end) = problem.kind[slot], _ends(problem, slot)
    first, second, reach = plan.value[slot, FIRST], plan.value[slot, SECOND], plan.ready[end]
    as_now, passed = leaves == plan.ready[start], False
    node = before if as_now else start
    moment = _moment(day, plan.ready[node] if as_now else leaves)
    while True:
        at = problem.place[node]
        node = stop if node == before else plan.next[before if node == stop else node]
        moment = driven(day, (at, problem.place[node]), kind, moment.time, moment.slice)
        first, second = first + moment.first, second + moment.second
        if node == stop:
            passed = True
        else:
            first, second = first - plan.step[node, 0], second - plan.step[node, 1]
        if node == end:
            reach = moment.time
            break
        begin = begin_at(problem, node, moment.time)
        if begin == np.inf:
            return first, second, np.inf
        moment = _moment(day, begin + service_at(problem, problem.profile[slot], node))
        if passed and node != stop and moment.time <= plan.ready[node]:
            break  # from here on, all is as it was
    if first >= problem.forbidden or _is_over(reach, problem.returns[kind]):
        return first, second, np.inf
    lasts = reach - leaves
    return (lasts, second, reach) if day.clock == 0 else (first, lasts, reach)


@inlined
def _ends(problem: Problem, slot: int) -> tuple[int, int]:
    """Return the nodes at which a route starts and ends."""
    start = len(problem.demand) + 2 * slot
    return start, start + 1


@inlined
def _moment(day: FleetDay, time: float) -> Moment:
    """Return the moment at a time."""
    return Moment(time, slice_of(day, time), 0.0, 0.0)


@inlined
def _visited(problem: Problem, plan: WorkingPlan, slot: int, node: int, arrival: float) -> float:
    """Write the times of a visit; return when it ends, which is never after all windows."""
    begin = begin_at(problem, node, arrival)
    if begin == np.inf:
        return np.inf
    late = plan.late[plan.previous[node]]
    if _is_over(begin, problem.due[node]):
        late += begin - problem.due[node]
    if problem.timely:
        plan.value[slot, EARLINESS] += max(0.0, problem.wanted[node] - begin)
        plan.value[slot, ARRIVAL] += problem.urgency[node] * (begin - problem.begin)
    ready = begin + service_at(problem, problem.profile[slot], node)
    plan.ready[node], plan.late[node] = ready, late
    return ready
