"""Keep visits in order that wait for visits on other routes.

Each visit of a pair has bounds: it begins no earlier than the first one of the pair allows, and the
first one no later than the second one begins now. So a stop that is inserted makes no other route
later. What is taken out lets others begin earlier: settle() works out by how much.
"""

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import Problem
from service.fleet.search.route import measure
from service.fleet.search.working_plan import STAMP, USED, State, WorkingPlan, service_at
from service.jit import compiled, inlined

_is_over = inlined(is_over)


@compiled
def bound(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> bool:
    """Set the bounds of a visit in a slot; return whether they change."""
    return _set(problem, stop, _since(problem, plan, stop, slot), _until(problem, plan, stop, slot))


@inlined
def _binds(plan: WorkingPlan, stop: int, other: int, slot: int, gap: float) -> bool:
    """Return whether a visit bounds that of a stop in a slot.

    On one route the order is enough without a gap. With one, a stop is inserted first.
    """
    if other < 0 or plan.route[other] < 0:
        return False
    return plan.route[other] != slot or (gap > 0 and plan.route[stop] == slot)


@inlined
def _since(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> float:
    """Return from when on a visit may begin in a slot."""
    waits, since = problem.waits, 0.0
    for number in range(waits.firsts.shape[1]):
        first, gap = waits.firsts[stop, number], waits.first_gaps[stop, number]
        if _binds(plan, stop, first, slot, gap):
            since = max(since, plan.ready[first] + gap)
    return since


@inlined
def _until(problem: Problem, plan: WorkingPlan, stop: int, slot: int) -> float:
    """Return until when a visit may begin in a slot, so that none that waits for it is later."""
    waits, until, reach = problem.waits, np.inf, 0.0
    service = service_at(problem, problem.profile[slot], stop)
    for number in range(waits.thens.shape[1]):
        then, gap = waits.thens[stop, number], waits.then_gaps[stop, number]
        if _binds(plan, stop, then, slot, gap):
            profile = problem.profile[plan.route[then]]
            begin = plan.ready[then] - service_at(problem, profile, then)
            until, reach = min(until, begin - gap - service), max(reach, plan.ready[then])
    if plan.route[stop] == slot:
        known = plan.ready[stop] - service
        if not _is_over(known, until, reach):  # but for a rounding
            until = max(until, known)
    return until


@compiled
def _set(problem: Problem, stop: int, since: float, until: float) -> bool:
    """Leave of the windows of a stop what is between two times; return whether that changes."""
    waits = problem.waits
    if waits.since[stop] == since and waits.until[stop] == until:
        return False
    waits.since[stop], waits.until[stop] = since, until
    opens, closes = np.inf, -np.inf
    for number in range(problem.windows.shape[1]):
        first, last = waits.windows[stop, number, 0], waits.windows[stop, number, 1]
        if last < first:  # whoever is there in time waits: see Rules.windows
            kept = not (_is_over(since, last) or _is_over(first, until))
        else:
            first, last = max(first, since), min(last, until)
            kept = not _is_over(first, last)
            last = max(first, last)
        if kept:
            opens, closes = min(opens, first, last), max(closes, last)
        problem.windows[stop, number, 0] = first if kept else np.inf
        problem.windows[stop, number, 1] = last if kept else -np.inf
    problem.opens[stop] = opens if closes > -np.inf else 0.0
    problem.closes[stop] = closes
    return True


@compiled
def bind(state: State, slot: int) -> bool:
    """Set the bounds of visits that wait for those of a route, or for which these wait.

    Returns:
        Whether all routes of these visits keep all rules.
    """
    waits, kept = state.problem.waits, True
    for forward in (True, False):
        for number in range(len(waits.stops)):
            stop = waits.stops[number]
            if state.plan.route[stop] == slot:
                kept &= _bind_others(state, stop, forward)
    return kept


@compiled
def unbind(state: State, stop: int) -> None:
    """Set the bounds of the visits that waited for that of a stop which is taken out, or it did."""
    _bind_others(state, stop, True)
    _bind_others(state, stop, False)


@inlined
def _bind_others(state: State, stop: int, forward: bool) -> bool:
    """Set from when on visits may begin that wait for that of a stop; return whether all is kept.

    Not forward, set until when those may begin for which it waits.
    """
    problem, plan, _ = state
    waits, kept = problem.waits, True
    others = waits.thens if forward else waits.firsts
    for place in range(others.shape[1]):
        other = others[stop, place]
        slot = plan.route[other] if other >= 0 else -1
        if slot < 0:
            continue
        since = _since(problem, plan, other, slot) if forward else waits.since[other]
        until = waits.until[other] if forward else _until(problem, plan, other, slot)
        if _set(problem, other, since, until):
            kept &= _measured(state, slot)
    return kept


@inlined
def _measured(state: State, slot: int) -> bool:
    """Measure a route, and again when the plan is settled if it breaks a rule."""
    kept = measure(state, slot)
    state.problem.waits.stale[slot] = not kept
    return kept


@compiled
def settle(state: State, afresh: bool) -> bool:
    """Let each visit that waits begin as early as it may; return whether the routes keep all rules.

    Args:
        state: The search. Routes that this iteration did not touch keep all rules.
        afresh: Whether nothing is known of when visits may begin.
    """
    problem, plan, _ = state
    _forget(problem, plan, afresh)
    for number in range(plan.counts[USED]):
        if problem.waits.stale[plan.used[number]]:
            measure(state, plan.used[number])
    kept = _settle_begins(state)
    _limit_begins(problem, plan)
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        if problem.waits.stale[slot]:
            kept &= _measured(state, slot)
    return kept


@inlined
def _forget(problem: Problem, plan: WorkingPlan, afresh: bool) -> None:
    """Let no visit be bound by those that wait for it, and find the routes to measure again."""
    waits, n = problem.waits, len(problem.demand)
    for number in range(len(waits.stops)):
        stop = waits.stops[number]
        slot = plan.route[stop]
        waits.settled[stop] = waits.until[stop]
        _set(problem, stop, 0.0 if afresh else waits.since[stop], np.inf)
        if slot >= 0:
            late = plan.ready[n + 2 * slot + 1] == np.inf
            waits.stale[slot] |= afresh or late or plan.touched[slot] == plan.counts[STAMP]


@inlined
def _settle_begins(state: State) -> bool:
    """Let visits begin no earlier than others allow; return False if they wait in a circle."""
    problem, plan, _ = state
    waits = problem.waits
    for _ in range(len(waits.stops) + 1):
        changed = False
        for number in range(len(waits.stops)):
            stop = waits.stops[number]
            slot = plan.route[stop]
            if slot >= 0 and _set(problem, stop, _since(problem, plan, stop, slot), np.inf):
                waits.stale[slot] = changed = True
                measure(state, slot)
        if not changed:
            return True
    return False


@inlined
def _limit_begins(problem: Problem, plan: WorkingPlan) -> None:
    """Bound visits by those that wait for them."""
    waits = problem.waits
    for number in range(len(waits.stops)):
        stop = waits.stops[number]
        slot = plan.route[stop]
        if slot >= 0:
            _set(problem, stop, waits.since[stop], _until(problem, plan, stop, slot))
            waits.stale[slot] |= waits.until[stop] != waits.settled[stop]


@inlined
def insert_firsts_first(problem: Problem, plan: WorkingPlan, count: int) -> None:
    """Sort stops to insert once more: those that others wait for come before these."""
    firsts, place = problem.waits.firsts, 0
    for _ in range(count * count):
        if place == count:
            return
        stop, last = plan.removed[place], place
        for other in range(place + 1, count):
            for number in range(firsts.shape[1]):
                if firsts[stop, number] == plan.removed[other]:
                    last = other
        for other in range(place, last):
            plan.removed[other] = plan.removed[other + 1]
        plan.removed[last] = stop
        place += last == place
