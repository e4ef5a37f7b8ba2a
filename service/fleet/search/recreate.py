"""Put the stops that are outside a plan into it, each where it costs the least."""

import numpy as np

from service.fleet.search.changes import begin_iteration, measure_with, save_slot
from service.fleet.search.companions import drop_halves, want_mates
from service.fleet.search.insertion import best_place
from service.fleet.search.pairs import best_pair
from service.fleet.search.problem import Problem
from service.fleet.search.reloads import SELDOM, load_anew
from service.fleet.search.route import measure
from service.fleet.search.ruin import free_waiting, uniform
from service.fleet.search.spots import Place, Spot, put, take_back
from service.fleet.search.waits import bind, bound, insert_firsts_first, settle, unbind
from service.fleet.search.weighed import promised_stops
from service.fleet.search.working_plan import (
    AS_BEFORE,
    BLINKS,
    MORE_TRIPS,
    OUTSIDE,
    REMOVED,
    SAVED,
    UNTIL_BLINK,
    State,
    WorkingPlan,
    any_type,
    leave_out,
    leg,
    link,
    take_in,
    unlink,
)
from service.jit import compiled, inlined, standalone
from service.search.local_search import random_below

_MOST_OUTSIDE = 10  # stops outside that an iteration tries to put in
# How stops are sorted before they are inserted: at random, the largest first, the farthest or the
# nearest from where the first vehicle starts, or by their windows. Those that work best are drawn
# most often.
RANDOM, LARGE, FAR, NEAR, NARROW, SOON, OPENING = 0, 4, 6, 7, 8, 9, 10
ORDERS = 11
_FEW_BLINKS, _MANY_BLINKS = 100, 4  # one place in so many for a stop is passed by
_CHANCES = 20  # see _most()
_ANY_ORDER = 4  # one time in so many, stops that wait for others may be inserted before these
_OFTEN = 10  # one iteration in so many passes by many places


@standalone
def recreate(state: State, order: int) -> None:
    """Insert the removed stops, sorted in an order, where each costs the least.

    Vehicles may load once more on their way where `counts[MORE_TRIPS]` is 1.
    """
    problem, plan, _ = state
    often = random_below(plan.random, _OFTEN) == 0
    plan.counts[BLINKS] = _MANY_BLINKS if often else _FEW_BLINKS
    plan.counts[UNTIL_BLINK] = 1 + random_below(plan.random, 2 * plan.counts[BLINKS] - 1)
    _prepare(state, order)
    _insert_removed(state)
    if problem.grouped:
        drop_halves(state)
    if problem.reloads and random_below(plan.random, SELDOM) == 0:
        for number in range(plan.counts[SAVED]):
            load_anew(state, plan.saved[number])


@inlined
def _insert_removed(state: State) -> None:
    """Insert the removed stops in their order, then let all changed routes leave at their best."""
    problem, plan, _ = state
    plan.counts[AS_BEFORE] = problem.postpones
    for number in range(plan.counts[REMOVED]):
        stop = plan.removed[number]
        most = _most(problem, plan, stop)
        if problem.delivery[stop] >= 0:
            place = best_pair(state, stop, most)
        else:
            place = best_place(state, stop, most)
        if place.slot >= 0:
            save_slot(problem, plan, place.slot)
            insert(state, stop, place)
    plan.counts[AS_BEFORE] = 0
    if problem.postpones:
        for number in range(plan.counts[SAVED]):
            measure(state, plan.saved[number])


@inlined
def _prepare(state: State, order: int) -> None:
    """Add to the stops to insert what belongs to them, and sort them in an order."""
    problem, plan, _ = state
    if problem.grouped:
        want_mates(problem, plan)
    if problem.waits.given:
        free_waiting(state)
        settle(state, False)
    _sort(problem, plan, order)
    if problem.waits.given and random_below(plan.random, _ANY_ORDER) > 0:
        insert_firsts_first(problem, plan, plan.counts[REMOVED])


@inlined
def insert(state: State, stop: int, place: Place) -> None:
    """Put a stop into its place, and of a shipment the delivery too."""
    problem, plan, _ = state
    onward = plan.via[plan.next[place.before]]
    if problem.waits.given:
        bound(problem, plan, stop, place.slot)
    take_in(problem, plan, stop)
    put(plan, stop, Spot(place.slot, place.before, place.via, place.onward))
    if place.last >= 0:
        link(plan, place.slot, problem.delivery[stop], place.last)
    kept = measure_with(state, place.slot, stop)
    if kept and problem.waits.given:
        kept = bind(state, place.slot)
    if kept:
        return
    # A rounding apart from what was worked out before, or a gap that was not known on this route: a
    # place like any other that is none.
    if place.last >= 0:
        unlink(plan, problem.delivery[stop])
    take_back(plan, stop, onward)
    leave_out(problem, plan, stop)
    measure(state, place.slot)
    if problem.waits.given:
        unbind(state, stop)


@inlined
def _most(problem: Problem, plan: WorkingPlan, stop: int) -> float:
    """Return what a stop may cost: its price, or at times anything or nothing if it is optional.

    Two optional stops may pay together where neither does alone.
    """
    if problem.prize[stop] < np.inf:
        chance = random_below(plan.random, _CHANCES)
        if chance == 0:
            return np.inf
        if chance == 1:
            return -np.inf
    return plan.price[stop]


@inlined
def _sort(problem: Problem, plan: WorkingPlan, order: int) -> None:
    """Sort the removed stops in an order."""
    count = plan.counts[REMOVED]
    for place in range(count):
        plan.key[place] = _key(problem, plan, plan.removed[place], order)
    # Shell's sort.
    gap = count // 2
    while gap > 0:
        for place in range(gap, count):
            stop, key, to = plan.removed[place], plan.key[place], place
            while to >= gap and plan.key[to - gap] > key:
                plan.removed[to], plan.key[to] = plan.removed[to - gap], plan.key[to - gap]
                to -= gap
            plan.removed[to], plan.key[to] = stop, key
        gap //= 2


@inlined
def _key(problem: Problem, plan: WorkingPlan, stop: int, order: int) -> float:
    """Return by what a stop is sorted."""
    if order == OPENING:
        return problem.opens[stop]
    if order == SOON:
        return min(problem.closes[stop], problem.due[stop])
    if order == NARROW:
        return problem.closes[stop] - problem.opens[stop]
    if order >= FAR:
        there = max(problem.place[len(problem.demand)], 0)
        away = leg(problem, problem.profile[0], there, stop, 0)
        return away if order == NEAR else -away
    if order >= LARGE and problem.demand.shape[1] > 0:
        return -float(problem.demand[stop, 0])
    return uniform(plan.random)


@inlined
def try_outside(plan: WorkingPlan) -> None:
    """Add some of the stops outside to those that are inserted."""
    outside = plan.counts[OUTSIDE]
    for number in range(min(outside, _MOST_OUTSIDE)):
        place = number
        if outside > _MOST_OUTSIDE:
            place = random_below(plan.random, outside)
        stop = plan.outside[place]
        known = False
        for other in range(plan.counts[REMOVED]):
            known |= plan.removed[other] == stop
        if not known:
            plan.removed[plan.counts[REMOVED]] = stop
            plan.counts[REMOVED] += 1


@compiled
def set_prices(state: State) -> None:
    """Set what each stop costs outside, at first."""
    problem, plan, direction = state
    for number in range(len(problem.tasks)):
        stop = problem.tasks[number]
        required = problem.prize[stop] == np.inf
        price = direction.required if required else direction.prize * problem.prize[stop]
        plan.price[stop] = price + direction.changes * promised_stops(problem, stop)


@inlined
def raise_prices(state: State) -> None:
    """Raise the prices of the stops outside that must be visited."""
    problem, plan, direction = state
    for place in range(plan.counts[OUTSIDE]):
        stop = plan.outside[place]
        if problem.prize[stop] == np.inf:
            plan.price[stop] += direction.required


@compiled
def insert_all(state: State, order: int) -> None:
    """Insert all stops that are outside, in an order, if they fit."""
    problem, plan, _ = state
    begin_iteration(plan)
    for place in range(plan.counts[OUTSIDE]):
        plan.removed[place] = plan.outside[place]
    plan.counts[REMOVED] = plan.counts[OUTSIDE]
    plan.counts[MORE_TRIPS] = problem.reloads
    any_type(problem, plan)
    recreate(state, order)
