"""Dominance, hypervolume, balance and knee of points of two minimised objectives.

A point dominates another if it is at least as good in both objectives and better in one. The
hypervolume of points is the share of the box between the origin and a reference point that they
dominate: a number from 0 to 1, without a unit.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def nondominated(points: Array) -> Indices:
    """Return the indices of the nondominated points, by ascending first length.

    Of equal points the first one stays. So along the result the first length strictly ascends
    and the second strictly descends. O(m log m).

    Args:
        points: Shape (m, 2), in any order and unit; m may be 0.

    >>> nondominated(np.array([[5, 5], [4, 6], [2, 7], [7, 4], [6, 6], [2, 7]]))
    array([2, 1, 0, 3])
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    second = points[order, 1]
    best_before = np.concatenate(([np.inf], np.minimum.accumulate(second)[:-1]))
    return order[second < best_before]


def hypervolume(points: Array, reference_point: Array) -> float:
    """Return the hypervolume of points: the share of the box that they dominate, 0 to 1.

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
    front = inside[nondominated(inside)]
    heights = np.concatenate(([1.0], front[:-1, 1])) - front[:, 1]
    return float(((1 - front[:, 0]) * heights).sum())


def balances(points: Array) -> Array:
    """Return the balance of each point: 0 at the least first length, 1 at the least second.

    With u and v the two lengths in the points' own box, 0 at its least and 1 at its greatest, the
    balance is (u + 1 - v) / 2. Where all points have one length in common, that one counts as 0.

    Args:
        points: Shape (m, 2), in any order and unit.

    >>> balances(np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0]]))
    array([0. , 0.5, 1. ])
    >>> balances(np.array([[5.0, 5.0]]))
    array([0.5])
    """
    u, v = _in_box(points).T
    return (u + 1 - v) / 2


def knee(points: Array) -> int:
    """Return the index of the point with the least u + v, of equal ones the first.

    u and v are the lengths in the points' own box, as of balances().

    Args:
        points: Shape (m, 2), m at least 1.

    >>> knee(np.array([[2.0, 70.0], [3.0, 40.0], [6.0, 30.0]]))
    1
    """
    return int(_in_box(points).sum(axis=1).argmin())


def _in_box(points: Array) -> Array:
    """Return points in their own box: 0 at the least of a length, 1 at the greatest."""
    if not len(points):
        return points
    least = points.min(axis=0)
    extent = points.max(axis=0) - least
    return (points - least) / np.where(extent > 0, extent, 1.0)


def shares_of(points: Array, reference_point: Array) -> Array:
    """Return points in units of a reference point; infinite where that is too small a unit."""
    with np.errstate(over="ignore"):
        shares: Array = points / reference_point
    return shares
