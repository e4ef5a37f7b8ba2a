"""Note what an iteration changes in a plan, to undo it, and work out what the change costs."""

from service.fleet.search.problem import COLUMNS, FIRST, RELEASED, Problem
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
    if _recalls(problem):
        _keep_known(plan, slot, start)
    plan.saved[counts[SAVED]] = slot
    plan.saved_size[counts[SAVED]] = size
    counts[SAVED] += 1


@inlined
def _recalls(problem: Problem) -> bool:
    """Return whether what was known of a route is kept: to work it out takes long over the day."""
    return problem.postpones and not (problem.carries or problem.weighs)


@inlined
def _keep_known(plan: WorkingPlan, slot: int, start: int) -> None:
    """Keep what is known along a route."""
    node = start
    while True:
        known = plan.known[node]
        known[0], known[1], known[2] = plan.step[node, 0], plan.step[node, 1], plan.along[node]
        known[3], known[4], known[5] = plan.ahead[node], plan.ready[node], plan.late[node]
        for number in range(3):
            known[6 + number], known[9 + number] = plan.head[node, number], plan.tail[node, number]
        if node == start + 1:
            break
        node = plan.next[node]
    known = plan.known_of[slot]
    known[0], known[1] = plan.cost[slot], plan.plain[slot]
    for column in range(COLUMNS):
        known[2 + column] = plan.value[slot, column]
    for dimension in range(plan.load.shape[1]):
        known[2 + COLUMNS + dimension] = plan.load[slot, dimension]


@inlined
def recall(state: State) -> None:
    """Work out what is known of changed routes whose stops are again those of before."""
    problem, plan, _ = state
    for number in range(plan.counts[SAVED]):
        slot = plan.saved[number]
        if plan.saved_size[number] > 0 and _recalls(problem):
            plan.size[slot] = plan.saved_size[number]
            _recall_known(plan, slot, len(problem.demand) + 2 * slot)
        else:
            measure(state, slot)


@inlined
def _recall_known(plan: WorkingPlan, slot: int, start: int) -> None:
    """Set what is known along a route to what was kept of it."""
    node = start
    while True:
        known = plan.known[node]
        plan.step[node, 0], plan.step[node, 1], plan.along[node] = known[0], known[1], known[2]
        plan.ahead[node], plan.ready[node], plan.late[node] = int(known[3]), known[4], known[5]
        for number in range(3):
            plan.head[node, number], plan.tail[node, number] = known[6 + number], known[9 + number]
        if node == start + 1:
            break
        node = plan.next[node]
    mark_used(plan, slot)
    known = plan.known_of[slot]
    plan.cost[slot], plan.plain[slot] = known[0], known[1]
    for column in range(COLUMNS):
        plan.value[slot, column] = known[2 + column]
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] = int(known[2 + COLUMNS + dimension])


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
