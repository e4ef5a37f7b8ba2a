"""Drive routes over the day: their times, and what a stop costs in them about."""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay, Moment, driven, slice_of
from service.fleet.search.departures import best_departure
from service.fleet.search.problem import (
    ARRIVAL,
    EARLINESS,
    FIRST,
    LATENESS,
    LOADED,
    RELEASED,
    SECOND,
    Problem,
)
from service.fleet.search.spans import head_at, times_with
from service.fleet.search.values import Values, grown_cost
from service.fleet.search.weighed import weighed_with
from service.fleet.search.working_plan import State, WorkingPlan, begin_at, service_at
from service.jit import compiled, inlined, standalone

_is_over = inlined(is_over)


@standalone
def drive_over_the_day(day: FleetDay, problem: Problem, plan: WorkingPlan, slot: int) -> bool:
    """Write the costs and times along a route that leaves at its best departure.

    Return whether it keeps all windows.
    """
    kind, start = problem.kind[slot], len(problem.demand) + 2 * slot
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    if not drive_from(day, problem, plan, slot, departs):
        return False
    if _is_over(departs, problem.leaves_by[kind]):
        return False
    if problem.early or problem.leaves_by[kind] <= departs:
        return True
    leaves = best_departure(day, problem, plan, slot)
    if leaves > departs and not drive_from(day, problem, plan, slot, leaves):
        return drive_from(day, problem, plan, slot, departs)
    return plan.ready[start] >= departs


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


@compiled
def cost_over_the_day(
    day: FleetDay, state: State, stop: int, spot: tuple[int, int, int, int]
) -> float:
    """Return about what the cost of a route grows by with a stop in a spot.

    The legs to and from the stop are those at the present times of the route. All later ones take
    as long as now.
    """
    problem, plan, direction = state
    slot, before, via, onward = spot
    after, kind = plan.next[before], problem.kind[slot]
    profile = problem.profile[slot]
    at, onto = problem.place[before], problem.place[after]
    to = _through(day, (at, via, stop), kind, plan.ready[before])
    time = max(to.time, problem.opens[stop]) + service_at(problem, profile, stop)
    away = _through(day, (stop, onward, onto), kind, time)
    first = to.first + away.first - plan.step[after, 0]
    second = to.second + away.second - plan.step[after, 1]
    if to.first + away.first >= 0.5 * problem.forbidden:
        return np.inf
    loaded = plan.value[slot, LOADED]
    if direction.load_distance > 0 and not problem.reloads:
        loaded += problem.demand[stop, 0] * (plan.along[before] + to.first)
        loaded += plan.ahead[after] * first
    first += plan.value[slot, FIRST]
    second += plan.value[slot, SECOND]
    legs = (to.first, away.first) if day.clock == 0 else (to.second, away.second)
    length, end = times_with(problem, plan, (slot, stop, after), head_at(plan, before), legs)
    if length == np.inf:
        return np.inf
    first = length if day.clock == 0 else first
    second = length if day.clock == 1 else second
    overtime = max(0.0, end - problem.shift_end[kind])
    late, weighed = plan.value[slot, LATENESS], weighed_with(state, stop, slot, before)
    values = Values(first, second, overtime, late, loaded, weighed)
    return grown_cost(state, slot, 1, values)


@inlined
def _through(day: FleetDay, places: tuple[int, int, int], kind: int, time: float) -> Moment:
    """Return the moment of arrival at the last of three places, with both costs of the way.

    The second place may be -1: then the way leads past it.
    """
    a, via, b = places
    known = slice_of(day, time)
    if via < 0:
        return driven(day, (a, b), kind, time, known)
    half = driven(day, (a, via), kind, time, known)
    whole = driven(day, (via, b), kind, half.time, half.slice)
    return Moment(whole.time, whole.slice, half.first + whole.first, half.second + whole.second)
