"""Find where a stop costs the least: in the routes of its neighbours, or in one of its own.

A vehicle that may load again may do so just before or just after the stop.
"""

from service.fleet.rounding import is_over
from service.fleet.search.companions import may_join, order_kept
from service.fleet.search.problem import NEIGHBOURS, Problem
from service.fleet.search.spots import Place, Spot, best_noted, better_at, nowhere
from service.fleet.search.waits import bound
from service.fleet.search.working_plan import (
    BLINKS,
    MORE_TRIPS,
    OUTSIDE,
    REMOVED,
    TRY,
    TYPE,
    TYPES_END,
    UNTIL_BLINK,
    USED,
    State,
    WorkingPlan,
    free_slot,
    service_at,
    slot_of,
)
from service.jit import compiled, inlined
from service.search.local_search import random_below

_is_over = inlined(is_over)

_SELDOM = 3  # one time in so many, one trip more is tried where the stop fits without
_FEW = 8  # of them that are in routes: then all routes are tried
# Where so many more stops are outside than are inserted, one that does not fit near its neighbours
# is tried in all routes one time in so many: most fit nowhere then.
_MANY_OUTSIDE, _SELDOM_ANYWHERE = 20, 10


@compiled
def best_place(state: State, stop: int, most: float) -> Place:
    """Return the cheapest place for a stop that costs less than `most`; slot -1 if there is none.

    One place in `counts[BLINKS]` is passed by, on the mean.
    """
    problem, plan, _ = state
    best = nowhere(most)
    plan.counts[TRY] += 1
    if problem.simple:
        inside, best = _beside_if_simple(state, stop, best)
    else:
        inside, best = _beside(state, stop, best)
    best = best_noted(state, stop, best)
    if inside < _FEW or (best.slot < 0 and _looks_far(plan)):
        best = _anywhere(state, stop, best)
    for kind in range(plan.counts[TYPE], plan.counts[TYPES_END]):
        slot = new_slot(state, kind)
        if slot >= 0 and has_room(problem, plan, stop, slot):
            best = _better(state, stop, slot, len(problem.demand) + 2 * slot, best)
    # Of two equal places that in a route of its own is the better: it depends on nothing.
    best = _between_trips(state, stop, best) if plan.counts[MORE_TRIPS] > 0 else best
    return best_noted(state, stop, best)


@inlined
def _beside(state: State, stop: int, best: Place) -> tuple[int, Place]:
    """Return how many neighbours of a stop are in routes, and the best place so far or by these."""
    problem, plan, _ = state
    inside = 0
    for number in range(min(NEIGHBOURS, problem.near.shape[1])):
        beside = problem.near[stop, number]
        slot = plan.route[beside]
        if slot < 0:
            continue
        inside += 1
        if not has_room(problem, plan, stop, slot):
            continue
        best = _better(state, stop, slot, beside, best)
        best = _better(state, stop, slot, plan.previous[beside], best)
    return inside, best


@inlined
def _beside_if_simple(state: State, stop: int, best: Place) -> tuple[int, Place]:
    """Return the same, sooner, where only loads and times forbid places.

    First all places are found that these may allow, then each is tried.
    """
    problem, plan, _ = state
    inside = found = 0
    # No branch of this loop depends on the plan: a processor would predict half of them wrongly.
    for number in range(min(NEIGHBOURS, problem.near.shape[1])):
        node = problem.near[stop, number]
        slot = plan.route[node]
        fits = slot >= 0
        inside += fits
        slot = max(slot, 0)
        for dimension in range(plan.load.shape[1]):
            load = plan.load[slot, dimension] + problem.demand[stop, dimension]
            fits &= load <= problem.capacity[problem.kind[slot], dimension]
        beside, least = problem.extras.times_beside[stop, number], problem.extras.least_times[stop]
        plan.places[found] = node
        found += fits & _may_be_in_time(problem, plan, stop, slot, node, (beside[0], least[1]))
        before = max(plan.previous[node], 0)
        plan.places[found] = before
        found += fits & _may_be_in_time(problem, plan, stop, slot, before, (least[0], beside[1]))
    for place in range(found):
        before = plan.places[place]
        if not _passes_by(plan, before):
            best = _after(state, stop, slot_of(problem, plan, before), before, best)
    return inside, best


@inlined
def _may_be_in_time(
    problem: Problem,
    plan: WorkingPlan,
    stop: int,
    slot: int,
    before: int,
    legs: tuple[float, float],
) -> bool:
    """Return whether a stop after a node may be in time, if its legs took as little as is given."""
    if problem.clock < 0:
        return True
    begin = max(plan.head[before, 0] + plan.head[before, 1] + legs[0], problem.opens[stop])
    end = begin + service_at(problem, problem.profile[slot], stop) + legs[1]
    late = _is_over(begin, problem.closes[stop])
    return not (late | _is_over(end, plan.tail[plan.next[before], 2]))


@inlined
def new_slot(state: State, kind: int) -> int:
    """Return the slot of a vehicle of a type for one more route; -1 if there may be none."""
    problem, plan, direction = state
    return free_slot(problem, plan, kind) if plan.counts[USED] < direction.routes else -1


@inlined
def _looks_far(plan: WorkingPlan) -> bool:
    """Return whether to try all routes for a stop that does not fit near its neighbours."""
    few = plan.counts[OUTSIDE] <= _MANY_OUTSIDE + plan.counts[REMOVED]
    return few or random_below(plan.random, _SELDOM_ANYWHERE) == 0


@compiled
def _anywhere(state: State, stop: int, best: Place) -> Place:
    """Return the cheapest place in all routes."""
    plan = state.plan
    for number in range(plan.counts[USED]):
        best = _along(state, stop, plan.used[number], best)
    return best


@compiled
def in_route(state: State, stop: int, slot: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and the cheapest in a route."""
    return best_noted(state, stop, _along(state, stop, slot, best))


@compiled
def _along(state: State, stop: int, slot: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and the cheapest known in a route."""
    problem, plan, _ = state
    if not has_room(problem, plan, stop, slot):
        return best
    node, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    while node != end:
        best = _better(state, stop, slot, node, best)
        node = plan.next[node]
    return best


@compiled
def _between_trips(state: State, stop: int, best: Place) -> Place:
    """Return the cheapest place after the last stop of each trip, where a new one may begin."""
    problem, plan, _ = state
    n = len(problem.demand)
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        if not has_room(problem, plan, stop, slot):
            continue
        node = n + 2 * slot
        while node != n + 2 * slot + 1:
            after = plan.next[node]
            if after >= n or plan.via[after] >= 0:
                best = _better(state, stop, slot, node, best)
            node = after
    return best


@inlined
def has_room(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Return whether a vehicle may be able to carry one more stop's load."""
    kind = problem.kind[slot]
    fits = True
    if problem.waits.given:
        bound(problem, plan, stop, slot)
    if problem.grouped and not may_join(problem, plan, stop, slot):
        return False
    if problem.takes and not _may_take(problem, plan, stop, slot):
        return False
    if problem.ships or plan.counts[MORE_TRIPS] > 0 or plan.trips[slot] > 1:
        for dimension in range(plan.load.shape[1]):
            fits &= problem.demand[stop, dimension] <= problem.whole[kind, dimension]
        return fits
    for dimension in range(plan.load.shape[1]):
        load = plan.load[slot, dimension] + problem.demand[stop, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@inlined
def _may_take(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Return whether a vehicle can hold at its end what one more stop puts on board as well."""
    kind, fits = problem.kind[slot], True
    last = plan.previous[len(problem.demand) + 2 * slot + 1]
    for dimension in range(plan.on.shape[1]):
        load = plan.on[last, dimension] + problem.taken[stop, dimension]
        fits &= load <= problem.capacity[kind, dimension]
    return fits


@inlined
def blinks(plan: WorkingPlan) -> bool:
    """Return whether to pass by a place: at random, one in `counts[BLINKS]` on the mean."""
    plan.counts[UNTIL_BLINK] -= 1
    if plan.counts[UNTIL_BLINK] > 0:
        return False
    plan.counts[UNTIL_BLINK] = 1 + random_below(plan.random, 2 * plan.counts[BLINKS] - 1)
    return True


@inlined
def _better(state: State, stop: int, slot: int, before: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and that after a node."""
    problem, plan, _ = state
    if _passes_by(plan, before):
        return best
    if problem.clock >= 0:
        legs = problem.extras.least_times[stop, 0], problem.extras.least_times[stop, 1]
        if not _may_be_in_time(problem, plan, stop, slot, before, legs):
            return best
    return _after(state, stop, slot, before, best)


@inlined
def _passes_by(plan: WorkingPlan, before: int) -> bool:
    """Return whether not to try a stop after a node: it was tried there, or at random."""
    if plan.tried[before] == plan.counts[TRY]:
        return True
    plan.tried[before] = plan.counts[TRY]
    return blinks(plan)


@inlined
def _after(state: State, stop: int, slot: int, before: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and that after a node, which is tried."""
    problem, plan, _ = state
    if problem.ordered and not order_kept(problem, plan, stop, slot, before):
        return best
    if problem.reloads:
        return _with_reloads(state, stop, slot, before, best)
    if problem.carries and not _carries_too(problem, plan, stop, slot, before):
        return best
    return better_at(state, stop, Spot(slot, before, -1, -1), best)


@inlined
def _carries_too(problem: Problem, plan: WorkingPlan, stop: int, slot: int, before: int) -> bool:
    """Return whether a vehicle can bring one more stop's load after a node, and take it on there.

    What is brought is on board up to there, what is taken on from there on.
    """
    kind, fits = problem.kind[slot], True
    for dimension in range(plan.most.shape[1]):
        load = plan.most[before, dimension] + problem.demand[stop, dimension]
        fits &= load <= problem.capacity[kind, dimension]
        if problem.takes:
            load = plan.later[before, dimension] + problem.taken[stop, dimension]
            fits &= load <= problem.capacity[kind, dimension]
    return fits


@compiled
def _with_reloads(state: State, stop: int, slot: int, before: int, best: Place) -> Place:
    """Return the better of two places: the best so far, and after a node, maybe with a reload."""
    problem, plan, direction = state
    kind, after = problem.kind[slot], plan.next[before]
    known = plan.via[after]
    fits = _brings(state, stop, slot, before, False)
    if fits:
        best = better_at(state, stop, Spot(slot, before, -1, known), best)
    if known >= 0 and _brings(state, stop, slot, after, False):
        fits = True
        best = better_at(state, stop, Spot(slot, before, known, -1), best)
    # A trip more helps where it must, or where what is carried counts; else seldom.
    fits &= direction.load_distance == 0
    if plan.counts[MORE_TRIPS] == 0 or (fits and random_below(plan.random, _SELDOM) > 0):
        return best
    for number in range(problem.reload.shape[1]):
        if problem.reload[kind, number] >= 0 and plan.trips[slot] < problem.trips[kind]:
            spot = Spot(slot, before, problem.reload[kind, number], known)
            best = _loading(state, stop, spot, best)
    return best


@inlined
def _loading(state: State, stop: int, spot: Spot, best: Place) -> Place:
    """Return the better of two places: the best so far, and a spot with one reload more.

    The vehicle loads at `spot.via` before the stop, after it, or both.
    """
    problem, plan, _ = state
    slot, before, via, known = spot
    kind = problem.kind[slot]
    if _begins(state, stop, kind, before, known >= 0):
        best = better_at(state, stop, spot, best)
    if known >= 0 or plan.next[before] >= len(problem.demand):
        return best
    if _brings(state, stop, slot, before, True):
        best = better_at(state, stop, Spot(slot, before, -1, via), best)
    if plan.trips[slot] + 1 < problem.trips[kind] and _begins(state, stop, kind, before, True):
        best = better_at(state, stop, Spot(slot, before, via, via), best)
    return best


@inlined
def _brings(state: State, stop: int, slot: int, node: int, ending: bool) -> bool:
    """Return whether the trip of a node has room for a stop, maybe if it ends after the node."""
    problem, plan, _ = state
    kind, fits = problem.kind[slot], True
    for dimension in range(plan.on.shape[1]):
        load = plan.on[node, dimension] if ending else plan.most[node, dimension]
        most = problem.whole[kind, dimension]
        if problem.capacity[kind, dimension] < most and _is_first(problem, plan, node):
            most = problem.capacity[kind, dimension]
        fits &= load + problem.demand[stop, dimension] <= most
    return fits


@inlined
def _is_first(problem: Problem, plan: WorkingPlan, node: int) -> bool:
    """Return whether a node is on the first trip of its route."""
    while node < len(problem.demand):
        if plan.via[node] >= 0:
            return False
        node = plan.previous[node]
    return True


@inlined
def _begins(state: State, stop: int, kind: int, before: int, ended: bool) -> bool:
    """Return whether a trip can begin with a stop, and bring what this trip brings after a node.

    If the trip has ended there, it brings the stop alone.
    """
    problem, plan, _ = state
    fits = True
    for dimension in range(plan.on.shape[1]):
        load = 0 if ended else plan.most[before, dimension] - plan.on[before, dimension]
        fits &= load + problem.demand[stop, dimension] <= problem.whole[kind, dimension]
    return fits
