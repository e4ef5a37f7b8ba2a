"""An upper bound on the hypervolume of every front of an instance.

For a weight w, a lower bound L(w) on the weighted length of all tours confines their points to
the half-plane w . f >= L(w). So a front dominates no more of the box than what lies within all of
these half-planes.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.objectives import OBJECTIVES
from service.search.bound.several import bound_of_several
from service.search.bound.weighted import lowest_sums
from service.search.costs import as_two, make_costs, scaled_reference
from service.search.enumeration import exact_tours
from service.search.hypervolume import hypervolume
from service.search.sizes import MAX_ENUMERATED
from service.search.weights import bisection_order
from service.watch import Watch

Array = NDArray[np.float64]

WEIGHTS = 33


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
    sums = [as_two(costs, each) for each in weights]
    places = np.arange(float(WEIGHTS))[:, np.newaxis]
    lowest = lowest_sums(sums, bisection_order(WEIGHTS), places, watch)
    return area_above(weights * scaled_reference(instance, reference_point), lowest)


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
