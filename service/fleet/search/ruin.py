"""Take strings of neighbouring stops out of the routes of a plan.

Christiaens and Vanden Berghe (2020), "Slack induction by string removals for vehicle routing
problems".
"""

import numpy as np

from service.fleet.search.changes import begin_iteration, save_slot
from service.fleet.search.problem import MOST, Indices, Problem
from service.fleet.search.reloads import SELDOM, load_anew
from service.fleet.search.route import measure
from service.fleet.search.spans import head_at, joined, tail_at
from service.fleet.search.working_plan import (
    OUTSIDE,
    REMOVED,
    STAMP,
    USED,
    State,
    WorkingPlan,
    leave_out,
    leg,
    slot_of,
    unlink,
)
from service.jit import compiled, inlined, standalone
from service.search.local_search import random_below

_REMOVED = 10  # stops that an iteration takes out, on the mean
_LONGEST_STRING = 10
_SPLIT = 2  # one string in so many leaves stops in its middle
_STAYING = 100  # one time in so many, more of them
_WITH_FIRST = 2  # one time in so many, a stop is taken out with one that it waits for
# One pair of ruined routes in so many exchange their tails; each, where there are times: few fit.
_CROSSED = 4
_LONGEST_FIRST = 4  # one ruin in so many begins in the longest route, where that counts


@inlined
def uniform(random: Indices) -> float:
    """Draw a number above 0 and below 1."""
    return (random_below(random, 1 << 30) + 0.5) / (1 << 30)


@inlined
def ruin(state: State) -> None:
    """Take strings of stops out of some routes near a random stop."""
    problem, plan, _ = state
    clients, used = len(problem.clients), plan.counts[USED]
    if used == 0:
        return
    inside = clients - plan.counts[OUTSIDE]
    longest = min(float(_LONGEST_STRING), inside / used)
    most = 4.0 * _REMOVED / (1.0 + longest) - 1.0
    strings = int(1 + uniform(plan.random) * max(0.0, most))
    seed = _seed(state)
    left, gap = strings, -1
    if plan.route[seed] >= 0:
        gap = _take_string(state, seed, longest)
        left -= 1
    for number in range(problem.near.shape[1]):
        if left <= 0:
            return
        stop = problem.near[seed, number]
        slot = plan.route[stop]
        if slot >= 0 and not _is_ruined(problem, plan, stop):
            last, gap = gap, _take_string(state, stop, longest)
            left -= 1
            if problem.clock >= 0 or random_below(plan.random, _CROSSED) == 0:
                cross(state, last, gap)


@inlined
def _is_ruined(problem: Problem, plan: WorkingPlan, stop: int) -> bool:
    """Return whether a string was taken out of the route of a stop, of several trips out of its."""
    if problem.reloads:
        return plan.ruined[stop] == plan.counts[STAMP]
    return plan.touched[plan.route[stop]] == plan.counts[STAMP]


@inlined
def _seed(state: State) -> int:
    """Return a random stop, sometimes one of the longest route where that is over its limit."""
    problem, plan, direction = state
    limit = min(direction.longest, direction.most)
    if limit < np.inf and random_below(plan.random, _LONGEST_FIRST) == 0:
        column = problem.swept if direction.longest < np.inf else MOST
        longest, found = -1.0, plan.used[0]
        for number in range(plan.counts[USED]):
            length = plan.value[plan.used[number], column]
            if length > longest:
                longest, found = length, plan.used[number]
        node = plan.next[len(problem.demand) + 2 * found]
        for _ in range(random_below(plan.random, plan.size[found])):
            node = plan.next[node]
        return node
    return problem.clients[random_below(plan.random, len(problem.clients))]


@compiled
def _take_string(state: State, stop: int, longest: float) -> int:
    """Take a string of stops around a stop out of its route.

    Returns:
        The node before the string; -1 where the whole route was dissolved.
    """
    problem, plan, _ = state
    slot = plan.route[stop]
    save_slot(problem, plan, slot)
    start = len(problem.demand) + 2 * slot
    size, at = 0, 0
    node = plan.next[start]
    while node != start + 1:
        if node == stop:
            at = size
        plan.buffer[size] = node
        size += 1
        node = plan.next[node]
    length = min(size, int(1 + uniform(plan.random) * min(float(size), longest)))
    staying = _staying(plan, length, size)
    reach = length + staying
    first = max(0, at - reach + 1)
    first += random_below(plan.random, min(at, size - reach) - first + 1)
    gap = first + 1 + random_below(plan.random, max(1, length - 1))
    if problem.reloads:
        _mark_trips(plan, size, first, first + reach)
    for place in range(first, first + reach):
        # The other stop of a shipment may have taken this one with it.
        if not gap <= place < gap + staying and plan.route[plan.buffer[place]] >= 0:
            remove(problem, plan, plan.buffer[place])
    before = plan.buffer[first - 1] if first > 0 else start
    if not measure(state, slot):
        dissolve(state, slot)
        return -1
    if problem.reloads and random_below(plan.random, SELDOM) == 0:
        load_anew(state, slot)
    return before


@standalone
def cross(state: State, first: int, second: int) -> None:
    """Exchange what follows two nodes of two routes, if both routes then keep all rules.

    Strings are short, and routes that are long and full go over into others by their tails alone.
    It is done for vehicles of one type, and not where stops belong together or vehicles reload.

    Args:
        state: The search.
        first: The node, -1 for none.
        second: The other node, -1 for none.
    """
    problem, plan, _ = state
    if first < 0 or second < 0:
        return
    if problem.ships or problem.grouped or problem.reloads or problem.waits.given:
        return
    a, b = slot_of(problem, plan, first), slot_of(problem, plan, second)
    if a < 0 or b < 0 or a == b or problem.kind[a] != problem.kind[b]:
        return
    if problem.clock >= 0 and not (
        _in_time(problem, plan, a, first, plan.next[second])
        and _in_time(problem, plan, a, second, plan.next[first])
    ):
        return
    _exchange_tails(problem, plan, first, second)
    kept = measure(state, a)
    kept &= measure(state, b)
    if not kept:
        _exchange_tails(problem, plan, first, second)
        measure(state, a)
        measure(state, b)


@inlined
def _in_time(problem: Problem, plan: WorkingPlan, slot: int, node: int, after: int) -> bool:
    """Return whether the tail from one node on is in time behind another."""
    place, there = problem.place[node], problem.place[after]
    away = leg(problem, problem.profile[slot], place, there, problem.clock)
    return joined(head_at(plan, node), away, tail_at(plan, after))[1]


@inlined
def _exchange_tails(problem: Problem, plan: WorkingPlan, first: int, second: int) -> None:
    """Exchange what follows two nodes, up to the ends. A second time undoes it."""
    n = len(problem.demand)
    a, b = slot_of(problem, plan, first), slot_of(problem, plan, second)
    end_a, end_b = n + 2 * a + 1, n + 2 * b + 1
    next_a, next_b = plan.next[first], plan.next[second]
    last_a, last_b = plan.previous[end_a], plan.previous[end_b]
    _append(plan, a, first, next_b if second != last_b else end_a, last_b, end_a)
    _append(plan, b, second, next_a if first != last_a else end_b, last_a, end_b)


@inlined
def _append(plan: WorkingPlan, slot: int, before: int, node: int, last: int, end: int) -> None:
    """Let a tail, from a node to the last before an end, follow a node of a route."""
    plan.next[before], plan.previous[node] = node, before
    if node == end:
        return
    plan.next[last], plan.previous[end] = end, last
    while node != end:
        plan.route[node] = slot
        node = plan.next[node]


@inlined
def _mark_trips(plan: WorkingPlan, size: int, first: int, last: int) -> None:
    """Note the trips of a route that stops are taken out of, from one place to before another."""
    begin = first
    while begin > 0 and plan.via[plan.buffer[begin]] < 0:
        begin -= 1
    for place in range(begin, size):
        if place >= last and plan.via[plan.buffer[place]] >= 0:
            break
        plan.ruined[plan.buffer[place]] = plan.counts[STAMP]


@inlined
def _staying(plan: WorkingPlan, length: int, size: int) -> int:
    """Return how many stops stay in the middle of a string of `length` others in a route."""
    if length < 2 or random_below(plan.random, _SPLIT) > 0:
        return 0
    staying = 1
    while length + staying < size and random_below(plan.random, _STAYING) == 0:
        staying += 1
    return min(staying, size - length)


@inlined
def remove(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    """Take a stop out of its route, to be inserted later. The route is not measured.

    Of a shipment both stops are taken out, and all stops that ride together.
    """
    if problem.pickup[stop] >= 0:
        stop = problem.pickup[stop]
    if problem.grouped:
        for place in range(problem.mates.shape[1]):
            other = problem.mates[stop, place]
            if other >= 0 and plan.route[other] >= 0:
                _remove_alone(problem, plan, other)
    _remove_alone(problem, plan, stop)


@inlined
def _remove_alone(problem: Problem, plan: WorkingPlan, stop: int) -> None:
    if problem.delivery[stop] >= 0:
        unlink(plan, problem.delivery[stop])
    unlink(plan, stop)
    leave_out(problem, plan, stop)
    plan.removed[plan.counts[REMOVED]] = stop
    plan.counts[REMOVED] += 1


@compiled
def dissolve(state: State, slot: int) -> None:
    """Take all stops out of a route."""
    problem, plan, _ = state
    save_slot(problem, plan, slot)
    start = len(problem.demand) + 2 * slot
    while plan.next[start] != start + 1:
        remove(problem, plan, plan.next[start])
    measure(state, slot)


@compiled
def limit_routes(state: State) -> None:
    """Take all stops out of the routes of the fewest, until there are no more than is allowed."""
    _, plan, direction = state
    begin_iteration(plan)
    for _ in range(plan.counts[USED] - direction.routes):
        shortest = plan.used[0]
        for number in range(plan.counts[USED]):
            if plan.size[plan.used[number]] < plan.size[shortest]:
                shortest = plan.used[number]
        dissolve(state, shortest)


@compiled
def free_waiting(state: State) -> None:
    """Take out, at times, the stops that wait for those that are inserted: these may be later."""
    problem, plan, _ = state
    number = 0
    while number < plan.counts[REMOVED]:
        stop = plan.removed[number]
        for place in range(problem.waits.thens.shape[1]):
            then = problem.waits.thens[stop, place]
            if then >= 0 and plan.route[then] >= 0 and random_below(plan.random, _WITH_FIRST) == 0:
                slot = plan.route[then]
                save_slot(problem, plan, slot)
                remove(problem, plan, then)
                if not measure(state, slot):
                    dissolve(state, slot)
        number += 1
