"""Note what an iteration changes in a plan, to undo it, and work out what the change costs."""

from service.fleet.search.problem import FIRST, RELEASED, Problem
from service.fleet.search.route import measure, set_cost, set_times
from service.fleet.search.values import drives_too_far
from service.fleet.search.working_plan import (
    OUTSIDE,
    REMOVED,
    SAVED,
    SAVED_OUTSIDE,
    SAVED_STOPS,
    STAMP,
    State,
    WorkingPlan,
    leg,
    mark_used,
)
from service.jit import inlined

_HUGE = 1e6  # times as long as what is left of a route


@inlined
def save_slot(problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Keep the stops of a route as they were before this iteration, if that is not done yet."""
    counts = plan.counts
    if plan.touched[slot] == counts[STAMP]:
        return
    plan.touched[slot] = counts[STAMP]
    start = len(problem.demand) + 2 * slot
    node, size = plan.next[start], 0
    while node != start + 1:
        plan.saved_stops[counts[SAVED_STOPS]] = node
        plan.saved_via[counts[SAVED_STOPS]] = plan.via[node]
        counts[SAVED_STOPS] += 1
        size += 1
        node = plan.next[node]
    plan.saved[counts[SAVED]] = slot
    plan.saved_size[counts[SAVED]] = size
    counts[SAVED] += 1


@inlined
def begin_iteration(plan: WorkingPlan) -> None:
    """Note what restore() returns to."""
    counts = plan.counts
    counts[STAMP] += 1
    counts[SAVED] = counts[SAVED_STOPS] = counts[REMOVED] = 0
    counts[SAVED_OUTSIDE] = counts[OUTSIDE]
    for place in range(counts[OUTSIDE]):
        plan.saved_outside[place] = plan.outside[place]


@inlined
def measure_with(state: State, slot: int, stop: int) -> bool:
    """Work out the cost of a route that has got a stop; return whether it keeps all rules.

    Lengths change by three legs, and times up to a node only from the stop on, those from a node on
    only before it. Sums are then a few roundings apart from those of measure(), which is due when
    the plan is kept. A sum of which a huge leg is taken would be left with little of the rest: then
    all is measured anew, as where more than sums and plain times is known of routes.
    """
    problem, plan, direction = state
    whole = problem.carries or problem.reloads or problem.weighs or direction.load_distance > 0
    if whole or (problem.clock >= 0 and not _has_plain_times(problem, plan, slot, stop)):
        return measure(state, slot)
    mark_used(plan, slot)
    kind, profile, fits, lost = problem.kind[slot], problem.profile[slot], True, False
    before, after = plan.previous[stop], plan.next[stop]
    for layer in range(plan.step.shape[1]):
        parted = plan.step[after, layer]
        plan.value[slot, layer] -= parted
        plan.step[stop, layer] = leg(problem, profile, problem.place[before], stop, layer)
        plan.step[after, layer] = leg(problem, profile, stop, problem.place[after], layer)
        plan.value[slot, layer] += plan.step[stop, layer] + plan.step[after, layer]
        lost |= parted > _HUGE * plan.value[slot, layer]
    if lost:
        return measure(state, slot)
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] += problem.demand[stop, dimension]
        fits &= plan.load[slot, dimension] <= problem.capacity[kind, dimension]
    plan.size[slot] += 1
    fits &= plan.value[slot, FIRST] < problem.forbidden
    if problem.capped:
        fits &= not drives_too_far(problem, plan, slot, 0.0, 0.0)
    if problem.clock >= 0:
        fits &= set_times(problem, plan, slot, (stop, stop))
    fits &= set_cost(state, slot, len(problem.demand) + 2 * slot + 1)
    plan.plain[slot] = plan.cost[slot]
    return fits


@inlined
def _has_plain_times(problem: Problem, plan: WorkingPlan, slot: int, stop: int) -> bool:
    """Return whether a route with one more stop leaves when it did, for all that is loaded."""
    released = problem.release[stop] > plan.value[slot, RELEASED]
    return problem.plain and not released and plan.size[slot] > 0


@inlined
def measure_changed(state: State) -> None:
    """Measure the routes that this iteration changed: sums of changes are inexact."""
    problem, plan, direction = state
    if (problem.clock < 0 or problem.plain) and direction.load_distance == 0:
        for number in range(plan.counts[SAVED]):
            measure(state, plan.saved[number])
