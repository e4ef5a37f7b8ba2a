"""Work out what a stop costs in a spot of a plan: after a node, and maybe beside a reload."""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay, Moment, driven, slice_of
from service.fleet.search.problem import (
    FIRST,
    LATENESS,
    LOADED,
    RELEASED,
    SECOND,
    Problem,
)
from service.fleet.search.route import measure
from service.fleet.search.routes_of_day import driven_with
from service.fleet.search.spans import head_at, times_with
from service.fleet.search.values import Values, drives_too_far, grown_cost
from service.fleet.search.weighed import weighed_with
from service.fleet.search.working_plan import (
    AS_BEFORE,
    MOST_NOTED,
    NOTED,
    State,
    WorkingPlan,
    begin_at,
    leg,
    link,
    service_at,
    unlink,
    way,
)
from service.jit import compiled, inlined

_is_over = inlined(is_over)
_ROUNDING = 1e-9  # more than the share of its cost by which that of a route is rounded


class Place(NamedTuple):
    """Where a stop may go, and what it costs there.

    Attributes:
        cost: What it costs.
        slot: The slot; -1 if there is no place.
        before: The node before it.
        via: Where its vehicle loads on the way to it; -1 if it does not.
        onward: Where its vehicle loads on the way from it.
        last: Of a pick-up, the node before the delivery; -1 of other stops.
    """

    cost: float
    slot: int
    before: int
    via: int
    onward: int
    last: int


class Spot(NamedTuple):
    """A place without its cost."""

    slot: int
    before: int
    via: int
    onward: int


@inlined
def nowhere(most: float) -> Place:
    """Return no place, better than which are those that cost less than `most`."""
    return Place(most, -1, -1, -1, -1, -1)


@inlined
def better_at(state: State, stop: int, spot: Spot, best: Place) -> Place:
    """Return the better of two places: the best so far, and a spot with room.

    Where only a trial says what it costs, it is noted for best_noted().
    """
    plan = state.plan
    cost = _estimated(state.problem.day, state, stop, spot, best.cost)
    if cost >= best.cost:
        return best
    if not state.problem.tried[state.problem.kind[spot.slot]]:
        return Place(cost, spot.slot, spot.before, spot.via, spot.onward, -1)
    if plan.counts[NOTED] == MOST_NOTED:
        best = best_noted(state, stop, best)
    number = plan.counts[NOTED]
    plan.spots[number, 0], plan.spots[number, 1] = spot.slot, spot.before
    plan.spots[number, 2], plan.spots[number, 3] = spot.via, spot.onward
    plan.estimates[number] = cost
    plan.counts[NOTED] += 1
    return best


@compiled
def best_noted(state: State, stop: int, best: Place) -> Place:
    """Return the best of a place and the spots noted.

    They are tried in the order of what they are estimated to cost, so that few are.
    """
    plan = state.plan
    while True:
        least = -1
        for number in range(plan.counts[NOTED]):
            if plan.estimates[number] < (best.cost if least < 0 else plan.estimates[least]):
                least = number
        if least < 0:
            break
        estimate, plan.estimates[least] = plan.estimates[least], np.inf
        slot, before, via, onward = plan.spots[least]
        spot = Spot(slot, before, via, onward)
        cost = _tried_by_type(state.problem.day, state, stop, spot, estimate)
        if cost < best.cost:
            best = Place(cost, slot, before, via, onward, -1)
    plan.counts[NOTED] = 0
    return best


@inlined
def _estimated(day: FleetDay | None, state: State, stop: int, spot: Spot, most: float) -> float:
    """Return insertion_cost(), or an estimate over the day: where compiled, by the type of it."""
    if day is None:
        return insertion_cost(state, stop, spot, most)
    return _cost_over_the_day(day, state, stop, spot)


@inlined
def put(plan: WorkingPlan, stop: int, spot: Spot) -> None:
    """Put a stop into a route."""
    link(plan, spot.slot, stop, spot.before)
    plan.via[stop] = spot.via
    plan.via[plan.next[stop]] = spot.onward


@inlined
def take_back(plan: WorkingPlan, stop: int, onward: int) -> None:
    """Undo put(), where the vehicle loaded at `onward` before the next stop; -1 if it did not."""
    after = plan.next[stop]
    plan.via[stop] = -1
    unlink(plan, stop)
    plan.via[after] = onward


@inlined
def _tried_by_type(
    day: FleetDay | None, state: State, stop: int, spot: Spot, estimate: float
) -> float:
    """Return what a stop costs in a spot, over the day without a trial where that is enough.

    One branch is left where this is compiled: that of the type of the day.
    """
    if day is None:
        return _tried(state, stop, spot)
    if _is_driven_alone(state, stop, spot.slot):
        return _on_the_way(day, state, (stop, spot.before), spot.slot, estimate)
    return _tried(state, stop, spot)


@inlined
def _is_driven_alone(state: State, stop: int, slot: int) -> bool:
    """Return whether costs and windows alone say what one more stop costs, however early it is."""
    problem, plan, direction = state
    start, kind = len(problem.demand) + 2 * slot, problem.kind[slot]
    more = not problem.simple or problem.weighs or problem.early or problem.rests[kind] > 0
    more |= problem.capped or problem.longest[kind] < np.inf
    more |= direction.lateness > 0 or direction.load_distance > 0
    return not (more or plan.size[slot] == 0 or problem.release[stop] > plan.ready[start])


@compiled
def _on_the_way(
    day: FleetDay, state: State, where: tuple[int, int], slot: int, estimate: float
) -> float:
    """Return what a stop costs after a node if its vehicle leaves when it does now.

    At its best departure it costs as much or less. If it is in time only when it leaves before,
    return the estimate, and infinity if it is not.
    """
    problem, plan, _ = state
    kind, (stop, before) = problem.kind[slot], where
    leaves = plan.ready[len(problem.demand) + 2 * slot]
    first, second, end = driven_with(day, problem, plan, where, leaves)
    if end == np.inf:
        departs = max(problem.departs[kind], plan.value[slot, RELEASED])
        if departs >= leaves:
            return np.inf
        return estimate if driven_with(day, problem, plan, where, departs)[2] < np.inf else np.inf
    overtime = max(0.0, end - problem.shift_end[kind])
    late, loaded = plan.value[slot, LATENESS], plan.value[slot, LOADED]
    weighed = weighed_with(state, stop, slot, before)
    return grown_cost(state, slot, 1, Values(first, second, overtime, late, loaded, weighed))


@compiled
def _tried(state: State, stop: int, spot: Spot) -> float:
    """Return what a stop costs in a spot; infinite if it breaks a rule there."""
    plan, slot = state.plan, spot.slot
    cost, onward = -plan.cost[slot], plan.via[plan.next[spot.before]]
    as_before, plan.counts[AS_BEFORE] = plan.counts[AS_BEFORE], 0
    put(plan, stop, spot)
    fits = measure(state, slot)
    cost += plan.cost[slot]
    take_back(plan, stop, onward)
    measure(state, slot)
    plan.counts[AS_BEFORE] = as_before
    return cost if fits else np.inf


@inlined
def insertion_cost(state: State, stop: int, spot: Spot, most: float) -> float:
    """Return what the cost of a route grows by with a stop in a spot; inf if a rule forbids it.

    What costs at least `most` may be told as more. Where the begin of each visit counts, it is an
    estimate: as if the vehicle left as early as it may. If a visit is due, a route may turn out
    longer: then its vehicle cannot leave as late as is assumed here. Breaks do not count.
    """
    problem, plan, direction = state
    slot, before, end = spot.slot, spot.before, 0.0
    kind = problem.kind[slot]
    first = second = _detour(problem, plan, stop, spot, 0)
    if not problem.alike:
        second = _detour(problem, plan, stop, spot, 1)
    if first >= 0.5 * problem.forbidden or _legs_too_much(state, slot, first, second, most):
        return np.inf
    loaded = plan.value[slot, LOADED]
    if direction.load_distance > 0 and not problem.reloads:
        loaded += _loaded(problem, plan, stop, spot, first)
    first += plan.value[slot, FIRST]
    second += plan.value[slot, SECOND]
    if problem.clock >= 0:
        time, end = _timed(problem, plan, stop, spot)
        if time == np.inf:
            return np.inf
        first = time if problem.clock == 0 else first
        second = time if problem.clock == 1 else second
    if _is_over(first if problem.limited == 0 else second, problem.longest[kind], end):
        return np.inf
    overtime = max(0.0, end - problem.shift_end[kind])
    late = plan.value[slot, LATENESS]
    weighed = weighed_with(state, stop, slot, before)
    values = Values(first, second, overtime, late, loaded, weighed)
    cost = grown_cost(state, slot, 1, values)
    if cost < most and not problem.tried[kind] and (problem.choice or direction.lateness > 0):
        later = _lateness(problem, plan, slot, stop, before)
        return np.inf if later == np.inf else cost + direction.lateness * (later - late)
    return cost


@compiled
def _cost_over_the_day(
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


@inlined
def _detour(problem: Problem, plan: WorkingPlan, stop: int, spot: Spot, layer: int) -> float:
    """Return what a cost of the legs of a route grows by with a stop in a spot."""
    slot, before, via, onward = spot
    after, profile = plan.next[before], problem.profile[slot]
    there = way(problem, profile, problem.place[before], via, stop, layer)
    away = way(problem, profile, stop, onward, problem.place[after], layer)
    return there + away - plan.step[after, layer]


@inlined
def _legs_too_much(state: State, slot: int, first: float, second: float, most: float) -> bool:
    """Return whether the legs alone are too far, or cost at least `most`, with a stop more.

    Where legs grow, and nothing is better late than early, all that is measured grows.
    """
    problem, plan, direction = state
    if problem.capped and drives_too_far(problem, plan, slot, first, second):
        return True
    if not problem.grows or first < 0 or second < 0:
        return False
    cost = 0.0 if problem.clock == 0 else direction.costs[0] * first
    cost += 0.0 if problem.clock == 1 else direction.costs[1] * second
    if problem.priced and problem.clock != 0:
        cost += direction.fixed * problem.per_distance[problem.kind[slot]] * first
    return cost >= most + _ROUNDING * plan.plain[slot]


@inlined
def _loaded(problem: Problem, plan: WorkingPlan, stop: int, spot: Spot, detour: float) -> float:
    """Return what loads times distances grow by with a stop in a spot, without reloads."""
    profile, before = problem.profile[spot.slot], spot.before
    to = plan.along[before] + leg(problem, profile, problem.place[before], stop, 0)
    loaded = problem.demand[stop, 0] * to + plan.ahead[plan.next[before]] * detour
    if problem.takes:
        end, after = len(problem.demand) + 2 * spot.slot + 1, plan.next[before]
        onward = leg(problem, profile, stop, problem.place[after], 0)
        if after != end:
            onward += plan.along[end] - plan.along[after]
        loaded += problem.taken[stop, 0] * onward
    return loaded


@inlined
def _timed(problem: Problem, plan: WorkingPlan, stop: int, spot: Spot) -> tuple[float, float]:
    """Return the time that a route takes with a stop in a spot, and when it ends.

    The time is infinite where a window is missed.
    """
    slot, before, via, onward = spot
    profile, after = problem.profile[slot], plan.next[before]
    there = way(problem, profile, problem.place[before], via, stop, problem.clock)
    away = way(problem, profile, stop, onward, problem.place[after], problem.clock)
    return times_with(problem, plan, (slot, stop, after), head_at(plan, before), (there, away))


@inlined
def _lateness(problem: Problem, plan: WorkingPlan, slot: int, stop: int, before: int) -> float:
    """Return the lateness of a route with a stop after a node; infinite if a window is missed."""
    kind, profile = problem.kind[slot], problem.profile[slot]
    end = len(problem.demand) + 2 * slot + 1
    late, ready, node = plan.late[before], plan.ready[before], before
    released = problem.release[stop]
    if released > plan.value[slot, RELEASED] and released > problem.departs[kind]:
        # The vehicle leaves later, so all times change.
        late, ready, node = 0.0, released, end - 1
        while node != before:
            ready, late = _visited(problem, profile, (node, plan.next[node]), ready, late)
            node = plan.next[node]
    ready, late = _visited(problem, profile, (before, stop), ready, late)
    here, node = stop, plan.next[before]
    while node != end:
        ready, late = _visited(problem, profile, (here, node), ready, late)
        if ready <= plan.ready[node]:
            return late + plan.late[end] - plan.late[node]
        here, node = node, plan.next[node]
    ready += leg(problem, profile, problem.place[here], problem.place[end], problem.clock)
    missed = ready == np.inf or _is_over(ready, problem.returns[kind])
    return np.inf if missed else late


@inlined
def _visited(
    problem: Problem, profile: int, between: tuple[int, int], ready: float, late: float
) -> tuple[float, float]:
    """Return when the visit of the second of two nodes ends, and the lateness after it."""
    node, stop = between
    away = leg(problem, profile, problem.place[node], stop, problem.clock)
    begin = begin_at(problem, stop, ready + away)
    if _is_over(begin, problem.due[stop]):
        late += begin - problem.due[stop]
    return begin + service_at(problem, profile, stop), late
