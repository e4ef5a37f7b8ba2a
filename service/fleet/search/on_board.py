"""Work out what a vehicle has on board along its route, and whether it can hold it."""

from service.fleet.search.problem import RELEASED, Problem
from service.fleet.search.working_plan import WorkingPlan
from service.jit import compiled, inlined


@inlined
def gather(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> bool:
    """Sum what a route carries, from its end on; return whether its vehicle can."""
    kind = problem.kind[slot]
    size, released = 0, 0.0
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] = 0
    plan.ahead[start + 1] = problem.initial[kind]
    node = plan.previous[start + 1]
    while node != start:
        if not problem.shipped[node]:
            for dimension in range(plan.load.shape[1]):
                plan.load[slot, dimension] += problem.demand[node, dimension]
        plan.ahead[node] = problem.initial[kind]
        if plan.load.shape[1] > 0:
            plan.ahead[node] += plan.load[slot, 0]
        released = max(released, problem.release[node])
        size += 1
        node = plan.previous[node]
    plan.size[slot] = size
    plan.value[slot, RELEASED] = released
    if problem.carries:
        return _ship(problem, plan, slot, start)
    if problem.reloads:
        return _reload(problem, plan, slot, start)
    return _fits(problem, plan, slot)


@inlined
def _fits(problem: Problem, plan: WorkingPlan, slot: int) -> bool:
    """Return whether a vehicle can hold all that its route brings."""
    kind, fits = problem.kind[slot], True
    for dimension in range(plan.load.shape[1]):
        fits &= plan.load[slot, dimension] <= problem.capacity[kind, dimension]
    return fits


@compiled
def _ship(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> bool:
    """Write the load on board after each node, and the most so far; return whether it fits.

    All but the loads of shipments are on board from the start, and what stops put on board stays.
    """
    fits, kind = True, problem.kind[slot]
    for dimension in range(plan.load.shape[1]):
        on = most = plan.load[slot, dimension]
        plan.on[start, dimension] = plan.most[start, dimension] = on
        node = plan.next[start]
        while node != start + 1:
            if dimension == 0:
                plan.ahead[node] = on + problem.initial[kind]
            if problem.delivery[node] >= 0:
                on += problem.demand[node, dimension]
            elif problem.pickup[node] >= 0:
                on -= problem.demand[problem.pickup[node], dimension]
            else:
                on += problem.taken[node, dimension] - problem.demand[node, dimension]
            most = max(most, on)
            plan.on[node, dimension], plan.most[node, dimension] = on, most
            node = plan.next[node]
        fits &= most <= problem.capacity[kind, dimension]
        if dimension == 0:
            plan.ahead[start + 1] = on + problem.initial[kind]
        if problem.takes:
            _look_ahead(plan, start, dimension)
    return fits


@inlined
def _look_ahead(plan: WorkingPlan, start: int, dimension: int) -> None:
    """Write the most load that is on board after each node or a later one."""
    most, node = 0, plan.previous[start + 1]
    while node != start:
        most = max(most, plan.on[node, dimension])
        plan.later[node, dimension] = most
        node = plan.previous[node]
    plan.later[start, dimension] = max(most, plan.on[start, dimension])


@compiled
def _reload(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> bool:
    """Write what each trip of a route brings, and when it is released; return whether it fits."""
    kind, last = problem.kind[slot], plan.previous[start + 1]
    fits = True
    for dimension in range(plan.load.shape[1]):
        on, node = 0, start
        plan.on[start, dimension] = 0
        while node != last:
            node = plan.next[node]
            on = problem.demand[node, dimension] + (0 if plan.via[node] >= 0 else on)
            plan.on[node, dimension] = on
        total = plan.on[last, dimension]
        while True:
            plan.most[node, dimension] = total
            first = node == start or plan.via[node] >= 0
            if first and node != start:
                fits &= total <= problem.whole[kind, dimension]
                total = plan.on[plan.previous[node], dimension]
            if node == start:
                break
            node = plan.previous[node]
        fits &= total <= problem.capacity[kind, dimension]
    _release(problem, plan, slot, start)
    return fits and plan.trips[slot] <= problem.trips[kind]


@inlined
def _release(problem: Problem, plan: WorkingPlan, slot: int, start: int) -> None:
    """Write the number of trips, when each may begin, and the loads on the legs."""
    trips, released = 1, 0.0
    node, kind = plan.previous[start + 1], problem.kind[slot]
    while node != start:
        released = max(released, problem.release[node])
        if plan.via[node] >= 0:
            plan.released[node] = released
            trips += 1
            released = 0.0
        node = plan.previous[node]
    plan.value[slot, RELEASED] = released
    plan.trips[slot] = trips
    if plan.load.shape[1] == 0:
        return
    rest = problem.initial[kind]
    node = plan.next[start]
    while node != start + 1:
        rest = 0 if plan.via[node] >= 0 else rest
        left = plan.most[node, 0] - plan.on[node, 0]
        plan.ahead[node] = rest + left + problem.demand[node, 0]
        node = plan.next[node]
    plan.ahead[start + 1] = rest
