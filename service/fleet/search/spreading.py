"""Measure how a route turns out from day to day: how surely it is on time, and how long it takes.

As in punctuality.py, when a visit begins is taken to be normal.
"""

import math
from typing import NamedTuple

import numpy as np

from service.fleet.rounding import is_over
from service.fleet.search.problem import LATE, MEAN, MOST, VARIANCE, Direction, Problem
from service.fleet.search.working_plan import State, WorkingPlan, leg, service_at
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
def weight_of_variance(plan: WorkingPlan, deviation: float, used: int) -> float:
    """Return what a variance costs where the deviation of a plan costs so much.

    A deviation d has the least of (v / e + e) / 2 over all e, of the variance v, at e = d. So the
    plan of the least deviation has the least variance at a price of 1 / 2 e.
    """
    mean, variance = 0.0, 0.0
    for number in range(used):
        mean += plan.value[plan.used[number], MEAN]
        variance += plan.value[plan.used[number], VARIANCE]
    least = max(math.sqrt(variance), _LEAST_SHARE * mean)
    return 0.5 * deviation / least if least > 0.0 else 0.0
