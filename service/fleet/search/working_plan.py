"""The plan that a search is changing: routes as linked lists, and what is known along them."""

import math
from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import (
    COLUMNS,
    NEIGHBOURS,
    Array,
    Direction,
    Indices,
    Nodes,
    Problem,
)
from service.jit import by_reference, compiled, inlined

# Places of the counts: slots with stops; stops outside, and those of them that must be visited;
# what is saved; the number of the iteration; stops to insert; in how many places one is passed by,
# and how many come before the next; and the number of the stop that is inserted, of all so far;
# whether vehicles may begin one trip more; the first of the types of vehicles that may begin
# routes, and the one after the last; the spots noted for the stop; and whether routes leave, for
# now, when they did before.
USED, OUTSIDE, MISSING, SAVED, SAVED_STOPS, SAVED_OUTSIDE, STAMP, REMOVED = range(8)
BLINKS, UNTIL_BLINK, TRY, MORE_TRIPS, TYPE, TYPES_END, NOTED, AS_BEFORE = range(8, 16)
MOST_NOTED = 128  # spots for a stop that are tried once all are found
MOST_STATES = 24  # ways to have taken so many breaks up to a stop, of which none is always better

_is_over = inlined(is_over)


@by_reference
class WorkingPlan(NamedTuple):
    """Routes, the stops outside, and copies of what an iteration has changed."""

    next: Nodes  # (n + 2 r,), by node
    previous: Nodes
    route: Nodes  # (n,), the slot whose route visits a stop; -1 if none does
    via: Indices  # (n + 2 r,), by node: the stop at which its vehicle loads on the way to it, or -1
    step: Array  # (n + 2 r, 2), by node: both costs of the leg to it
    along: Array  # (n + 2 r,), by node: the first costs since the start
    ahead: Indices  # (n + 2 r,), the load on the leg to here, in the first dimension
    on: Indices  # (n + 2 r, d), with shipments the load on board after the visit, with reloads
    most: Indices  # what this trip has brought; and the most load up to here, or of this trip
    later: Indices  # (n + 2 r, d), with pick-ups of stops, the most load after here or a later stop
    released: Array  # (n + 2 r,), when the load of the trip that begins on the way is released
    ready: Array  # (n + 2 r,), when the visit ends at the earliest
    late: Array  # (n + 2 r,), the lateness up to here
    mean: Array  # (n + 2 r,), where times spread, when the visit begins, and its variance
    variance: Array
    share: Array  # (n + 2 r,), on what share of days it is late
    daily: Array  # (n + 2 r, d), when the visit begins on each day; at the end, the time of a route
    today: Array  # (d,), scratch space
    head: Array  # (n + 2 r, 3), the route up to here: see joined()
    tail: Array  # (n + 2 r, 3), and from here on
    tried: Indices  # (n + 2 r,), by node: the latest stop that was tried after it
    size: Nodes  # (r,), by slot: stops
    load: Indices  # (r, d)
    value: Array  # (r, x): length in both costs, overtime, and the other columns of problem.py
    met: Array  # (r,), what the overlap grows by with the stop that was tried last
    met_at: Indices  # (r,), and the number of that stop
    cost: Array  # (r,), under the direction
    plain: Array  # (r,), the same without breaks
    trips: Indices  # (r,)
    least: Array  # (n + 1,), scratch space for reloads: see reloads.py
    begins: Indices  # (n + 1,)
    loads_at: Indices  # (n + 1,)
    vias: Indices  # (n,)
    held: Indices  # (d,)
    state: Array  # (b + 1, s, 5), scratch space for breaks: see rests.py
    spare: Array  # (s, 5)
    states: Indices  # (b + 1,)
    used: Nodes  # (r,), the slots with stops, in any order
    use: Nodes  # (r,), the place of each slot in `used`; -1 if it has no stops
    outside: Nodes  # (n,), the stops outside, in any order
    out: Nodes  # (n,), the place of each stop in `outside`; -1 if it is visited
    price: Array  # (n,), by stop: what it costs to stay outside
    removed: Nodes  # (n,), stops to insert
    key: Array  # (n,), by which they are sorted
    buffer: Nodes  # (n,), scratch space
    places: Nodes  # (2 k + 1,), scratch space: the nodes before places for a stop
    spots: Indices  # (s, 4), spots for a stop to try, and what it is estimated to cost there
    estimates: Array  # (s,)
    saved: Nodes  # (r,), slots that changed
    saved_size: Nodes  # (r,)
    saved_stops: Nodes  # (n,)
    saved_via: Nodes  # (n,)
    saved_outside: Nodes  # (n,)
    known: Array  # (n + 2 r, 12), by node, and (r, x + d + 2), by slot: see changes.py
    known_of: Array
    touched: Indices  # (r,), by slot: the iteration that changed it last
    ruined: Indices  # (n,), by stop: the iteration that last took stops out of its trip
    counts: Indices  # (16,)
    random: Indices  # (1,)


class State(NamedTuple):
    """A search: the fleet, the plan that it is changing, and what it minimises."""

    problem: Problem
    plan: WorkingPlan
    direction: Direction


def make_working_plan(problem: Problem, seed: int) -> WorkingPlan:
    """Return a plan that leaves out all stops."""
    n, r = len(problem.demand), len(problem.kind)
    nodes, d, breaks = n + 2 * r, problem.demand.shape[1], problem.breaks.shape[1]
    plan = WorkingPlan(
        next=np.arange(1, nodes + 1, dtype=np.int32),
        previous=np.arange(-1, nodes - 1, dtype=np.int32),
        route=_nothing(n),
        via=np.full(nodes, -1),
        step=np.zeros((nodes, 2)),
        along=np.zeros(nodes),
        ahead=np.zeros(nodes, np.int64),
        on=np.zeros((nodes, d), np.int64),
        most=np.zeros((nodes, d), np.int64),
        later=np.zeros((nodes if problem.takes else 1, d), np.int64),
        released=np.zeros(nodes),
        ready=np.zeros(nodes),
        late=np.zeros(nodes),
        mean=np.zeros(nodes),
        variance=np.zeros(nodes),
        share=np.zeros(nodes),
        daily=np.zeros((nodes, problem.extras.days)),
        today=np.zeros(problem.extras.days),
        head=np.zeros((nodes, 3)),
        tail=np.zeros((nodes, 3)),
        tried=np.zeros(nodes, np.int64),
        size=np.zeros(r, np.int32),
        load=np.zeros((r, d), np.int64),
        value=np.zeros((r, COLUMNS)),
        met=np.zeros(r),
        met_at=np.zeros(r, np.int64),
        cost=np.zeros(r),
        plain=np.zeros(r),
        trips=np.ones(r, np.int64),
        least=np.zeros(n + 1),
        begins=np.zeros(n + 1, np.int64),
        loads_at=np.zeros(n + 1, np.int64),
        vias=np.zeros(n, np.int64),
        held=np.zeros(d, np.int64),
        state=np.zeros((breaks + 1, MOST_STATES, 5)),
        spare=np.zeros((MOST_STATES, 5)),
        states=np.zeros(breaks + 1, np.int64),
        used=_nothing(r),
        use=_nothing(r),
        outside=_nothing(n),
        out=_nothing(n),
        price=np.zeros(n),
        removed=_nothing(n),
        key=np.zeros(n),
        buffer=_nothing(n),
        places=_nothing(2 * NEIGHBOURS + 1),
        spots=np.zeros((MOST_NOTED, 4), np.int64),
        estimates=np.zeros(MOST_NOTED),
        saved=_nothing(r),
        saved_size=_nothing(r),
        saved_stops=_nothing(n),
        saved_via=_nothing(n),
        saved_outside=_nothing(n),
        known=np.zeros((nodes, 12)),
        known_of=np.zeros((r, COLUMNS + d + 2)),
        touched=np.zeros(r, np.int64),
        ruined=np.zeros(n, np.int64),
        counts=np.zeros(16, np.int64),
        random=np.array([_mixed(seed)], np.int64),
    )
    plan.counts[TYPES_END] = len(problem.capacity)
    for stop in problem.tasks.tolist():
        plan.out[stop] = plan.counts[OUTSIDE]
        plan.outside[plan.counts[OUTSIDE]] = stop
        plan.counts[OUTSIDE] += 1
        plan.counts[MISSING] += np.isinf(problem.prize[stop])
    return plan


def _nothing(size: int) -> Nodes:
    return np.full(size, -1, np.int32)


def _mixed(seed: int) -> int:
    """Return the first state of the random numbers of a seed: odd, and not small."""
    return int(np.random.default_rng(seed).integers(2**20, 2**62)) | 1


@inlined
def slot_of(problem: Problem, plan: WorkingPlan, node: int) -> int:
    """Return the route of a stop, a start or an end; -1 for a stop outside."""
    n = len(problem.demand)
    return (node - n) // 2 if node >= n else plan.route[node]


@inlined
def leg(problem: Problem, profile: int, a: int, b: int, layer: int) -> float:
    """Return what a leg between two places costs in a profile; 0 from or to anywhere."""
    if a < 0 or b < 0:
        return 0.0
    if len(problem.places) > 0:
        return line(problem, profile, a, b, layer)
    return float(problem.costs[profile, a, b, layer])


@inlined
def line(problem: Problem, profile: int, a: int, b: int, layer: int) -> float:
    """Return what a leg that is a line costs in a profile."""
    square = 0.0
    for axis in range(3):
        side = problem.places[a, layer, axis] - problem.places[b, layer, axis]
        square += side * side
    length = math.sqrt(square)
    if problem.curved[layer]:
        length = 2.0 * math.asin(min(1.0, 0.5 * length))
    return float(problem.factors[profile, layer] * length)


@inlined
def way(problem: Problem, profile: int, a: int, via: int, b: int, layer: int) -> float:
    """Return what the way between two places costs, through a third unless that is -1."""
    if via < 0:
        return leg(problem, profile, a, b, layer)
    return leg(problem, profile, a, via, layer) + leg(problem, profile, via, b, layer)


@inlined
def service_at(problem: Problem, profile: int, stop: int) -> float:
    """Return how long the visit of a stop takes in a profile."""
    return float(problem.service[profile, stop])


@inlined
def begin_at(problem: Problem, stop: int, arrival: float) -> float:
    """Return when a visit begins, in the first window that is not over; infinite after all."""
    for number in range(problem.windows.shape[1]):
        if not _is_over(arrival, problem.windows[stop, number, 1]):
            return max(arrival, problem.windows[stop, number, 0])
    return np.inf


@inlined
def mark_used(plan: WorkingPlan, slot: int) -> None:
    """Count a slot among those with stops."""
    if plan.use[slot] < 0:
        plan.use[slot] = plan.counts[USED]
        plan.used[plan.counts[USED]] = slot
        plan.counts[USED] += 1


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
    """Take a stop out of its route. Where its vehicle loads before it, it loads before the next."""
    before, after = plan.previous[stop], plan.next[stop]
    plan.next[before], plan.previous[after] = after, before
    plan.route[stop] = -1
    if plan.via[stop] >= 0:
        if plan.via[after] < 0 and after < len(plan.route):
            plan.via[after] = plan.via[stop]
        plan.via[stop] = -1


@inlined
def any_type(problem: Problem, plan: WorkingPlan) -> None:
    """Let vehicles of all types begin routes."""
    plan.counts[TYPE], plan.counts[TYPES_END] = 0, len(problem.capacity)


@compiled
def free_slot(problem: Problem, plan: WorkingPlan, kind: int) -> int:
    """Return a slot without stops of a type of vehicles; -1 if all are in use."""
    for slot in range(problem.slots[kind], problem.slots[kind + 1]):
        if plan.use[slot] < 0:
            return slot
    return -1


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
