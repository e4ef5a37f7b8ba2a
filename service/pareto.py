"""Dominance, hypervolume, best subsets, balance and knee of points of two minimised objectives.

A point dominates another if it is at least as good in both objectives and better in one. The
hypervolume of points is the share of the box between the origin and a reference point that they
dominate: a number from 0 to 1, without a unit.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
_SELECTING = 5e-8  # seconds for each pair of a point and a choice, twice what an EPYC core takes


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
    shares = _shares(points, reference_point)
    inside = shares[(shares < 1).all(axis=1)]
    front = inside[nondominated(inside)]
    heights = np.concatenate(([1.0], front[:-1, 1])) - front[:, 1]
    return float(((1 - front[:, 0]) * heights).sum())


def best_subset(
    points: Array, size: int, reference_point: Array, stop: Callable[[], bool] = lambda: False
) -> Indices:
    """Return the ascending indices of the `size` points with the largest joint hypervolume.

    Exact (Bringmann, Friedrich and Klitzke, 2014). If there are at most `size` points, all are
    returned. If fewer than `size` contribute to the hypervolume, the rest are nondominated
    points, and after these others, evenly spread along the first length. O(m log m + m size).

    Args:
        points: Shape (m, 2), in any order.
        size: How many points to choose, at least 1.
        reference_point: Shape (2,), positive, in the unit of the points.
        stop: Called for each point chosen; once it returns True, points that are evenly spread
            over the front are returned instead.

    Raises:
        ValueError: The size is not positive.

    >>> points = np.array([[5.0, 5.0], [4.0, 6.0], [2.0, 7.0], [7.0, 4.0]])
    >>> best_subset(points, 2, np.array([10.0, 10.0]))
    array([0, 2])
    """
    if size < 1:
        raise ValueError(f"size must be at least 1, got {size}")
    if len(points) <= size:
        return np.arange(len(points))
    front = nondominated(points)
    shares = _shares(points[front], reference_point)
    inside = (shares < 1).all(axis=1)
    useful = front[inside]
    if len(useful) > size:
        return np.sort(useful[_best_of_front(np.ascontiguousarray(shares[inside]), size, stop)])
    spare = np.setdiff1d(front, useful)
    if len(useful) + len(spare) < size:
        useful = front
        spare = np.setdiff1d(np.arange(len(points)), front)
    spare = spare[np.argsort(points[spare, 0], kind="stable")]
    places = np.linspace(0, len(spare) - 1, size - len(useful)).astype(np.intp)
    return np.sort(np.concatenate((useful, spare[places])))


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


def selection_seconds(size: int, m: int) -> float:
    """Return an estimate, rather too high, of the seconds that best_subset() of m points takes."""
    return _SELECTING * m * size if m > size else 0.0


def _shares(points: Array, reference_point: Array) -> Array:
    """Return points in units of a reference point; infinite where that is too small a unit."""
    with np.errstate(over="ignore"):
        shares: Array = points / reference_point
    return shares


def _best_of_front(shares: Array, size: int, stop: Callable[[], bool]) -> Indices:
    """Return the indices of the best `size` points of a front that has more.

    The points are scaled so that the reference point is (1, 1), and all lie below it. With x
    ascending and y descending, the best j points that end with i have hypervolume
    h(j, i) = max over l < i of h(j - 1, l) + (1 - x[i]) (y[l] - y[i]): for each l a line in
    1 - x[i]. Slopes and arguments both descend, so one pass along the upper envelope of the lines
    serves all i (Bringmann, Friedrich and Klitzke, 2014).
    """
    m = len(shares)
    before = np.empty((size, m), np.int32)
    value = (1 - shares[:, 0]) * (1 - shares[:, 1])
    hull = np.empty(m, np.int32)
    for j in range(1, size):
        if stop():
            return np.linspace(0, m - 1, size).astype(np.intp)
        value = _one_point_more(shares, value, before[j], hull, j)
    last = int(np.argmax(value[size - 1 :])) + size - 1
    chosen = np.empty(size, np.intp)
    for j in range(size - 1, -1, -1):
        chosen[j] = last
        last = before[j, last]
    return chosen


@allocating
def _one_point_more(
    shares: Array, value: Array, before: NDArray[np.int32], hull: NDArray[np.int32], j: int
) -> Array:
    """Return h(j + 1, i) for all i from h(j, l), and fill in the l that it was reached from."""
    extended = np.full(len(shares), -np.inf)
    head, tail = 0, 0
    for i in range(j, len(shares)):
        while tail - head > 1 and _hidden(shares, value, hull[tail - 2], hull[tail - 1], i - 1):
            tail -= 1
        hull[tail] = i - 1
        tail += 1
        x = 1 - shares[i, 0]
        while tail - head > 1 and _at(shares, value, hull[head + 1], x) >= _at(
            shares, value, hull[head], x
        ):
            head += 1
        before[i] = hull[head]
        extended[i] = _at(shares, value, hull[head], x) - x * shares[i, 1]
    return extended


@inlined
def _at(shares: Array, value: Array, line: int, x: float) -> float:
    """Return the height at x of the line of point `line`."""
    return value[line] + x * shares[line, 1]


@inlined
def _hidden(shares: Array, value: Array, a: int, b: int, c: int) -> bool:
    """Return whether line b, between a and c by slope, is nowhere above both of them."""
    ab = (value[b] - value[a]) * (shares[b, 1] - shares[c, 1])
    bc = (value[c] - value[b]) * (shares[a, 1] - shares[b, 1])
    return bc >= ab
