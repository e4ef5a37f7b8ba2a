"""Measures that few fleets have as an objective, such as earliness, overlap and changes.

Where one of them is, `WEIGHED` is what a route costs for all of them. Earliness, weighted arrivals
and late visits depend on when each visit begins; overlap and changes of vehicles do not. How times
spread from day to day is measured in spreading.py.
"""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay
from service.fleet.search.extras import NO_PROMISE
from service.fleet.search.problem import (
    ARRIVAL,
    CHANGES,
    EARLINESS,
    LATE,
    MEAN,
    MOST,
    OVERLAP,
    VARIANCE,
    WEIGHED,
    Problem,
)
from service.fleet.search.spreading import spread_along, spread_cost, spread_growth
from service.fleet.search.working_plan import TRY, State, WorkingPlan, begin_at, leg, service_at
from service.jit import compiled, inlined

_is_over = inlined(is_over)


@compiled
def weigh(state: State, slot: int) -> None:
    """Write the measures of a route whose times are known, if it has any, and what they cost."""
    problem, plan, direction = state
    if problem.extras.overlaps:
        plan.value[slot, OVERLAP] = _overlap(problem, plan, slot)
    if problem.timely:
        _weigh_times(problem.day, problem, plan, slot)
    elif problem.extras.promises:
        plan.value[slot, CHANGES] = _changes(problem, plan, slot)
    plan.value[slot, WEIGHED] = (
        direction.earliness * plan.value[slot, EARLINESS]
        + direction.weighted_arrival * plan.value[slot, ARRIVAL]
        + direction.overlap * plan.value[slot, OVERLAP]
        + direction.changes * plan.value[slot, CHANGES]
    )
    if problem.extras.spreads:
        spread_along(problem, plan, slot)
        value = plan.value[slot]
        plan.value[slot, WEIGHED] += spread_cost(
            direction, value[LATE], value[MEAN], value[VARIANCE], value[MOST]
        )


@inlined
def weighed_with(state: State, stop: int, slot: int, before: int) -> float:
    """Return what the measures of a route cost with a stop after a node; about, where it is tried.

    Of a pick-up, it is the least that they cost with the delivery as well.
    """
    problem, plan, _ = state
    if not problem.weighs:
        return 0.0
    return plan.value[slot, WEIGHED] + _growth(state, stop, slot, before)


@compiled
def _growth(state: State, stop: int, slot: int, before: int) -> float:
    """Return what the cost of the measures grows by."""
    problem, plan, direction = state
    growth, delivery = 0.0, problem.delivery[stop]
    if direction.overlap > 0:
        if plan.met_at[slot] != plan.counts[TRY]:
            plan.met_at[slot] = plan.counts[TRY]
            plan.met[slot] = _added_overlap(problem, plan, stop, slot)
        growth += direction.overlap * plan.met[slot]
    if problem.extras.spreads:
        growth += spread_growth(state, stop, slot, before)
    if problem.timely and delivery < 0:
        return growth + _begins_changed(state, slot, stop, before)
    if problem.timely:  # With visits more, others begin later: the earliness may fall.
        growth -= direction.earliness * plan.value[slot, EARLINESS]
    kind = problem.kind[slot]
    growth += direction.changes * _is_changed(problem, stop, kind, 0.0)
    if delivery >= 0:
        growth += direction.changes * _is_changed(problem, delivery, kind, 0.0)
    return growth


@inlined
def promised_stops(problem: Problem, stop: int) -> int:
    """Return how many promises a stop outside breaks: of a pick-up, with its delivery."""
    if not problem.extras.promises:
        return 0
    promised, delivery = problem.extras.promised_to, problem.delivery[stop]
    more = delivery >= 0 and promised[delivery] != NO_PROMISE
    return int(promised[stop] != NO_PROMISE) + int(more)


@inlined
def _is_changed(problem: Problem, stop: int, kind: int, begin: float) -> bool:
    """Return whether a stop is promised, and visited by another vehicle or later."""
    promised = problem.extras.promised_to[stop]
    late = _is_over(begin, problem.extras.promised_until[stop])
    return promised != NO_PROMISE and (promised != kind or late)


@inlined
def _changes(problem: Problem, plan: WorkingPlan, slot: int) -> int:
    """Return how many promised stops of a route are visited by another vehicle, or later."""
    changes, start = 0, len(problem.demand) + 2 * slot
    node = plan.next[start]
    while node != start + 1:
        begin = 0.0
        if problem.timely:
            begin = plan.ready[node] - service_at(problem, problem.profile[slot], node)
        changes += _is_changed(problem, node, problem.kind[slot], begin)
        node = plan.next[node]
    return changes


@inlined
def _overlap(problem: Problem, plan: WorkingPlan, slot: int) -> float:
    """Return how much the neighbours of the stops of a route count that do not ride with them."""
    apart, start = 0.0, len(problem.demand) + 2 * slot
    node = plan.next[start]
    while node != start + 1:
        for place in range(problem.extras.beside.shape[1]):
            if plan.route[problem.extras.beside[node, place]] != slot:
                apart += problem.extras.weights[node, place]
        node = plan.next[node]
    return apart


@inlined
def _added_overlap(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> float:
    """Return what the overlap of a route grows by with a stop, of a pick-up with its delivery."""
    delivery = problem.delivery[stop]
    added = _added_by(problem, plan, stop, slot, delivery)
    if delivery >= 0:
        added += _added_by(problem, plan, delivery, slot, -1)
    return added


@inlined
def _added_by(problem: Problem, plan: WorkingPlan, stop: int, slot: int, mate: int) -> float:
    """Return what the overlap of a route grows by with a stop, where a mate comes too."""
    extras, added = problem.extras, 0.0
    for place in range(extras.beside.shape[1]):
        added += extras.weights[stop, place]
    for place in range(extras.first_pair[stop], extras.first_pair[stop + 1]):
        other = extras.pairs[place]
        if plan.route[other] == slot or other == mate:
            added -= extras.pair_weights[place]
    return added


@inlined
def _weigh_times(day: FleetDay | None, problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Write the measures of begins; over the day all but the changes are written already."""
    if day is None:
        end = len(problem.demand) + 2 * slot + 1
        _weigh_begins(problem, plan, slot, plan.ready[end] - plan.value[slot, problem.clock])
    else:
        plan.value[slot, CHANGES] = _changes(problem, plan, slot)


@inlined
def _weigh_begins(problem: Problem, plan: WorkingPlan, slot: int, departure: float) -> None:
    """Write earliness, weighted arrivals and changes of a route whose departure is known."""
    early, arrival, changes, profile = 0.0, 0.0, 0, problem.profile[slot]
    start = len(problem.demand) + 2 * slot
    at, node, time, end = problem.place[start], plan.next[start], departure, start + 1
    while node != end:
        step = plan.step[node, problem.clock]
        if plan.via[node] >= 0:
            away = leg(problem, profile, at, plan.via[node], problem.clock)
            time, step = max(time + away, plan.released[node]), step - away
        begin = begin_at(problem, node, time + step)
        if _is_over(problem.wanted[node], begin):
            early += problem.wanted[node] - begin
        arrival += problem.urgency[node] * (begin - problem.begin)
        changes += _is_changed(problem, node, problem.kind[slot], begin)
        time = begin + service_at(problem, profile, node)
        at, node = node, plan.next[node]
    plan.value[slot, EARLINESS], plan.value[slot, ARRIVAL] = early, arrival
    plan.value[slot, CHANGES] = changes


@compiled
def _begins_changed(state: State, slot: int, stop: int, before: int) -> float:
    """Return about what the cost of begins grows by with a stop after a node."""
    problem, plan, direction = state
    end, kind = len(problem.demand) + 2 * slot + 1, problem.kind[slot]
    early, arrival, changes, profile = 0.0, 0.0, 0, problem.profile[slot]
    ready, here, node = plan.ready[before], before, stop
    for _ in range(plan.size[slot] + 1):
        step = leg(problem, profile, problem.place[here], node, problem.clock)
        begin = begin_at(problem, node, ready + step)
        if begin == np.inf:
            break
        service = service_at(problem, profile, node)
        ready = begin + service
        early += max(0.0, problem.wanted[node] - begin)
        changes += _is_changed(problem, node, kind, begin)
        if node == stop:
            arrival += problem.urgency[node] * (begin - problem.begin)
        else:
            known = plan.ready[node] - service
            early -= max(0.0, problem.wanted[node] - known)
            arrival += problem.urgency[node] * (begin - known)
            changes -= _is_changed(problem, node, kind, known)
            if ready <= plan.ready[node]:
                break
        here, node = node, plan.next[before] if node == stop else plan.next[node]
        if node == end:
            break
    return (
        direction.earliness * early
        + direction.weighted_arrival * arrival
        + direction.changes * changes
    )
