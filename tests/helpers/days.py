"""Random days, and tours driven through them step by step, as the definition has it."""

from collections.abc import Iterator
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import NDArray

from service.day.breakpoints import Breakpoints
from service.day.costs import CostsOfDay
from service.instance import RouteEnds
from service.over_the_day.day import Day

Array = NDArray[np.float64]


def random_costs(rng: np.random.Generator, n: int, slices: int) -> CostsOfDay:
    """Return costs of at most `slices` slices, some by factors of one matrix, or by breakpoints."""
    if rng.random() < 0.4:
        return CostsOfDay.by_pair(random_breakpoints(rng, ~np.eye(n, dtype=np.bool_)))
    count = int(rng.integers(1, slices + 1))
    begins = np.sort(rng.choice(100, count, replace=False)).astype(np.float64)
    layers = rng.integers(0, 2, count)
    matrices = rng.integers(0, 30, (2, n, n)).astype(np.float64)
    return CostsOfDay(begins, rng.choice([0.5, 1.0, 2.0], count), layers, matrices)


def random_breakpoints(rng: np.random.Generator, pairs: NDArray[np.bool_]) -> Breakpoints:
    """Return up to five breakpoints of some pairs; who leaves later never arrives earlier."""
    spans, knots = np.zeros((*pairs.shape, 2), np.int64), []
    for i, j in np.argwhere(pairs).tolist():
        cost, begin = int(rng.integers(1, 30)), len(knots)
        times = np.sort(rng.choice(100, int(rng.integers(1, 6)), replace=False)).tolist()
        for before, time in zip([times[0], *times], times, strict=False):
            cost = int(rng.integers(max(1, cost - (time - before)), max(2, cost + 12)))
            knots.append((time, cost))
        spans[i, j] = begin, len(knots)
    times_of, costs = np.array(knots, np.float64).reshape(-1, 2).T.copy()
    return Breakpoints(spans, times_of, costs)


def random_day(
    rng: np.random.Generator, n: int, objectives: int = 2, slices: int = 4, width: float = 0.0
) -> Day:
    """Return a day of n stops, with closed or open tours that begin in a range of a width."""
    closed = bool(rng.random() < 0.5)
    free = [None, *range(n)]
    start, end = (None, None) if closed else (free[rng.integers(n + 1)], free[rng.integers(n + 1)])
    earliest = float(rng.integers(0, 60))
    return Day(
        costs=[random_costs(rng, n, slices) for _ in range(objectives)],
        clock=int(rng.integers(objectives)),
        service=rng.integers(0, 8, n).astype(np.float64),
        earliest=earliest,
        latest=earliest + width,
        ends=RouteEnds(closed, start, None if end == start else end),
    )


def tours_of(day: Day, first: int = 0) -> Iterator[tuple[int, ...]]:
    """Yield all tours; closed ones begin at a stop."""
    _, start, end = day.ends
    for tour in permutations(range(len(day.service))):
        begin = first if day.ends.closed else start
        if begin in (None, tour[0]) and end in (None, tour[-1]):
            yield tour


def slice_of(costs: CostsOfDay, time: float) -> int:
    """Return the slice of the day at a time."""
    return max(0, int((costs.begins <= time).sum()) - 1)


def cost_at(costs: CostsOfDay, time: float, i: int, j: int) -> float:
    """Return the cost of a leg that begins at a time."""
    knots = knots_of(costs, i, j)
    for (before, one), (after, other) in pairwise(knots):
        if before <= time <= after:
            return one + (other - one) * (time - before) / (after - before)
    if knots:
        return knots[0][1] if time < knots[0][0] else knots[-1][1]
    known = slice_of(costs, time)
    return float(costs.factors[known] * costs.matrices[costs.layers[known], i, j])


def knots_of(costs: CostsOfDay, i: int, j: int) -> list[tuple[float, float]]:
    """Return the breakpoints of a leg, if it has any."""
    if costs.pairs is None:
        return []
    numbers = range(*costs.pairs.spans[i, j].tolist())
    return [(float(costs.pairs.times[k]), float(costs.pairs.costs[k])) for k in numbers]


def arrival(costs: CostsOfDay, time: float, i: int, j: int) -> float:
    """Return when who leaves i at a time arrives at j, slice by slice."""
    if knots_of(costs, i, j):
        return time + cost_at(costs, time, i, j)
    driven = 0.0  # of the leg
    for ends in (*costs.begins[costs.begins > time], np.inf):
        whole = cost_at(costs, time, i, j)
        if driven + (ends - time) / max(whole, 1e-300) >= 1.0:
            return time + (1.0 - driven) * whole
        driven += (ends - time) / whole
        time = float(ends)
    raise AssertionError


def lengths_of(day: Day, tour: tuple[int, ...], departure: float) -> Array:
    """Return all lengths of a tour that begins at a time, shape (m,)."""
    lengths = np.zeros(len(day.costs))
    time = departure + day.service[tour[0]]
    legs = list(zip(tour, (*tour[1:], tour[0]), strict=True))
    for i, j in legs if day.ends.closed and len(tour) > 1 else legs[:-1]:
        for objective, costs in enumerate(day.costs):
            lengths[objective] += cost_at(costs, time, i, j)
        time = arrival(day.costs[day.clock], time, i, j)
        if not (day.ends.closed and j == tour[0]):
            time += day.service[j]
    lengths[day.clock] = time - departure
    return lengths
