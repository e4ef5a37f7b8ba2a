"""An upper bound on the hypervolume of every front of an instance.

For a weight w, a lower bound L(w) on the weighted length of all tours confines their points to
the half-plane w . f >= L(w). So a front dominates no more of the box than what lies within all of
these half-planes.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.objectives import OBJECTIVES
from service.search.bound.assignment import augment, make_assignment, price_bound
from service.search.bound.one_tree import ascend, make_ascent
from service.search.bound.several import bound_of_several
from service.search.costs import Costs, make_costs, scaled_reference
from service.search.enumeration import MAX_ENUMERATED, exact_tours
from service.search.hypervolume import hypervolume
from service.search.pareto_local_search import bisection_order
from service.watch import Watch

Array = NDArray[np.float64]

WEIGHTS = 33
STEPS = 200  # of the subgradient ascent at each weight
BLOCK = 1_000_000  # costs computed between two checks of the deadline
SLACK = 1e-9  # share by which a lower bound is lowered, far above what rounding can raise it


def hypervolume_bound(
    instance: Instance, reference_point: Array, watch: Watch[Any] | None = None
) -> float:
    """Return an upper bound on the hypervolume of any front of the instance, 0 to 1.

    Exact up to nine cities. It is valid however early it stops, and tightens with time.
    By the Held-Karp bound where costs are symmetric, else by the assignment bound; either takes
    O(n^2) for each step under each weight.

    Args:
        instance: The instance.
        reference_point: Shape (m,), positive, in the instance's own units.
        watch: Asked at least every few ms whether to end. None sets no limit.
    """
    watch = watch or Watch()
    if instance.n <= MAX_ENUMERATED:
        tours, complete = exact_tours(instance, watch)
        if complete:
            return hypervolume(tour_lengths(instance, tours), reference_point)
    if instance.objectives > OBJECTIVES:
        return bound_of_several(instance, reference_point, watch)
    share = np.linspace(0.0, 1.0, WEIGHTS)
    scale = np.ldexp(instance.scale, instance.shifts)
    weights = np.stack([share, 1 - share], axis=1) / scale
    costs = make_costs(instance)
    bound = one_tree_bounds if instance.symmetric else assignment_bounds
    lowest = np.zeros(WEIGHTS)
    for k, value in bound(costs, weights):
        lowest[k] = max(lowest[k], value * (1 - SLACK))
        if watch.ended():
            break
    return area_above(weights * scaled_reference(instance, reference_point), lowest)


def one_tree_bounds(costs: Costs, weights: Array) -> Iterator[tuple[int, float]]:
    """Yield pairs of a weight's index and a lower bound under that weight, ever better.

    Costs must be symmetric; weights have shape (k, 2), for scaled lengths.
    """
    n = len(costs.cities)
    block = max(1, BLOCK // n**2)
    shares = (1 - np.arange(STEPS) / STEPS) ** 2
    penalties: dict[int, Array] = {}
    for k in bisection_order(len(weights)):
        nearest = min(penalties, key=lambda done: abs(done - k), default=None)
        ascent = make_ascent(np.zeros(n) if nearest is None else penalties[nearest])
        w0, w1 = weights[k].tolist()
        for begin in range(0, STEPS, block):
            ascend(costs, w0, w1, ascent, shares[begin : begin + block])
            yield k, float(ascent.best_bound[0])
        penalties[k] = ascent.best_penalties


def assignment_bounds(costs: Costs, weights: Array) -> Iterator[tuple[int, float]]:
    """Yield pairs of a weight's index and a lower bound under that weight, ever better.

    Weights have shape (k, 2), for scaled lengths.
    """
    n = len(costs.cities)
    for k in bisection_order(len(weights)):
        assignment = make_assignment(n)
        w0, w1 = weights[k].tolist()
        for city in range(n):
            augment(costs, w0, w1, assignment, city)
            if city == n - 1 or city % max(1, BLOCK // n**2) == 0:
                yield k, price_bound(costs, w0, w1, assignment.prices)


def area_above(weights: Array, lowest: Array) -> float:
    """Return the area of the points p of the unit square with weights @ p >= lowest.

    Weights, shape (k, 2), run from (0, positive) to (positive, 0) by ascending first component;
    lowest has shape (k,).
    """
    left = min(1.0, lowest[-1] / weights[-1, 0])
    corners = np.unique(np.clip([left, 1.0, *_crossings(weights[:-1], lowest[:-1])], left, 1.0))
    floor = (lowest[:-1] - corners[:, None] * weights[:-1, 0]) / weights[:-1, 1]
    return _area_over(corners, floor.max(axis=1))


def _crossings(weights: Array, lowest: Array) -> Array:
    """Return the first components at which two bounding lines, or a line and 0 or 1, meet."""
    slopes, heights = -weights[:, 0] / weights[:, 1], lowest / weights[:, 1]
    slopes, heights = np.append(slopes, [0.0, 0.0]), np.append(heights, [0.0, 1.0])
    first, second = np.triu_indices(len(slopes), 1)
    steeper = slopes[first] != slopes[second]
    first, second = first[steeper], second[steeper]
    return (heights[second] - heights[first]) / (slopes[first] - slopes[second])


def _area_over(corners: Array, floor: Array) -> float:
    """Return the area of the unit square above a floor that is linear between the corners."""
    open_height = 1 - floor.clip(0.0, 1.0)
    area = float((np.diff(corners) * (open_height[1:] + open_height[:-1]) / 2).sum())
    return min(1.0, area)  # 1 at most, for all rounding
