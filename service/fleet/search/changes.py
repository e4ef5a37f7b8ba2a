"""Note what an iteration changes in a plan, so that it can be undone."""

from service.fleet.search.problem import Problem
from service.fleet.search.route import measure
from service.fleet.search.working_plan import (
    OUTSIDE,
    REMOVED,
    SAVED,
    SAVED_OUTSIDE,
    SAVED_STOPS,
    STAMP,
    State,
    WorkingPlan,
)
from service.jit import inlined


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
def measure_changed(state: State) -> None:
    """Measure the routes that this iteration changed: sums of changes are inexact."""
    problem, plan, direction = state
    if problem.clock < 0 and direction.load_distance == 0:
        for number in range(plan.counts[SAVED]):
            measure(state, plan.saved[number])
