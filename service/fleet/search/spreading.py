"""Measure how a route turns out from day to day: how surely it is on time, and how long it takes.

As in punctuality.py, when a visit begins is taken to be normal, unless the times of several days
are known: then a route is driven on each of them. `VARIANCE` of a route is then its deviation: the
sum over the routes is the most that the deviation of the plan may be.
"""

import math
from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import LATE, MEAN, MOST, VARIANCE, Array, Direction, Problem
from service.fleet.search.working_plan import USED, State, WorkingPlan, leg, service_at
from service.jit import compiled, inlined

_is_over = inlined(is_over)
_ROOT, _DENSITY = math.sqrt(2.0), 1.0 / math.sqrt(2.0 * math.pi)
_LEAST_SHARE = 1e-3  # of a mean: a smaller deviation counts as this when it is weighed


class Normal(NamedTuple):
    """A time that differs from day to day."""

    mean: float
    variance: float


@inlined
def _after(problem: Problem, time: Normal, leg_to: float) -> Normal:
    """Return when a leg ends that begins at a time."""
    deviation = problem.extras.spread * leg_to
    return Normal(time.mean + leg_to, time.variance + deviation * deviation)


@inlined
def _from_on(time: Normal, opens: float) -> Normal:
    """Return the later one of a time and that at which a stop opens (Clark, 1961)."""
    if time.variance == 0.0:
        return Normal(max(time.mean, opens), 0.0)
    deviation, ahead = math.sqrt(time.variance), time.mean - opens
    z = ahead / deviation
    share = 0.5 * (1.0 + math.erf(z / _ROOT))
    density = deviation * _DENSITY * math.exp(-0.5 * z * z)
    mean = ahead * share + density
    square = (ahead * ahead + time.variance) * share + ahead * density
    return Normal(opens + mean, max(0.0, square - mean * mean))


@inlined
def _share_after(time: Normal, latest: float) -> float:
    """Return on what share of days a time is later than another."""
    if latest == np.inf:
        return 0.0
    if time.variance == 0.0:
        return 1.0 if _is_over(time.mean, latest) else 0.0
    return 0.5 * math.erfc((latest - time.mean) / (_ROOT * math.sqrt(time.variance)))


@inlined
def _window_at(problem: Problem, stop: int, arrival: float) -> int:
    """Return the number of the first window that is not over, else of the last one."""
    last = problem.windows.shape[1] - 1
    for number in range(last):
        if not _is_over(arrival, problem.windows[stop, number, 1]):
            return number
    return last


@compiled
def spread_along(problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Write how the visits of a route spread whose times are known, and how long it takes then."""
    if problem.extras.days > 0:
        _drive_days(problem, plan, slot)
        return
    start = len(problem.demand) + 2 * slot
    departure = plan.ready[start + 1] - plan.value[slot, problem.clock]
    planned, now, late = departure, Normal(departure, 0.0), 0.0
    plan.mean[start], plan.variance[start], plan.share[start] = departure, 0.0, 0.0
    at, node = problem.place[start], plan.next[start]
    while node != start + 1:
        planned, now = _reached(problem, plan, slot, (at, node), (planned, now))
        number = _window_at(problem, node, planned)
        plan.share[node] = _share_after(now, problem.extras.latest[node, number])
        late += plan.share[node]
        opens = problem.windows[node, number, 0]
        if opens > departure:
            now = _from_on(now, opens)
        plan.mean[node], plan.variance[node] = now.mean, now.variance
        service = service_at(problem, problem.profile[slot], node)
        planned = max(planned, opens) + service
        now = Normal(now.mean + service, now.variance)
        at, node = node, plan.next[node]
    now = _after(problem, now, plan.step[start + 1, problem.clock])
    mean = now.mean - departure
    plan.value[slot, LATE] = late
    plan.value[slot, MEAN], plan.value[slot, VARIANCE] = mean, now.variance
    plan.value[slot, MOST] = mean + problem.extras.most_deviations * math.sqrt(now.variance)


@inlined
def _reached(
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    between: tuple[int, int],
    left: tuple[float, Normal],
) -> tuple[float, Normal]:
    """Return when a vehicle reaches a node from a place that it leaves: as planned, and really."""
    (at, node), (planned, now) = between, left
    step = plan.step[node, problem.clock]
    if plan.via[node] >= 0:
        there = leg(problem, problem.profile[slot], at, plan.via[node], problem.clock)
        away = min(step, there)
        now, planned, step = _after(problem, now, away), planned + away, step - away
        if plan.released[node] > planned:
            planned = plan.released[node]
            now = _from_on(now, planned)
    return planned + step, _after(problem, now, step)


@inlined
def spread_cost(
    direction: Direction, late: float, mean: float, variance: float, most: float
) -> float:
    """Return what it costs that a route is late, takes long and differs from day to day."""
    cost = direction.on_time * late + direction.mean * mean + direction.variance * variance
    return cost + direction.most_penalty * max(0.0, most - direction.most)


@compiled
def spread_growth(state: State, stop: int, slot: int, before: int) -> float:
    """Return about what that grows by with a stop after a node, if the departure stays the same.

    Of a route without stops, or of a pick-up, it is the least.
    """
    problem, plan, direction = state
    if plan.size[slot] == 0 or problem.delivery[stop] >= 0:
        return 0.0
    if problem.extras.days > 0:
        return _growth_by_days(state, stop, slot, before)
    start, profile = len(problem.demand) + 2 * slot, problem.profile[slot]
    now, late, here, node = Normal(plan.mean[before], plan.variance[before]), 0.0, before, stop
    departure = plan.mean[start]
    while node != start + 1:
        service = service_at(problem, profile, here) if here != start else 0.0
        step = leg(problem, profile, problem.place[here], node, problem.clock)
        now = _after(problem, Normal(now.mean + service, now.variance), step)
        number = _window_at(problem, node, now.mean)
        late += _share_after(now, problem.extras.latest[node, number])
        if problem.windows[node, number, 0] > departure:
            now = _from_on(now, problem.windows[node, number, 0])
        if node == stop:
            here, node = node, plan.next[before]
        else:
            late -= plan.share[node]
            here, node = node, plan.next[node]
    service = service_at(problem, profile, here)
    step = leg(problem, profile, here, problem.place[start + 1], problem.clock)
    now = _after(problem, Normal(now.mean + service - departure, now.variance), step)
    value, mean, variance = plan.value[slot], now.mean, now.variance
    late += value[LATE]
    most = mean + problem.extras.most_deviations * math.sqrt(variance)
    cost = spread_cost(direction, late, mean, variance, most)
    return cost - spread_cost(direction, value[LATE], value[MEAN], value[VARIANCE], value[MOST])


@compiled
def weight_of_variance(problem: Problem, plan: WorkingPlan, deviation: float) -> float:
    """Return what a variance costs where the deviation of a plan costs so much.

    Of sampled days it is the same: routes have their deviations then. Else, a deviation d has the
    least of (v / e + e) / 2 over all e, of the variance v, at e = d. So the plan of the least
    deviation has the least variance at a price of 1 / 2 e.
    """
    if problem.extras.days > 0:
        return deviation
    mean, variance = 0.0, 0.0
    for number in range(plan.counts[USED]):
        mean += plan.value[plan.used[number], MEAN]
        variance += plan.value[plan.used[number], VARIANCE]
    least = max(math.sqrt(variance), _LEAST_SHARE * mean)
    return 0.5 * deviation / least if least > 0.0 else 0.0


@compiled
def on_most_days(problem: Problem, plan: WorkingPlan, objective: int) -> float:
    """Return what all routes together do not exceed on as many days as an objective says."""
    mean, variance, today = 0.0, 0.0, plan.today
    for day in range(len(today)):
        today[day] = 0.0
    for number in range(plan.counts[USED]):
        slot = plan.used[number]
        mean += plan.value[slot, MEAN]
        variance += plan.value[slot, VARIANCE]
        for day in range(len(today)):
            today[day] += plan.daily[len(problem.demand) + 2 * slot + 1, day]
    if len(today) > 0:
        return _in_order(today, problem.extras.day_at[objective])
    return mean + problem.extras.deviations[objective] * math.sqrt(variance)


@inlined
def _in_order(times: Array, place: int) -> float:
    """Return the time at a place, if they were in order."""
    for time in times:
        less = equal = 0
        for other in times:
            less += other < time
            equal += other == time
        if less <= place < less + equal:
            return float(time)
    return np.inf


@compiled
def _drive_days(problem: Problem, plan: WorkingPlan, slot: int) -> None:
    """Write when the visits of a route begin on each day, how many are late, and its time."""
    start, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    departure = plan.ready[end] - plan.value[slot, problem.clock]
    planned, late, now = departure, 0.0, plan.today
    for day in range(len(now)):
        now[day] = plan.daily[start, day] = departure
    plan.share[start] = 0.0
    at, node = problem.place[start], plan.next[start]
    while node != end:
        planned = _reached_by_days(problem, plan, slot, (at, node), planned)
        number = _window_at(problem, node, planned)
        plan.share[node] = _days_after(now, problem.extras.latest[node, number])
        late += plan.share[node]
        opens = problem.windows[node, number, 0]
        _wait(now, opens if opens > departure else 0.0)
        service = service_at(problem, problem.profile[slot], node)
        planned = max(planned, opens) + service
        for day in range(len(now)):
            plan.daily[node, day] = now[day]
            now[day] += service
        at, node = node, plan.next[node]
    _drive(problem, slot, at, problem.place[end], now)
    for day in range(len(now)):
        plan.daily[end, day] = now[day] - departure
    plan.value[slot, LATE] = late
    plan.value[slot, MEAN], plan.value[slot, VARIANCE] = _mean_and_deviation(plan.daily[end])
    plan.value[slot, MOST] = _in_order(plan.daily[end], problem.extras.most_day)


@inlined
def _drive(problem: Problem, slot: int, a: int, b: int, now: Array) -> None:
    """Add what a leg between two places takes on each day; nothing from or to anywhere."""
    if a < 0 or b < 0:
        return
    speed = problem.extras.speeds[problem.kind[slot]]
    for day in range(len(now)):
        now[day] += problem.extras.sampled[a, b, day] / speed


@inlined
def _wait(now: Array, opens: float) -> None:
    """Make no time earlier than this."""
    for day in range(len(now)):
        now[day] = max(now[day], opens)


@inlined
def _days_after(now: Array, latest: float) -> float:
    """Return on what share of days it is later than a time."""
    if latest == np.inf:
        return 0.0
    late = 0
    for day in range(len(now)):
        late += _is_over(now[day], latest)
    return late / len(now)


@inlined
def _mean_and_deviation(times: Array) -> tuple[float, float]:
    total, square = 0.0, 0.0
    for time in times:
        total += time
    mean = total / len(times)
    for time in times:
        square += (time - mean) * (time - mean)
    return mean, math.sqrt(square / len(times))


@inlined
def _reached_by_days(
    problem: Problem, plan: WorkingPlan, slot: int, between: tuple[int, int], planned: float
) -> float:
    """Drive to a node from a place on each day; return when its vehicle is there as planned."""
    at, node = between
    via, step = plan.via[node], plan.step[node, problem.clock]
    if via >= 0:
        away = min(step, leg(problem, problem.profile[slot], at, via, problem.clock))
        _drive(problem, slot, at, via, plan.today)
        planned, step, at = planned + away, step - away, via
        if plan.released[node] > planned:
            planned = plan.released[node]
            _wait(plan.today, planned)
    _drive(problem, slot, at, node, plan.today)
    return planned + step


@compiled
def _growth_by_days(state: State, stop: int, slot: int, before: int) -> float:
    """Return about what the cost grows by with a stop after a node, on the days that are known."""
    problem, plan, direction = state
    start, profile, now = len(problem.demand) + 2 * slot, problem.profile[slot], plan.today
    value, late, here, node = plan.value[slot], 0.0, before, stop
    departure = plan.daily[start, 0]
    for day in range(len(now)):
        now[day] = plan.daily[before, day]
    while node != start + 1:
        service = service_at(problem, profile, here) if here != start else 0.0
        for day in range(len(now)):
            now[day] += service
        _drive(problem, slot, problem.place[here], node, now)
        number = 0
        if problem.choice:
            number = _window_at(problem, node, _mean_and_deviation(now)[0])
        late += _days_after(now, problem.extras.latest[node, number])
        opens = problem.windows[node, number, 0]
        _wait(now, opens if opens > departure else 0.0)
        if node == stop:
            here, node = node, plan.next[before]
        else:
            late -= plan.share[node]
            here, node = node, plan.next[node]
    service = service_at(problem, profile, here)
    _drive(problem, slot, here, problem.place[start + 1], now)
    for day in range(len(now)):
        now[day] += service - departure
    mean, deviation = _mean_and_deviation(now)
    most = _in_order(now, problem.extras.most_day) if direction.most_penalty > 0 else 0.0
    cost = spread_cost(direction, value[LATE] + late, mean, deviation, most)
    return cost - spread_cost(direction, value[LATE], value[MEAN], value[VARIANCE], value[MOST])
