"""Dominance of points of minimised objectives, and the hypervolume of points of two.

A point dominates another if it is at least as good in all objectives and better in one. The
hypervolume of points is the share of the box between the origin and a reference point that they
dominate: a number from 0 to 1, without a unit.
"""

import numpy as np
from numpy.typing import NDArray

from service.objectives import OBJECTIVES

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def nondominated(points: Array) -> Indices:
    """Return the indices of the nondominated points, by ascending first length, then the second.

    Of equal points the first one stays. Of two objectives the first length strictly ascends along
    the result and the second strictly descends; O(k log k). Of more objectives O(k^2);
    service.search.nondominated is faster, in compiled code.

    Args:
        points: Shape (k, m), in any order and unit; k may be 0.

    >>> nondominated(np.array([[5, 5], [4, 6], [2, 7], [7, 4], [6, 6], [2, 7]]))
    array([2, 1, 0, 3])
    >>> nondominated(np.array([[5, 5, 1], [4, 6, 1], [4, 6, 2], [7, 7, 0]]))
    array([1, 0, 3])
    """
    if points.shape[1] > OBJECTIVES:
        return _nondominated_of_several(points)
    order = np.lexsort((points[:, 1], points[:, 0]))
    second = points[order, 1]
    best_before = np.concatenate(([np.inf], np.minimum.accumulate(second)[:-1]))
    return order[second < best_before]


def _nondominated_of_several(points: Array) -> Indices:
    """Return the same for more than two objectives.

    In this order no point is dominated by one after it. One with an infinite length is left out.
    """
    order = np.lexsort(points.T[::-1])
    order = order[np.isfinite(points[order]).all(axis=1)]
    kept = np.empty_like(points)
    indices: list[int] = []
    for index in order.tolist():
        if not (kept[: len(indices)] <= points[index]).all(axis=1).any():
            kept[len(indices)] = points[index]
            indices.append(index)
    return np.array(indices, np.intp)


def hypervolume(points: Array, reference_point: Array) -> float:
    """Return the hypervolume of points of two objectives: the share of the box they dominate.

    Exact, by a sweep over the nondominated points. Dominated points, repeated ones, and those that
    do not lie below the reference point in both objectives add nothing. O(m log m).

    Args:
        points: Shape (m, 2), not negative, in any order; m may be 0.
        reference_point: Shape (2,), positive, in the unit of the points.

    Raises:
        ValueError: A component of the reference point is not positive.

    The example of moocore's documentation, where the area is 38 of 100:

    >>> points = np.array([[5, 5], [4, 6], [2, 7], [7, 4]])
    >>> round(hypervolume(points, np.array([10, 10])), 12)
    0.38
    """
    if not (reference_point > 0).all():
        raise ValueError(f"the reference point must be positive, got {reference_point.tolist()}")
    shares = shares_of(points, reference_point)
    inside = shares[(shares < 1).all(axis=1)]
    return area(inside[nondominated(inside)])


def area(front: Array) -> float:
    """Return the hypervolume of nondominated points, which ascend by their first length.

    Args:
        front: Shape (k, 2), below 1: in units of the reference point.
    """
    heights = np.concatenate(([1.0], front[:-1, 1])) - front[:, 1]
    return min(1.0, float(((1 - front[:, 0]) * heights).sum()))  # 1 at most, for all rounding


def shares_of(points: Array, reference_point: Array) -> Array:
    """Return points in units of a reference point; infinite where that is too small a unit."""
    with np.errstate(over="ignore"):
        shares: Array = points / reference_point
    return shares
