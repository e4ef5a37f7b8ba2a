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
    """A time that differs from day to day; where days are known, `today` has it instead."""

    mean: float
    variance: float


@inlined
def _begun(plan: WorkingPlan, time: float) -> Normal:
    """Return a time that is the same every day."""
    for day in range(len(plan.today)):
        plan.today[day] = time
    return Normal(time, 0.0)


@inlined
def _note(plan: WorkingPlan, node: int, now: Normal) -> None:
    """Write when the visit of a node begins."""
    plan.mean[node], plan.variance[node] = now.mean, now.variance
    for day in range(len(plan.today)):
        plan.daily[node, day] = plan.today[day]


@inlined
def _noted(plan: WorkingPlan, node: int) -> Normal:
    """Return when the visit of a node begins."""
    for day in range(len(plan.today)):
        plan.today[day] = plan.daily[node, day]
    return Normal(plan.mean[node], plan.variance[node])


@inlined
def _later(plan: WorkingPlan, now: Normal, time: float) -> Normal:
    """Return a time plus what takes as long every day."""
    for day in range(len(plan.today)):
        plan.today[day] += time
    return Normal(now.mean + time, now.variance)


@inlined
def _after(
    problem: Problem,
    plan: WorkingPlan,
    slot: int,
    between: tuple[int, int],
    left: tuple[Normal, float],
) -> Normal:
    """Return when a leg ends between two places, given when it begins and what it takes.

    From or to anywhere it takes nothing.
    """
    (a, b), (now, leg_to) = between, left
    if len(plan.today) > 0 and a >= 0 and b >= 0:
        speed = problem.extras.speeds[problem.kind[slot]]
        for day in range(len(plan.today)):
            plan.today[day] += problem.extras.sampled[a, b, day] / speed
    deviation = problem.extras.spread * leg_to
    return Normal(now.mean + leg_to, now.variance + deviation * deviation)


@inlined
def _from_on(plan: WorkingPlan, now: Normal, opens: float) -> Normal:
    """Return the later one of a time and that at which a stop opens (Clark, 1961)."""
    for day in range(len(plan.today)):
        plan.today[day] = max(plan.today[day], opens)
    if now.variance == 0.0:
        return Normal(max(now.mean, opens), 0.0)
    deviation, ahead = math.sqrt(now.variance), now.mean - opens
    z = ahead / deviation
    share = 0.5 * (1.0 + math.erf(z / _ROOT))
    density = deviation * _DENSITY * math.exp(-0.5 * z * z)
    mean = ahead * share + density
    square = (ahead * ahead + now.variance) * share + ahead * density
    return Normal(opens + mean, max(0.0, square - mean * mean))


@inlined
def _share_after(plan: WorkingPlan, now: Normal, latest: float) -> float:
    """Return on what share of days a time is later than another."""
    if latest == np.inf:
        return 0.0
    if len(plan.today) > 0:
        late = 0
        for time in plan.today:
            late += _is_over(time, latest)
        return late / len(plan.today)
    if now.variance == 0.0:
        return 1.0 if _is_over(now.mean, latest) else 0.0
    return 0.5 * math.erfc((latest - now.mean) / (_ROOT * math.sqrt(now.variance)))


@inlined
def _mean_and_spread(plan: WorkingPlan, now: Normal) -> tuple[float, float]:
    """Return the mean of a time and its variance; where days are known, its deviation."""
    days = len(plan.today)
    if days == 0:
        return now.mean, now.variance
    total, square = 0.0, 0.0
    for time in plan.today:
        total += time
    mean = total / days
    for time in plan.today:
        square += (time - mean) * (time - mean)
    return mean, math.sqrt(square / days)


@inlined
def _at_percentile(problem: Problem, plan: WorkingPlan, mean: float, variance: float) -> float:
    """Return what a time does not exceed, on as many days as the longest route must not."""
    if len(plan.today) > 0:
        return _in_order(plan.today, problem.extras.most_day)
    return mean + problem.extras.most_deviations * math.sqrt(variance)


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
    start, end = len(problem.demand) + 2 * slot, len(problem.demand) + 2 * slot + 1
    departure = plan.ready[end] - plan.value[slot, problem.clock]
    planned, now, late = departure, _begun(plan, departure), 0.0
    _note(plan, start, now)
    plan.share[start] = 0.0
    at, node = problem.place[start], plan.next[start]
    while node != end:
        planned, now = _reached(problem, plan, slot, (at, node), (planned, now))
        number = _window_at(problem, node, planned)
        plan.share[node] = _share_after(plan, now, problem.extras.latest[node, number])
        late += plan.share[node]
        opens = problem.windows[node, number, 0]
        if opens > departure:
            now = _from_on(plan, now, opens)
        _note(plan, node, now)
        service = service_at(problem, problem.profile[slot], node)
        planned = max(planned, opens) + service
        now = _later(plan, now, service)
        at, node = node, plan.next[node]
    ends = at, problem.place[end]
    now = _after(problem, plan, slot, ends, (now, plan.step[end, problem.clock]))
    now = _later(plan, now, -departure)
    _note(plan, end, now)
    mean, variance = _mean_and_spread(plan, now)
    plan.value[slot, LATE] = late
    plan.value[slot, MEAN], plan.value[slot, VARIANCE] = mean, variance
    plan.value[slot, MOST] = _at_percentile(problem, plan, mean, variance)


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
    via, step = plan.via[node], plan.step[node, problem.clock]
    if via >= 0:
        away = min(step, leg(problem, problem.profile[slot], at, via, problem.clock))
        now = _after(problem, plan, slot, (at, via), (now, away))
        planned, step, at = planned + away, step - away, via
        if plan.released[node] > planned:
            planned = plan.released[node]
            now = _from_on(plan, now, planned)
    return planned + step, _after(problem, plan, slot, (at, node), (now, step))


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
    start, profile = len(problem.demand) + 2 * slot, problem.profile[slot]
    value, departure = plan.value[slot], plan.mean[start]
    now, late, here, node = _noted(plan, before), 0.0, before, stop
    while node != start + 1:
        if here != start:
            now = _later(plan, now, service_at(problem, profile, here))
        at = problem.place[here]
        away = leg(problem, profile, at, node, problem.clock)
        now = _after(problem, plan, slot, (at, node), (now, away))
        number = 0
        if problem.choice:
            number = _window_at(problem, node, _mean_and_spread(plan, now)[0])
        late += _share_after(plan, now, problem.extras.latest[node, number])
        if problem.windows[node, number, 0] > departure:
            now = _from_on(plan, now, problem.windows[node, number, 0])
        if node == stop:
            here, node = node, plan.next[before]
        else:
            late -= plan.share[node]
            here, node = node, plan.next[node]
    now = _later(plan, _later(plan, now, service_at(problem, profile, here)), -departure)
    there = problem.place[start + 1]
    away = leg(problem, profile, here, there, problem.clock)
    now = _after(problem, plan, slot, (here, there), (now, away))
    mean, variance = _mean_and_spread(plan, now)
    most = _at_percentile(problem, plan, mean, variance) if direction.most_penalty > 0 else 0.0
    cost = spread_cost(direction, value[LATE] + late, mean, variance, most)
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
