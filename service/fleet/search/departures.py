"""Find the departure of a route over the day after which it takes the least time.

The time at each place on the way is a piecewise linear function of the departure. It is followed
along the route: as two rows, departures and times, both ascending. Where a vehicle would be too
late, the rows end.
"""

import numpy as np

from service.day.driving import arrived, has_knots, left_at
from service.fleet.search.day import FleetDay, last_until, slice_of
from service.fleet.search.problem import RELEASED, Problem
from service.fleet.search.working_plan import WorkingPlan, service_at
from service.jit import compiled, inlined, standalone

_EQUAL = 1e-11  # durations that differ by less, relative to the end, count as equal


@standalone
def best_departure(day: FleetDay, problem: Problem, plan: WorkingPlan, slot: int) -> float:
    """Return the departure of a route of least time, as early as that may be.

    Of those after which nothing is later than it must be. The route is in time if its vehicle
    leaves as early as it may.
    """
    kind, profile = problem.kind[slot], problem.profile[slot]
    start, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    departs = max(problem.departs[kind], plan.value[slot, RELEASED])
    day.departures[0, 0] = day.times[0, 0] = departs
    day.departures[0, 1] = day.times[0, 1] = _latest(day, problem, plan, slot, departs)
    row, count = 0, 2
    at, node = problem.place[start], start
    while node != end:
        node = plan.next[node]
        via = plan.via[node]
        if via >= 0:
            row, count = _drive(day, (at, via), kind, row, count)
            window = day.times[row, 0], plan.released[node], np.inf
            row, count = 1 - row, _begin(day, window, row, count, 0)
            at = via
        row, count = _drive(day, (at, problem.place[node]), kind, row, count)
        at = problem.place[node]
        if node != end:
            row, count = _serve(day, problem, node, row, count)
            service = service_at(problem, profile, node)
            for knot in range(count):
                day.times[row, knot] += service
    limit = max(problem.shift_end[kind], day.times[row, 0])
    count = _cut(day, min(limit, max(problem.returns[kind], day.times[row, 0])), row, count)
    return _best(day, row, count)


@inlined
def _latest(day: FleetDay, problem: Problem, plan: WorkingPlan, slot: int, departs: float) -> float:
    """Return the latest departure; where there is none, one after which nothing changes."""
    latest = problem.leaves_by[problem.kind[slot]]
    if latest < np.inf:
        return max(latest, departs)
    latest = max(departs, day.begins[len(day.factors) - 1])
    node = plan.next[len(problem.demand) + 2 * slot]
    while node < len(problem.demand):
        latest = max(latest, plan.released[node] if plan.via[node] >= 0 else 0.0)
        for number in range(problem.windows.shape[1]):
            latest = max(latest, problem.windows[node, number, 0])
        node = plan.next[node]
    return float(latest)


@compiled
def _drive(
    day: FleetDay, between: tuple[int, int], kind: int, row: int, count: int
) -> tuple[int, int]:
    """Write the other row: the arrivals of those who leave at the times of a row; return it."""
    a, b = between
    times = day.times[row]
    if a < 0 or b < 0:
        return 1 - row, _write_knots(day, row, count, 0)
    known = slice_of(day, times[0])
    changes = _list_changes(day, between, kind, known, times[count - 1])
    if count + changes > len(times):
        changes = 0
    written = _write_knots(day, row, count, changes)
    arrivals = day.times[1 - row]
    for knot in range(written):
        time = arrivals[knot]
        while known + 1 < len(day.factors) and day.begins[known + 1] <= time:
            known += 1
        arrivals[knot], _ = arrived(day, day.rows[kind] + a, b, time, known, day.paces[kind])
    return 1 - row, written


@inlined
def _write_knots(day: FleetDay, row: int, count: int, changes: int) -> int:
    """Write the other row: a row, and also the changes between its times; return how many."""
    departures, times = day.departures[row], day.times[row]
    onto, also = day.departures[1 - row], day.times[1 - row]
    written, change = 0, 0
    while change < changes and day.changes[change] <= times[0]:
        change += 1
    for knot in range(count):
        while change < changes and day.changes[change] < times[knot]:
            time = day.changes[change]
            part = (time - times[knot - 1]) / (times[knot] - times[knot - 1])
            onto[written] = departures[knot - 1] + part * (departures[knot] - departures[knot - 1])
            also[written] = time
            written += 1
            change += 1
        while change < changes and day.changes[change] == times[knot]:
            change += 1
        onto[written], also[written] = departures[knot], times[knot]
        written += 1
    return written


@inlined
def _list_changes(
    day: FleetDay, between: tuple[int, int], kind: int, known: int, last: float
) -> int:
    """Write when to leave for a leg so that a slice begins then or at the arrival, ascending.

    Of a leg with breakpoints, write these. Return the number of these times up to some time after
    the last that matters.
    """
    a, b = between
    found = 0
    if has_knots(day, day.clock, day.rows[kind] + a, b):
        span = day.spans[day.tables[day.clock], day.rows[kind] + a, b]
        while found < span[1] - span[0] and day.knots[span[0] + found, 0] < last:
            day.changes[found] = day.knots[span[0] + found, 0]
            found += 1
        return found
    for later in range(known + 1, len(day.factors)):
        begins = day.begins[later]
        leaves = left_at(day, day.rows[kind] + a, b, begins, day.paces[kind])
        if leaves >= last:
            break
        found = _sort_in(day, leaves, found)
        found = _sort_in(day, begins, found)
    return found


@inlined
def _sort_in(day: FleetDay, time: float, count: int) -> int:
    """Add a time to the ascending changes; return how many they are."""
    place = count
    while place > 0 and day.changes[place - 1] > time:
        day.changes[place] = day.changes[place - 1]
        place -= 1
    day.changes[place] = time
    return count + 1


@inlined
def _serve(day: FleetDay, problem: Problem, stop: int, row: int, count: int) -> tuple[int, int]:
    """Write the other row: when visits begin of those who arrive at the times of one; return it."""
    written, lower, first = 0, -np.inf, day.times[row, 0]
    for number in range(problem.windows.shape[1]):
        closes = problem.windows[stop, number, 1]
        if closes <= lower or closes < first:
            lower = max(lower, closes)
            continue
        window = max(lower, first), problem.windows[stop, number, 0], closes
        written = _begin(day, window, row, count, written)
        lower = closes
        if closes >= day.times[row, count - 1]:
            break
    if written == 0:  # late by a rounding
        last = problem.windows[stop, problem.windows.shape[1] - 1, 0]
        written = _begin(day, (first, last, np.inf), row, count, 0)
    begin = day.times[1 - row, 0]
    return 1 - row, _cut(day, max(problem.due[stop], begin), 1 - row, written)


@compiled
def _begin(
    day: FleetDay, window: tuple[float, float, float], row: int, count: int, written: int
) -> int:
    """Add to the other row when those begin who arrive from a time on until a window closes.

    Args:
        day: The day.
        window: From which arrival on, and when the window opens and closes.
        row: The row with the arrivals.
        count: How many there are.
        written: How many are in the other row.
    """
    lower, opens, closes = window
    departures, times = day.departures[row], day.times[row]
    onto, begins = day.departures[1 - row], day.times[1 - row]
    upper = min(closes, times[count - 1])
    room = len(times)
    latest = _departure(day, lower, row, count)
    if lower <= times[0] and latest > departures[0] and written < room - 1:
        onto[written], begins[written] = departures[0], max(lower, opens)
        written += 1
    onto[written], begins[written] = latest, max(lower, opens)
    written += 1
    if lower < opens < upper and written < room:
        onto[written], begins[written] = _departure(day, opens, row, count), opens
        written += 1
    for knot in range(count):
        if max(lower, opens) < times[knot] < upper and written < room - 1:
            onto[written], begins[written] = departures[knot], times[knot]
            written += 1
    if written < room:
        onto[written], begins[written] = _departure(day, upper, row, count), max(upper, opens)
        written += 1
    return written


@inlined
def _departure(day: FleetDay, time: float, row: int, count: int) -> float:
    """Return the latest departure of those that lead to a time, or to one before it."""
    departures, times = day.departures[row], day.times[row]
    last = last_until(times, count, time)
    if last == count - 1 or times[last] >= time:
        return float(departures[last])
    part = (time - times[last]) / (times[last + 1] - times[last])
    return float(departures[last] + part * (departures[last + 1] - departures[last]))


@inlined
def _cut(day: FleetDay, limit: float, row: int, count: int) -> int:
    """Let a row end with a time; return how many are left."""
    if day.times[row, count - 1] <= limit:
        return count
    last = _departure(day, limit, row, count)
    while count > 1 and day.times[row, count - 2] >= limit:
        count -= 1
    day.departures[row, count - 1], day.times[row, count - 1] = last, limit
    return count


@inlined
def _best(day: FleetDay, row: int, count: int) -> float:
    """Return the first departure of least time."""
    departures, times = day.departures[row], day.times[row]
    least = np.inf
    for knot in range(count):
        least = min(least, times[knot] - departures[knot])
    least += _EQUAL * times[0]
    for knot in range(count):
        if times[knot] - departures[knot] <= least:
            return float(departures[knot])
    return float(departures[0])
