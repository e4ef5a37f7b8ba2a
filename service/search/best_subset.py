"""Best subsets: of the points of a front, those with the largest joint hypervolume."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, inlined
from service.objectives import OBJECTIVES
from service.pareto import nondominated, shares_of
from service.search.several.volume import choose_greedily, make_sweep

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
_SELECTING = 5e-8  # seconds for each pair of a point and a choice, twice what an EPYC core takes
_SELECTING_OF_SEVERAL = 1e-7  # the same of three objectives; of each further one times the size


def best_subset(
    points: Array, size: int, reference_point: Array, stop: Callable[[], bool] = lambda: False
) -> Indices:
    """Return the ascending indices of the `size` points with the largest joint hypervolume.

    Of two objectives exact (Bringmann, Friedrich and Klitzke, 2014). Of more, points are chosen one
    after another, each time that which adds most: the hypervolume is at least 63 % of the largest
    (Nemhauser, Wolsey and Fisher, 1978). If there are at most `size` points, all are returned. If
    fewer than `size` contribute to the hypervolume, the rest are other nondominated points, and
    then any others, evenly spread along the first length. O(k log k + k size) of two objectives.

    Args:
        points: Shape (k, m), in any order.
        size: How many points to choose, at least 1.
        reference_point: Shape (m,), positive, in the unit of the points.
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
    shares = shares_of(points[front], reference_point)
    inside = (shares < 1).all(axis=1)
    useful = front[inside]
    if len(useful) > size:
        best = _best_of_front if points.shape[1] == OBJECTIVES else _greedy
        return np.sort(useful[best(np.ascontiguousarray(shares[inside]), size, stop)])
    spare = np.setdiff1d(front, useful)
    if len(useful) + len(spare) < size:
        useful = front
        spare = np.setdiff1d(np.arange(len(points)), front)
    spare = spare[np.argsort(points[spare, 0], kind="stable")]
    places = np.linspace(0, len(spare) - 1, size - len(useful)).astype(np.intp)
    return np.sort(np.concatenate((useful, spare[places])))


def selection_seconds(size: int, points: int, objectives: int = OBJECTIVES) -> float:
    """Return an estimate, rather too high, of the seconds that best_subset() takes."""
    if points <= size:
        return 0.0
    if objectives == OBJECTIVES:
        return _SELECTING * points * size
    return _SELECTING_OF_SEVERAL * points * size * (1 if objectives == 3 else size)


def _greedy(shares: Array, size: int, stop: Callable[[], bool]) -> Indices:
    """Return the indices of `size` points, chosen one after another from more."""
    gains = (1 - shares).prod(axis=1)
    chosen = np.empty(size, np.int64)
    sweep = make_sweep(size, shares.shape[1])
    for count in range(size):
        if stop():
            rest = np.flatnonzero(gains >= 0)
            places = np.linspace(0, len(rest) - 1, size - count).astype(np.intp)
            return np.concatenate((chosen[:count], rest[places]))
        choose_greedily(shares, gains, chosen, count, sweep)
    return chosen


def _best_of_front(shares: Array, size: int, stop: Callable[[], bool]) -> Indices:
    """Return the indices of the best `size` points of a front that has more.

    The points are scaled so that the reference point is (1, 1), and all lie below it. With x
    ascending and y descending, the best j points that end with point i have hypervolume
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
