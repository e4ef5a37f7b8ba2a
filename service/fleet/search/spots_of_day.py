"""Estimate what a stop costs in a route over the day."""

import numpy as np

from service.fleet.search.day import FleetDay, Moment, driven, slice_of
from service.fleet.search.problem import FIRST, LATENESS, LOADED, SECOND, Problem
from service.fleet.search.route import head_at, joined, stay, tail_at, times_of
from service.fleet.search.values import Values, grown_cost
from service.fleet.search.weighed import weighed_with
from service.fleet.search.working_plan import State, WorkingPlan, service_at
from service.jit import compiled, inlined


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
    length, end = _timed(problem, plan, (slot, before, stop), legs)
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


@inlined
def _timed(
    problem: Problem, plan: WorkingPlan, where: tuple[int, int, int], legs: tuple[float, float]
) -> tuple[float, float]:
    """Return about the time that a route takes with a stop after a node, and its end.

    The time is infinite where a window seems to be missed.
    """
    slot, before, stop = where
    there, away = legs
    profile, after = problem.profile[slot], plan.next[before]
    span, kept = joined(head_at(plan, before), there, stay(problem, profile, stop))
    if not kept:
        return np.inf, 0.0
    span, kept = joined(span, away, tail_at(plan, after))
    released = -np.inf if problem.reloads else problem.release[stop]
    return times_of(problem, plan, slot, span, released) if kept else (np.inf, 0.0)
