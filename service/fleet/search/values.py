"""The values of a route, and what they cost."""

from typing import NamedTuple

from service.fleet.rounding import is_over
from service.fleet.search.problem import (
    FIRST,
    LATENESS,
    LOADED,
    OVERTIME,
    SECOND,
    WEIGHED,
    Problem,
)
from service.fleet.search.working_plan import State, WorkingPlan
from service.jit import compiled, inlined

_is_over = inlined(is_over)


class Values(NamedTuple):
    """The values of a route: its length in both costs, and what else an objective may measure."""

    first: float
    second: float
    overtime: float
    lateness: float
    loaded: float  # loads times distances
    weighed: float  # the cost of the measures in weighed.py


@inlined
def route_cost(state: State, kind: int, values: Values) -> float:
    """Return the cost of a route that visits a stop, by a type of vehicles."""
    problem, _, direction = state
    cost = (
        direction.costs[0] * values.first
        + direction.costs[1] * values.second
        + direction.vehicle
        + direction.fixed * problem.fixed[kind]
        + direction.overtime * values.overtime
        + direction.lateness * values.lateness
        + direction.load_distance * values.loaded
    )
    if problem.priced:
        cost += direction.fixed * at_prices(problem, kind, values.first, values.second)
    if problem.weighs:
        cost += values.weighed
    if direction.beyond > 0:
        cost += direction.beyond * beyond_rules(problem, kind, values)
    length = values.first if problem.swept == 0 else values.second
    return cost + direction.penalty * max(0.0, length - direction.longest)


@compiled
def at_prices(problem: Problem, kind: int, first: float, second: float) -> float:
    """Return the first length of a route of both lengths, at the prices of its vehicle."""
    time = first if problem.clock == 0 else second
    return float(problem.per_distance[kind] * first + problem.per_time[kind] * time)


@inlined
def beyond_rules(problem: Problem, kind: int, values: Values) -> float:
    """Return by how much a route is too long, and ends too late."""
    length = values.first if problem.limited == 0 else values.second
    late = max(0.0, values.overtime - problem.most_overtime[kind])
    return late + max(0.0, length - problem.most_length[kind])


@inlined
def grown_cost(state: State, slot: int, more: int, values: Values) -> float:
    """Return what the cost of a route grows by with a number of stops more; without breaks."""
    problem, plan, _ = state
    kind = problem.kind[slot]
    cost = route_cost(state, kind, values) - plan.plain[slot]
    more += plan.size[slot]
    return cost + (lacking(state, kind, more, values) if problem.bounded_below else 0.0)


@compiled
def lacking(state: State, kind: int, size: int, values: Values) -> float:
    """Return what it costs that a route has too few stops, or is too short."""
    problem, _, direction = state
    length = values.first if problem.limited == 0 else values.second
    cost = direction.required * max(0, problem.min_stops[kind] - size)
    if problem.shortest[kind] > 0 and _is_over(problem.shortest[kind], length):
        cost += direction.required * (2 - length / problem.shortest[kind])
    return cost


@compiled
def drives_too_far(
    problem: Problem, plan: WorkingPlan, slot: int, first: float, second: float
) -> bool:
    """Return whether a route's legs, with so much more of both costs, are over what they may be."""
    node, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    while node != end:
        node = plan.next[node]
        first += plan.step[node, 0]
        second += plan.step[node, 1]
    most = problem.most_legs[problem.kind[slot]]
    return _is_over(first, most[0]) or _is_over(second, most[1])


@inlined
def values_of(plan: WorkingPlan, slot: int) -> Values:
    """Return the values of a route."""
    value = plan.value[slot]
    return Values(
        value[FIRST],
        value[SECOND],
        value[OVERTIME],
        value[LATENESS],
        value[LOADED],
        value[WEIGHED],
    )
