"""Plans as rows of numbers, as archives keep them, and the points of plans."""

import numpy as np

from service.fleet.search.problem import (
    FIRST,
    IMBALANCE,
    MAX,
    OF_PROMISES,
    SECOND,
    SUM,
    UNASSIGNED,
    VEHICLES,
    Array,
    Nodes,
    Problem,
)
from service.fleet.search.route import measure
from service.fleet.search.spreading import on_most_days
from service.fleet.search.values import at_prices
from service.fleet.search.waits import settle
from service.fleet.search.weighed import promised_stops
from service.fleet.search.working_plan import (
    OUTSIDE,
    USED,
    State,
    WorkingPlan,
    free_slot,
    leave_out,
    link,
    mark_used,
    take_in,
)
from service.jit import compiled, inlined


@compiled
def write_row(problem: Problem, plan: WorkingPlan, row: Nodes) -> None:
    """Write a plan as a row: for each route the type of its vehicle as -2 - type, and its stops.

    Stops at which it loads again are among them.
    """
    n, place = len(problem.demand), 0
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        row[place] = -2 - problem.kind[slot]
        place += 1
        node = plan.next[n + 2 * slot]
        while node < n:
            if plan.via[node] >= 0:
                row[place] = plan.via[node]
                place += 1
            row[place] = node
            place += 1
            node = plan.next[node]
    while place < len(row):
        row[place] = -1
        place += 1


@compiled
def load_row(state: State, row: Nodes) -> bool:
    """Make the plan that of a row, as write_row() writes it; return whether its visits can wait."""
    problem, plan, _ = state
    n = len(problem.demand)
    clear(state)
    slot, before, via = -1, -1, -1
    for place in range(len(row)):
        stop = row[place]
        if stop == -1:
            break
        if stop < -1:
            slot = free_slot(problem, plan, -2 - stop)
            before = n + 2 * slot
            mark_used(plan, slot)
        elif not problem.visited[stop]:
            via = stop
        else:
            if problem.pickup[stop] < 0:
                take_in(problem, plan, stop)
            link(plan, slot, stop, before)
            plan.via[stop] = via
            before, via = stop, -1
    for number in range(plan.counts[USED]):
        measure(state, plan.used[number])
    return not problem.waits.given or settle(state, True)


@compiled
def clear(state: State) -> None:
    """Put all stops outside."""
    problem, plan, _ = state
    n = len(problem.demand)
    for slot in range(len(problem.kind)):
        plan.touched[slot] = 0
        start, end = n + 2 * slot, n + 2 * slot + 1
        plan.next[start], plan.previous[end] = end, start
        measure(state, slot)
    for number in range(len(problem.clients)):
        stop = problem.clients[number]
        plan.route[stop] = plan.via[stop] = -1
        if plan.out[stop] < 0 and problem.pickup[stop] < 0:
            leave_out(problem, plan, stop)


@compiled
def write_point(problem: Problem, plan: WorkingPlan, point: Array) -> None:
    """Write the lengths of a plan, shape (m,)."""
    paid = promised = 0
    for objective in range(len(problem.over)):
        if problem.over[objective] == UNASSIGNED:
            paid = objective
        if problem.over[objective] == OF_PROMISES:
            promised = objective
        point[objective] = _joined_value(problem, plan, problem.over[objective], objective)
    for number in range(plan.counts[USED]):
        point[0] += problem.fixed[problem.kind[plan.used[number]]]
    for number in range(plan.counts[OUTSIDE]):
        point[paid] += problem.prize[plan.outside[number]]
        if problem.extras.promises:
            point[promised] += promised_stops(problem, plan.outside[number])


@inlined
def _joined_value(problem: Problem, plan: WorkingPlan, over: int, objective: int) -> float:
    """Return the length of a plan in an objective, without prizes and fixed costs."""
    used = plan.counts[USED]
    if over == VEHICLES:
        return float(used)
    if over == UNASSIGNED or used == 0:
        return 0.0
    if objective == 0 and problem.priced:
        return _at_prices(problem, plan)
    if problem.extras.spreads and over == SUM and problem.extras.deviations[objective] >= 0.0:
        return on_most_days(problem, plan, objective)
    column = problem.column[objective]
    total, longest, shortest = 0.0, 0.0, np.inf
    for number in range(used):
        value = float(plan.value[plan.used[number], column])
        total += value
        longest, shortest = max(longest, value), min(shortest, value)
    if over == MAX:
        return longest
    return longest - shortest if over == IMBALANCE else total


@compiled
def _at_prices(problem: Problem, plan: WorkingPlan) -> float:
    """Return the first length of a plan at the prices of its vehicles."""
    total = 0.0
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        first, second = plan.value[slot, FIRST], plan.value[slot, SECOND]
        total += at_prices(problem, problem.kind[slot], first, second)
    return total
