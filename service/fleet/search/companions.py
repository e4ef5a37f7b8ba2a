"""Keep stops on one route that ride together, others apart, and others in order."""

from service.fleet.search.changes import save_slot
from service.fleet.search.problem import Problem
from service.fleet.search.route import measure
from service.fleet.search.working_plan import (
    REMOVED,
    State,
    WorkingPlan,
    leave_out,
    unlink,
)
from service.jit import compiled, inlined


@compiled
def may_join(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Return whether a stop may be on a route: with those that ride with it, and without others.

    The vehicle must be able to carry the loads of all that ride together, if it loads once.
    """
    for number in range(problem.rivals.shape[1]):
        other = problem.rivals[stop, number]
        if other >= 0 and plan.route[other] == slot:
            return False
    alone = not problem.reloads
    for number in range(problem.mates.shape[1]):
        other = problem.mates[stop, number]
        if other >= 0 and plan.route[other] >= 0:
            if plan.route[other] != slot:
                return False
            alone = False
    return not alone or _holds_all(problem, plan, stop, slot)


@compiled
def _holds_all(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Return whether a vehicle can carry the loads of a stop and all that ride with it as well."""
    kind, fits = problem.kind[slot], True
    for dimension in range(plan.load.shape[1]):
        load = plan.load[slot, dimension] + problem.demand[stop, dimension]
        for number in range(problem.mates.shape[1]):
            other = problem.mates[stop, number]
            if other >= 0:
                load += problem.demand[other, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@compiled
def order_kept(problem: Problem, plan: WorkingPlan, stop: int, slot: int, before: int) -> bool:
    """Return whether a stop may come after a node of a route: none is on the wrong side."""
    start = len(problem.demand) + 2 * slot
    node, passed = plan.next[start], before == start
    for _ in range(plan.size[slot]):
        if problem.earlier[node, stop] if passed else problem.earlier[stop, node]:
            return False
        passed |= node == before
        node = plan.next[node]
    return True


@compiled
def want_mates(problem: Problem, plan: WorkingPlan) -> None:
    """Add to the stops that are inserted those that ride with them: all are outside."""
    number = 0
    while number < plan.counts[REMOVED]:
        stop = plan.removed[number]
        for place in range(problem.mates.shape[1]):
            other = problem.mates[stop, place]
            known = other < 0
            for at in range(plan.counts[REMOVED]):
                known |= plan.removed[at] == other
            if not known:
                plan.removed[plan.counts[REMOVED]] = other
                plan.counts[REMOVED] += 1
        number += 1


@compiled
def drop_halves(state: State) -> None:
    """Take the stops out of routes of which not all that ride with them are inside."""
    problem, plan, _ = state
    for number in range(plan.counts[REMOVED]):
        if plan.route[plan.removed[number]] >= 0:
            continue
        for place in range(problem.mates.shape[1]):
            other = problem.mates[plan.removed[number], place]
            if other >= 0 and plan.route[other] >= 0:
                _drop(state, other)


@inlined
def _drop(state: State, stop: int) -> None:
    """Take a stop out of its route, or all stops if the route breaks a rule without it."""
    problem, plan, _ = state
    slot = plan.route[stop]
    save_slot(problem, plan, slot)
    _put_out(problem, plan, stop)
    if not measure(state, slot):
        start = len(problem.demand) + 2 * slot
        while plan.next[start] != start + 1:
            _put_out(problem, plan, plan.next[start])
        measure(state, slot)


@inlined
def _put_out(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    if problem.pickup[stop] >= 0:
        stop = problem.pickup[stop]
    if problem.delivery[stop] >= 0:
        unlink(plan, problem.delivery[stop])
    unlink(plan, stop)
    leave_out(problem, plan, stop)
