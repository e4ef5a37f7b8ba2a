"""A certificate: the hypervolume that no front of an instance can exceed.

For a weight w, a lower bound L(w) on the weighted length of every tour confines all points to
the half-plane w . f >= L(w). A front dominates no more of the box than what lies within all of
these half-planes.
"""

import time
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.instance import MOST_ENUMERATED, Instance, all_tours, tour_lengths
from service.pareto import hypervolume
from service.search.assignment import augment, make_assignment, price_bound
from service.search.costs import Costs, make_costs, units
from service.search.one_tree import ascend, make_ascent
from service.search.schedule import bisecting

Array = NDArray[np.float64]

WEIGHTS = 33
STEPS = 200  # of the subgradient at each weight
BLOCK = 1_000_000  # costs computed between two looks at the clock
SLACK = 1e-9  # share by which a lower bound is lowered, far above what rounding can raise it


def hypervolume_bound(
    instance: Instance, reference_point: Array, deadline: float | None = None
) -> float:
    """An upper bound on the share of the box that any front of the instance can dominate.

    Exact up to seven cities. Valid whenever it stops, and the tighter the later.

    Args:
        instance: What is planned.
        reference_point: Shape (2,), positive, in the instance's own units.
        deadline: When to stop, as a moment of time.monotonic(); None sets no limit.
    """
    if instance.n <= MOST_ENUMERATED:
        points = tour_lengths(instance, all_tours(instance.n))
        return hypervolume(points, reference_point)
    share = np.linspace(0.0, 1.0, WEIGHTS)
    weights = np.stack([share, 1 - share], axis=1) / instance.scale  # of own lengths
    costs = make_costs(instance)
    bound = one_tree_bounds if instance.symmetric else assignment_bounds
    lowest = np.zeros(WEIGHTS)
    for k, value in bound(costs, weights / units(instance)):
        lowest[k] = max(lowest[k], value * (1 - SLACK))
        if deadline is not None and time.monotonic() >= deadline:
            break
    return area_above(weights * reference_point, lowest)


def one_tree_bounds(costs: Costs, weights: Array) -> Iterator[tuple[int, float]]:
    """Pairs of the place of a weight and a lower bound under it, ever better."""
    n = len(costs.cities)
    block = max(1, BLOCK // n**2)
    shares = (1 - np.arange(STEPS) / STEPS) ** 2
    penalties: dict[int, Array] = {}
    for k in bisecting(len(weights)):
        nearest = min(penalties, key=lambda known: abs(known - k), default=None)
        ascent = make_ascent(np.zeros(n) if nearest is None else penalties[nearest])
        w0, w1 = weights[k].tolist()
        for begin in range(0, STEPS, block):
            ascend(costs, w0, w1, ascent, shares[begin : begin + block])
            yield k, float(ascent.best[0])
        penalties[k] = ascent.kept


def assignment_bounds(costs: Costs, weights: Array) -> Iterator[tuple[int, float]]:
    """Pairs of the place of a weight and a lower bound under it, ever better."""
    n = len(costs.cities)
    for k in bisecting(len(weights)):
        state = make_assignment(n)
        w0, w1 = weights[k].tolist()
        for city in range(n):
            augment(costs, w0, w1, state, city)
            if city == n - 1 or city % max(1, BLOCK // n**2) == 0:
                yield k, price_bound(costs, w0, w1, state.prices)


def area_above(weights: Array, lowest: Array) -> float:
    """The share of the unit square where weights, shape (k, 2), times point are never too low.

    Weights run from (0, positive) to (positive, 0), by ascending first component.
    """
    left = min(1.0, lowest[-1] / weights[-1, 0])
    corners = np.unique(np.clip([left, 1.0, *_crossings(weights[:-1], lowest[:-1])], left, 1.0))
    floor = (lowest[:-1] - corners[:, None] * weights[:-1, 0]) / weights[:-1, 1]
    return _area_over(corners, floor.max(axis=1))


def _crossings(weights: Array, lowest: Array) -> Array:
    """First components where two of the bounding lines, or a line and height 0 or 1, meet."""
    slopes, heights = -weights[:, 0] / weights[:, 1], lowest / weights[:, 1]
    slopes, heights = np.append(slopes, [0.0, 0.0]), np.append(heights, [0.0, 1.0])
    first, second = np.triu_indices(len(slopes), 1)
    steeper = slopes[first] != slopes[second]
    first, second = first[steeper], second[steeper]
    return (heights[second] - heights[first]) / (slopes[first] - slopes[second])


def _area_over(corners: Array, floor: Array) -> float:
    """The area of the square over a floor that is straight between corners once clipped."""
    open_height = 1 - floor.clip(0.0, 1.0)
    return float((np.diff(corners) * (open_height[1:] + open_height[:-1]) / 2).sum())
