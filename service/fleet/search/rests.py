"""Place the breaks of a vehicle on its route, so that it is done as early as possible.

The same dynamic programming as for the times that are reported (service.fleet.breaks), over arrays.
"""

from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.day import FleetDay, driven, slice_of
from service.fleet.search.problem import RELEASED, Array, Problem
from service.fleet.search.working_plan import MOST_STATES, WorkingPlan, leg, service_at
from service.jit import compiled, inlined, standalone

_is_over = inlined(is_over)

# The columns of a state: the earliest time, the lateness so far, how long legs, visits and breaks
# have taken, the latest departure that makes nothing later, and the earliest departure.
_TIME, _LATE, _WORK, _LATEST, _DEPARTURE = range(5)


class Way(NamedTuple):
    """A state, as its five numbers."""

    time: float
    late: float
    work: float
    latest: float
    departure: float


class Times(NamedTuple):
    """The times of a route with its breaks; it ends at infinity if one fits nowhere."""

    end: float
    duration: float
    late: float


@standalone
def rested(problem: Problem, plan: WorkingPlan, slot: int) -> Times:
    """Return the times of a route with the breaks of its vehicle."""
    start, kind = len(problem.demand) + 2 * slot, problem.kind[slot]
    end, profile = start + 1, problem.profile[slot]
    _depart(problem, plan, slot)
    _rest(problem, plan, kind)
    node, at = plan.next[start], problem.place[start]
    while node != end:
        if plan.via[node] >= 0:
            _drive(problem.day, problem, plan, slot, (at, plan.via[node]))
            _rest(problem, plan, kind)
            _wait(plan, plan.released[node])
            at = plan.via[node]
            _rest(problem, plan, kind)
        _drive(problem.day, problem, plan, slot, (at, node))
        _rest(problem, plan, kind)
        _serve(problem, plan, profile, node)
        _rest(problem, plan, kind)
        at, node = node, plan.next[node]
    _drive(problem.day, problem, plan, slot, (at, problem.place[end]))
    _rest(problem, plan, kind)
    return _ended(problem, plan, kind)


@inlined
def _depart(problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Set the states of a vehicle that may leave, after the breaks that it takes before."""
    kind = problem.kind[slot]
    begin = max(problem.departs[kind], plan.value[slot, RELEASED])
    for taken in range(problem.rests[kind] + 1):
        plan.states[taken] = 0
        if not _is_over(begin, problem.leaves_by[kind]):
            # Of vehicles that leave early, those that leave the earliest count as the latest.
            latest = -begin if problem.early else problem.leaves_by[kind]
            _depart_from(problem.day, problem, plan, slot, (taken, begin, latest))
        if taken < problem.rests[kind]:
            opens, length = problem.breaks[kind, taken, 0], problem.breaks[kind, taken, 2]
            begin = max(begin, opens + length)


@inlined
def _depart_from(
    day: FleetDay | None,
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    begun: tuple[int, float, float],
) -> None:
    """Add the state of a vehicle that may leave from a time on, with so many breaks taken.

    Over the day it leaves at this time, or when the route takes the least time without breaks.
    """
    taken, begin, latest = begun
    if day is None:
        _add(plan, taken, Way(begin, 0.0, 0.0, latest, begin))
    else:
        leaves = plan.ready[len(problem.demand) + 2 * slot]
        _add(plan, taken, Way(begin, 0.0, 0.0, latest if problem.early else begin, begin))
        if leaves > begin and not problem.early:
            _add(plan, taken, Way(leaves, 0.0, 0.0, leaves, leaves))


@inlined
def _state(rows: Array, number: int) -> Way:
    row = rows[number]
    return Way(row[_TIME], row[_LATE], row[_WORK], row[_LATEST], row[_DEPARTURE])


@inlined
def _set(rows: Array, number: int, way: Way) -> None:
    row = rows[number]
    row[_TIME], row[_LATE], row[_WORK] = way.time, way.late, way.work
    row[_LATEST], row[_DEPARTURE] = way.latest, way.departure


@inlined
def _dominates(a: Way, b: Way) -> bool:
    """Return whether no way to go on from here ends better after the second state."""
    return (
        a.time <= b.time
        and not _is_over(a.late, b.late, a.time)
        and not _is_over(a.work, b.work, a.time)
        and (b.latest <= a.latest or not _is_over(b.latest, a.latest, a.time))
    )


@compiled
def _add(plan: WorkingPlan, taken: int, way: Way) -> None:
    """Add a state, unless another dominates it; drop those that it dominates.

    There is room for those of ordinary routes; others beyond it are dropped.
    """
    rows, kept = plan.state[taken], 0
    for number in range(plan.states[taken]):
        if _dominates(_state(rows, number), way):
            return
    for number in range(plan.states[taken]):
        if not _dominates(way, _state(rows, number)):
            _set(rows, kept, _state(rows, number))
            kept += 1
    if kept < MOST_STATES:
        _set(rows, kept, way)
        kept += 1
    plan.states[taken] = kept


@inlined
def _drive(
    day: FleetDay | None,
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    between: tuple[int, int],
) -> None:
    """Drive a leg; one branch is left where this is compiled: that of the type of the day."""
    if day is None:
        legs = leg(problem, problem.profile[slot], between[0], between[1], problem.clock)
        for taken in range(len(plan.states)):
            for number in range(plan.states[taken]):
                plan.state[taken, number, _TIME] += legs
                plan.state[taken, number, _WORK] += legs
    else:
        kind = problem.kind[slot]
        for taken in range(len(plan.states)):
            for number in range(plan.states[taken]):
                time = plan.state[taken, number, _TIME]
                ends = driven(day, between, kind, time, slice_of(day, time)).time
                plan.state[taken, number, _TIME] = ends


@inlined
def _wait(plan: WorkingPlan, until: float) -> None:
    for taken in range(len(plan.states)):
        for number in range(plan.states[taken]):
            row = plan.state[taken, number]
            row[_TIME] = max(row[_TIME], until)


@compiled
def _rest(problem: Problem, plan: WorkingPlan, kind: int) -> None:
    """Let the vehicle take one break after another here."""
    for taken in range(problem.rests[kind]):
        opens, closes = problem.breaks[kind, taken, 0], problem.breaks[kind, taken, 1]
        length = problem.breaks[kind, taken, 2]
        for number in range(plan.states[taken]):
            way = _state(plan.state[taken], number)
            if _is_over(way.time, closes):
                continue
            ends = max(way.time, opens) + length
            latest = min(way.latest, closes - way.work)
            rest = Way(ends, way.late, way.work + length, latest, way.departure)
            _add(plan, taken + 1, rest)


@compiled
def _serve(problem: Problem, plan: WorkingPlan, profile: int, stop: int) -> None:
    """Let the vehicle visit a stop, in any window that is not over."""
    due, service = problem.due[stop], service_at(problem, profile, stop)
    for taken in range(len(plan.states)):
        before = plan.states[taken]
        for number in range(before):
            _set(plan.spare, number, _state(plan.state[taken], number))
        plan.states[taken] = 0
        for number in range(before):
            way = _state(plan.spare, number)
            for window in range(problem.windows.shape[1]):
                opens, closes = problem.windows[stop, window, 0], problem.windows[stop, window, 1]
                if _is_over(way.time, closes):
                    continue
                begin = max(opens, way.time)
                late = way.late + (begin - due if _is_over(begin, due) else 0.0)
                until = min(closes, max(due, begin)) - way.work
                latest = min(way.latest, until)
                served = Way(begin + service, late, way.work + service, latest, way.departure)
                _add(plan, taken, served)


@inlined
def _ended(problem: Problem, plan: WorkingPlan, kind: int) -> Times:
    """Return the best of the states at the end: early, then least late, then leaving the latest.

    Vehicles that leave as early as they may are best if they leave the earliest.
    """
    best = Times(np.inf, np.inf, np.inf)
    for taken in range(problem.rests[kind] + 1):
        last = problem.returns[kind]
        if taken < problem.rests[kind]:
            last = min(last, problem.breaks[kind, taken, 1])
        for number in range(plan.states[taken]):
            way = _state(plan.state[taken], number)
            if not _is_over(way.time, last):
                best = _better_at_end(problem.day, problem, kind, best, way)
    return best


@inlined
def _better_at_end(
    day: FleetDay | None, problem: Problem, kind: int, best: Times, way: Way
) -> Times:
    """Return the better of the times of a route, and those of another way at its end.

    Over the day that is first the least late, then of the least overtime, then the shortest.
    """
    if day is None or problem.early:
        return _better(best, way, problem.early)
    times = Times(way.time, way.time - way.departure, way.late)
    if best.end == np.inf or _is_over(best.late, way.late, way.time):
        return times
    shift_end = problem.shift_end[kind]
    more = max(0.0, way.time - shift_end) - max(0.0, best.end - shift_end)
    if _is_over(way.late, best.late, way.time) or more > 0.0:
        return best
    return times if more < 0.0 or times.duration < best.duration else best


@inlined
def _better(best: Times, way: Way, early: bool) -> Times:
    """Return the better of the times of a route, and those of another way at its end."""
    leaves = max(way.departure, min(way.latest, way.time - way.work))
    times = Times(way.time, way.time - leaves, way.late)
    if _is_over(best.end, way.time):
        return times
    if _is_over(way.time, best.end):
        return best
    if _is_over(best.late, way.late, way.time):
        return times
    if _is_over(way.late, best.late, way.time):
        return best
    longer = times.duration >= best.duration
    return times if longer == early else best
