"""The plan that a search is changing: routes as linked lists, and what is known along them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.rounding import is_over
from service.fleet.search.problem import Array, Direction, Indices, Nodes, Problem
from service.jit import compiled, inlined

_is_over = inlined(is_over)

# Columns of the values of a route.
FIRST, SECOND, OVER_TIME, LATE, LOADED, RELEASED = range(6)
# Places of the counts.
USED, OUTSIDE, MISSING, SAVED, SAVED_STOPS, SAVED_OUTSIDE, STAMP, REMOVED, BLINKS = range(9)


class WorkingPlan(NamedTuple):
    """Routes, the stops outside, and copies of what an iteration has changed."""

    next: Nodes  # (n + 2 r,), by node
    previous: Nodes
    route: Nodes  # (n,), the slot whose route visits a stop; -1 if none does
    along: Array  # (n + 2 r,), by node: the first costs since the start
    ahead: Indices  # (n + 2 r,), the load in the first dimension that is brought from here on
    ready: Array  # (n + 2 r,), when the visit ends at the earliest
    late: Array  # (n + 2 r,), the lateness up to here
    head: Array  # (n + 2 r, 3), the route up to here: see joined()
    tail: Array  # (n + 2 r, 3), and from here on
    size: Nodes  # (r,), by slot: stops
    load: Indices  # (r, d)
    value: Array  # (r, 6): length in both costs, overtime, lateness, load times distance, release
    cost: Array  # (r,), under the direction
    used: Nodes  # (r,), the slots with stops, in any order
    use: Nodes  # (r,), the place of each slot in `used`; -1 if it has no stops
    outside: Nodes  # (n,), the stops outside, in any order
    out: Nodes  # (n,), the place of each stop in `outside`; -1 if it is visited
    price: Array  # (n,), by stop: what it costs to stay outside
    removed: Nodes  # (n,), stops to insert
    key: Array  # (n,), by which they are sorted
    buffer: Nodes  # (n,), scratch space
    saved: Nodes  # (r,), slots that changed
    saved_size: Nodes  # (r,)
    saved_stops: Nodes  # (n,)
    saved_outside: Nodes  # (n,)
    touched: Indices  # (r,), by slot: the iteration that changed it last
    counts: Indices  # (9,)
    random: Indices  # (1,)


def make_working_plan(problem: Problem, seed: int) -> WorkingPlan:
    """Return a plan that leaves out all stops."""
    n, r = len(problem.demand), len(problem.kind)
    nodes = n + 2 * r
    of_stops, of_slots = (lambda: np.full(n, -1, np.int32)), (lambda: np.full(r, -1, np.int32))
    plan = WorkingPlan(
        next=np.arange(1, nodes + 1, dtype=np.int32),
        previous=np.arange(-1, nodes - 1, dtype=np.int32),
        route=of_stops(),
        along=np.zeros(nodes),
        ahead=np.zeros(nodes, np.int64),
        ready=np.zeros(nodes),
        late=np.zeros(nodes),
        head=np.zeros((nodes, 3)),
        tail=np.zeros((nodes, 3)),
        size=np.zeros(r, np.int32),
        load=np.zeros((r, problem.demand.shape[1]), np.int64),
        value=np.zeros((r, 6)),
        cost=np.zeros(r),
        used=of_slots(),
        use=of_slots(),
        outside=of_stops(),
        out=of_stops(),
        price=np.zeros(n),
        removed=of_stops(),
        key=np.zeros(n),
        buffer=of_stops(),
        saved=of_slots(),
        saved_size=of_slots(),
        saved_stops=of_stops(),
        saved_outside=of_stops(),
        touched=np.zeros(r, np.int64),
        counts=np.zeros(9, np.int64),
        random=np.array([_mixed(seed)], np.int64),
    )
    for stop in problem.clients.tolist():
        plan.out[stop] = plan.counts[OUTSIDE]
        plan.outside[plan.counts[OUTSIDE]] = stop
        plan.counts[OUTSIDE] += 1
        plan.counts[MISSING] += np.isinf(problem.prize[stop])
    return plan


def _mixed(seed: int) -> int:
    """Return the first state of the random numbers of a seed: odd, and not small."""
    return int(np.random.default_rng(seed).integers(2**20, 2**62)) | 1


@inlined
def leg(problem: Problem, a: int, b: int, layer: int) -> float:
    """Return a cost of the leg between two places; 0 from or to anywhere."""
    if a < 0 or b < 0:
        return 0.0
    return problem.costs[a, b, layer]


class Span(NamedTuple):
    """A part of a route: the least time it takes, and the departures that take only this time.

    Attributes:
        time: The least time, with waiting.
        early: The first such departure. Leaving before only adds waiting.
        late: The last departure that keeps all windows.
    """

    time: float
    early: float
    late: float


@inlined
def joined(a: Span, way: float, b: Span) -> tuple[Span, bool]:
    """Return two parts of a route with a leg between them, and whether they keep all windows.

    Vidal et al. (2013), time-window segments.
    """
    until = a.time + way
    waiting = max(0.0, b.early - until - a.late)
    span = Span(
        until + waiting + b.time,
        max(a.early, b.early - until) - waiting,
        min(a.late, b.late - until),
    )
    return span, not _is_over(a.early + until, b.late)


@inlined
def stay(problem: Problem, stop: int) -> Span:
    """Return the visit of a stop as a part of a route."""
    return Span(problem.service[stop], problem.opens[stop], problem.closes[stop])


@inlined
def head_at(plan: WorkingPlan, node: int) -> Span:
    """Return the route up to a node."""
    return Span(plan.head[node, 0], plan.head[node, 1], plan.head[node, 2])


@inlined
def tail_at(plan: WorkingPlan, node: int) -> Span:
    """Return the route from a node on."""
    return Span(plan.tail[node, 0], plan.tail[node, 1], plan.tail[node, 2])


@inlined
def _set_span(rows: Array, node: int, span: Span) -> None:
    rows[node, 0], rows[node, 1], rows[node, 2] = span.time, span.early, span.late


@inlined
def route_cost(
    problem: Problem,
    direction: Direction,
    kind: int,
    first: float,
    second: float,
    overtime: float,
    lateness: float,
    loaded: float,
) -> float:
    """Return the cost of a route that visits a stop, of these values, under a direction."""
    cost = (
        direction.costs[0] * first
        + direction.costs[1] * second
        + direction.vehicle
        + direction.fixed * problem.fixed[kind]
        + direction.overtime * overtime
        + direction.lateness * lateness
        + direction.load_distance * loaded
    )
    length = first if problem.swept == 0 else second
    beyond = max(0.0, length - direction.longest) + max(0.0, direction.shortest - length)
    return cost + direction.penalty * beyond


@compiled
def measure(problem: Problem, plan: WorkingPlan, direction: Direction, slot: int) -> bool:
    """Work out what is known along a route and its cost; return whether it keeps all rules."""
    n = len(problem.demand)
    start, end = n + 2 * slot, n + 2 * slot + 1
    kind = problem.kind[slot]
    if plan.next[start] == end:
        _empty(problem, plan, slot, start, end)
        return True
    _mark_used(plan, slot)
    fits = _gather(problem, plan, slot, start, end)
    legs, duration, in_time = _forward(problem, plan, slot, start, end)
    if problem.clock >= 0:
        _backward(problem, plan, start, end, kind)
        fits &= in_time
    first, second = legs
    if problem.clock == 0:
        first = duration
    if problem.clock == 1:
        second = duration
    plan.value[slot, FIRST], plan.value[slot, SECOND] = first, second
    length = first if problem.limited == 0 else second
    reach = plan.ready[end] if problem.clock >= 0 else 0.0
    fits &= not _is_over(length, problem.longest[kind], reach)
    fits &= legs[0] < problem.forbidden
    overtime = 0.0
    if problem.clock >= 0:
        overtime = max(0.0, plan.ready[end] - problem.shift_end[kind])
    plan.value[slot, OVER_TIME] = overtime
    plan.value[slot, LATE] = plan.late[end]
    plan.cost[slot] = route_cost(
        problem,
        direction,
        kind,
        first,
        second,
        overtime,
        plan.late[end],
        plan.value[slot, LOADED],
    )
    return fits


@inlined
def _empty(problem: Problem, plan: WorkingPlan, slot: int, start: int, end: int) -> None:
    """Set what is known of a route without stops."""
    place = plan.use[slot]
    if place >= 0:
        plan.counts[USED] -= 1
        last = plan.used[plan.counts[USED]]
        plan.used[place] = last
        plan.use[last] = place
        plan.use[slot] = -1
    plan.size[slot] = 0
    plan.cost[slot] = 0.0
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] = 0
    for column in range(plan.value.shape[1]):
        plan.value[slot, column] = 0.0
    kind = problem.kind[slot]
    _set_span(plan.head, start, Span(0.0, problem.departs[kind], problem.leaves_by[kind]))
    _set_span(plan.tail, end, Span(0.0, 0.0, problem.returns[kind]))
    plan.ready[start] = problem.departs[kind]
    plan.late[start] = 0.0
    plan.along[start] = 0.0
    plan.ahead[end] = problem.initial[kind]


@inlined
def _mark_used(plan: WorkingPlan, slot: int) -> None:
    if plan.use[slot] < 0:
        plan.use[slot] = plan.counts[USED]
        plan.used[plan.counts[USED]] = slot
        plan.counts[USED] += 1


@inlined
def _gather(problem: Problem, plan: WorkingPlan, slot: int, start: int, end: int) -> bool:
    """Sum what a route carries, from its end on; return whether its vehicle can."""
    kind = problem.kind[slot]
    for dimension in range(plan.load.shape[1]):
        plan.load[slot, dimension] = 0
    size, released = 0, 0.0
    ahead = problem.initial[kind]
    plan.ahead[end] = ahead
    node = plan.previous[end]
    while node != start:
        for dimension in range(plan.load.shape[1]):
            plan.load[slot, dimension] += problem.demand[node, dimension]
        if plan.load.shape[1] > 0:
            ahead += problem.demand[node, 0]
        plan.ahead[node] = ahead
        released = max(released, problem.release[node])
        size += 1
        node = plan.previous[node]
    plan.size[slot] = size
    plan.value[slot, RELEASED] = released
    fits = True
    for dimension in range(plan.load.shape[1]):
        fits &= plan.load[slot, dimension] <= problem.capacity[kind, dimension]
    return fits


@inlined
def _forward(
    problem: Problem, plan: WorkingPlan, slot: int, start: int, end: int
) -> tuple[tuple[float, float], float, bool]:
    """Write what is known up to each node of a route.

    Returns:
        The sums of both costs of its legs; the time from the departure to the end, where the
        vehicle leaves as late as makes neither the end later nor a visit later than due; and
        whether it keeps all windows.
    """
    kind = problem.kind[slot]
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    span = Span(0.0, departs, problem.leaves_by[kind])
    in_time = not _is_over(departs, problem.leaves_by[kind])
    _set_span(plan.head, start, span)
    ready, late, waiting, slack = departs, 0.0, 0.0, np.inf
    plan.ready[start], plan.late[start], plan.along[start] = ready, late, 0.0
    first, second, loaded = 0.0, 0.0, 0.0
    at, node = problem.place[start], plan.next[start]
    while True:
        there = problem.place[node]
        way = leg(problem, at, there, 0)
        if plan.load.shape[1] > 0:
            loaded += way * plan.ahead[node]
        first += way
        second += leg(problem, at, there, 1)
        plan.along[node] = first
        if problem.clock >= 0:
            way = leg(problem, at, there, problem.clock)
            visit = Span(0.0, 0.0, problem.returns[kind])
            if node != end:
                visit = stay(problem, node)
                begin = max(ready + way, problem.opens[node])
                waiting += begin - (ready + way)
                until = min(problem.closes[node], max(problem.due[node], begin))
                slack = min(slack, until - begin + waiting)
                if _is_over(begin, problem.due[node]):
                    late += begin - problem.due[node]
                ready = begin + problem.service[node]
            else:
                ready += way
            span, kept = joined(span, way, visit)
            in_time &= kept
            _set_span(plan.head, node, span)
            plan.ready[node], plan.late[node] = ready, late
        at = there
        if node == end:
            break
        node = plan.next[node]
    plan.value[slot, LOADED] = loaded
    slack = min(slack, problem.returns[kind] - ready + waiting, problem.leaves_by[kind] - departs)
    return (first, second), ready - departs - max(0.0, min(waiting, slack)), in_time


@inlined
def _backward(problem: Problem, plan: WorkingPlan, start: int, end: int, kind: int) -> None:
    """Write what is known from each node of a route on."""
    span = Span(0.0, 0.0, problem.returns[kind])
    _set_span(plan.tail, end, span)
    at, node = problem.place[end], plan.previous[end]
    while node != start:
        way = leg(problem, problem.place[node], at, problem.clock)
        span, _ = joined(stay(problem, node), way, span)
        _set_span(plan.tail, node, span)
        at = problem.place[node]
        node = plan.previous[node]


@compiled
def total_cost(plan: WorkingPlan) -> float:
    """Return the cost of all routes and of the stops outside.

    It is summed afresh: of a sum from which a huge cost was taken nothing would be left.
    """
    cost = 0.0
    for number in range(plan.counts[USED]):
        cost += plan.cost[plan.used[number]]
    for place in range(plan.counts[OUTSIDE]):
        cost += plan.price[plan.outside[place]]
    return cost


@compiled
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
        counts[SAVED_STOPS] += 1
        size += 1
        node = plan.next[node]
    plan.saved[counts[SAVED]] = slot
    plan.saved_size[counts[SAVED]] = size
    counts[SAVED] += 1


@compiled
def begin_iteration(plan: WorkingPlan) -> None:
    """Note what restore() returns to."""
    counts = plan.counts
    counts[STAMP] += 1
    counts[SAVED] = counts[SAVED_STOPS] = counts[REMOVED] = 0
    counts[SAVED_OUTSIDE] = counts[OUTSIDE]
    for place in range(counts[OUTSIDE]):
        plan.saved_outside[place] = plan.outside[place]


@compiled
def restore(problem: Problem, plan: WorkingPlan, direction: Direction) -> None:
    """Return to the plan before this iteration."""
    counts, n = plan.counts, len(problem.demand)
    while counts[OUTSIDE] > 0:
        take_in(problem, plan, plan.outside[counts[OUTSIDE] - 1])
    for place in range(counts[SAVED_OUTSIDE]):
        leave_out(problem, plan, plan.saved_outside[place])
        plan.route[plan.saved_outside[place]] = -1
    first = 0
    for number in range(counts[SAVED]):
        slot = plan.saved[number]
        start, end = n + 2 * slot, n + 2 * slot + 1
        before = start
        for place in range(first, first + plan.saved_size[number]):
            stop = plan.saved_stops[place]
            plan.next[before], plan.previous[stop] = stop, before
            plan.route[stop] = slot
            before = stop
        plan.next[before], plan.previous[end] = end, before
        first += plan.saved_size[number]
        measure(problem, plan, direction, slot)


@inlined
def leave_out(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    """Put a stop outside."""
    plan.out[stop] = plan.counts[OUTSIDE]
    plan.outside[plan.counts[OUTSIDE]] = stop
    plan.counts[OUTSIDE] += 1
    plan.counts[MISSING] += problem.prize[stop] == np.inf


@inlined
def take_in(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    """Take a stop from outside."""
    place = plan.out[stop]
    plan.counts[OUTSIDE] -= 1
    last = plan.outside[plan.counts[OUTSIDE]]
    plan.outside[place] = last
    plan.out[last] = place
    plan.out[stop] = -1
    plan.counts[MISSING] -= problem.prize[stop] == np.inf


@inlined
def link(plan: WorkingPlan, slot: int, stop: int, before: int) -> None:
    """Put a stop into a route after a node."""
    after = plan.next[before]
    plan.next[before], plan.previous[stop] = stop, before
    plan.next[stop], plan.previous[after] = after, stop
    plan.route[stop] = slot


@inlined
def unlink(plan: WorkingPlan, stop: int) -> None:
    """Take a stop out of its route."""
    before, after = plan.previous[stop], plan.next[stop]
    plan.next[before], plan.previous[after] = after, before
    plan.route[stop] = -1


Row = NDArray[np.int32]


@compiled
def write_row(problem: Problem, plan: WorkingPlan, row: Row) -> None:
    """Write a plan as a row: for each route the type of its vehicle as -2 - type, and its stops."""
    n, place = len(problem.demand), 0
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        row[place] = -2 - problem.kind[slot]
        place += 1
        node = plan.next[n + 2 * slot]
        while node < n:
            row[place] = node
            place += 1
            node = plan.next[node]
    while place < len(row):
        row[place] = -1
        place += 1


@compiled
def load_row(problem: Problem, plan: WorkingPlan, direction: Direction, row: Row) -> None:
    """Make the plan that of a row, as write_row() writes it."""
    n = len(problem.demand)
    clear(problem, plan, direction)
    for slot in range(len(problem.kind)):
        plan.touched[slot] = 0
    slot, before = -1, -1
    for place in range(len(row)):
        stop = row[place]
        if stop == -1:
            break
        if stop < -1:
            if slot >= 0:
                measure(problem, plan, direction, slot)
            slot = free_slot(problem, plan, -2 - stop)
            before = n + 2 * slot
            _mark_used(plan, slot)
        else:
            take_in(problem, plan, stop)
            link(plan, slot, stop, before)
            before = stop
    if slot >= 0:
        measure(problem, plan, direction, slot)


@compiled
def clear(problem: Problem, plan: WorkingPlan, direction: Direction) -> None:
    """Put all stops outside."""
    n = len(problem.demand)
    for slot in range(len(problem.kind)):
        start, end = n + 2 * slot, n + 2 * slot + 1
        plan.next[start], plan.previous[end] = end, start
        measure(problem, plan, direction, slot)
    for number in range(len(problem.clients)):
        stop = problem.clients[number]
        plan.route[stop] = -1
        if plan.out[stop] < 0:
            leave_out(problem, plan, stop)


@compiled
def free_slot(problem: Problem, plan: WorkingPlan, kind: int) -> int:
    """Return a slot without stops of a type of vehicles; -1 if all are in use."""
    for slot in range(problem.slots[kind], problem.slots[kind + 1]):
        if plan.use[slot] < 0:
            return slot
    return -1


@compiled
def write_point(problem: Problem, plan: WorkingPlan, point: Array) -> None:
    """Write the lengths of a plan, shape (m,)."""
    paid = 0
    for objective in range(len(problem.over)):
        if problem.over[objective] == 3:
            paid = objective
        point[objective] = _joined_value(problem, plan, problem.over[objective], objective)
    for number in range(plan.counts[USED]):
        point[0] += problem.fixed[problem.kind[plan.used[number]]]
    for number in range(plan.counts[OUTSIDE]):
        point[paid] += problem.prize[plan.outside[number]]


@inlined
def _joined_value(problem: Problem, plan: WorkingPlan, over: int, objective: int) -> float:
    """Return the length of a plan in an objective, without prizes and fixed costs."""
    used = plan.counts[USED]
    if over == 2:
        return float(used)
    if over == 3 or used == 0:
        return 0.0
    column = problem.layer[objective] if over <= 1 else over - 2
    if over == 6:
        column = problem.swept
    if over == 7:
        column = LOADED
    total, longest, shortest = 0.0, 0.0, np.inf
    for number in range(used):
        value = plan.value[plan.used[number], column]
        total += value
        longest, shortest = max(longest, value), min(shortest, value)
    if over == 1:
        return longest
    return longest - shortest if over == 6 else total
