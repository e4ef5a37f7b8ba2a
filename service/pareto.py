"""Dominance, hypervolume and best subsets of points under two objectives, both minimised."""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


def nondominated(points: Array) -> NDArray[np.intp]:
    """Indices of the nondominated points among points, shape (m, 2), by ascending first length.

    Of equal points the first one given stays. O(m log m).
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    second = points[order, 1]
    best_before = np.concatenate(([np.inf], np.minimum.accumulate(second)[:-1]))
    return order[second < best_before]


def hypervolume(points: Array, reference_point: Array) -> float:
    """Share of the box from the origin to the reference point that the points dominate, 0 to 1.

    Exact, by a sweep over the nondominated points; points beyond the reference point add
    nothing. The points, shape (m, 2), may be in any order and may repeat.

    Raises:
        ValueError: a component of the reference point is not positive.
    """
    if not (reference_point > 0).all():
        raise ValueError(f"the reference point must be positive, got {reference_point.tolist()}")
    shares = points / reference_point
    inside = shares[(shares < 1).all(axis=1)]
    front = inside[nondominated(inside)]
    heights = np.concatenate(([1.0], front[:-1, 1])) - front[:, 1]
    return float(((1 - front[:, 0]) * heights).sum())


def best_subset(points: Array, size: int, reference_point: Array) -> Indices:
    """Indices, ascending, of the size points whose hypervolume together is largest. Exact.

    Points, shape (m, 2), in any order. All of them, where they are no more than size. Places
    that no point can fill with profit go to nondominated points, then to others, evenly spread
    along the first length. O(m log m + m size).

    Raises:
        ValueError: size is not positive.
    """
    if size < 1:
        raise ValueError(f"size must be at least 1, got {size}")
    if len(points) <= size:
        return np.arange(len(points))
    front = nondominated(points)
    shares = points[front] / reference_point
    inside = (shares < 1).all(axis=1)
    useful = front[inside]
    if len(useful) > size:
        return np.sort(useful[_chosen(np.ascontiguousarray(shares[inside]), size)])
    spare = np.setdiff1d(front, useful)
    if len(useful) + len(spare) < size:
        useful = front
        spare = np.setdiff1d(np.arange(len(points)), front)
    spare = spare[np.argsort(points[spare, 0], kind="stable")]
    places = np.linspace(0, len(spare) - 1, size - len(useful)).astype(np.intp)
    return np.sort(np.concatenate((useful, spare[places])))


@allocating
def _chosen(shares: Array, size: int) -> Indices:
    """Places of the best size of more nondominated shares, sorted and all below 1.

    With x ascending and y descending, the best j points of which i is the last have hypervolume
    h(j, i) = max over l < i of h(j - 1, l) + (1 - x[i]) (y[l] - y[i]): for each l a line in
    1 - x[i]. Slopes and arguments both descend, so one pass along the lines' upper envelope
    serves all i (Bringmann, Friedrich and Klitzke, 2014).
    """
    m = len(shares)
    before = np.empty((size, m), np.int32)
    value = (1 - shares[:, 0]) * (1 - shares[:, 1])
    hull = np.empty(m, np.int32)
    for j in range(1, size):
        value = _longer(shares, value, before[j], hull, j)
    last = np.argmax(value[size - 1 :]) + size - 1
    chosen = np.empty(size, np.intp)
    for j in range(size - 1, -1, -1):
        chosen[j] = last
        last = before[j, last]
    return chosen


@allocating
def _longer(
    shares: Array, value: Array, before: NDArray[np.int32], hull: NDArray[np.int32], j: int
) -> Array:
    """The hypervolume of the best j + 1 points by the last of them, from that of the best j."""
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
    """The height of a line at x."""
    return value[line] + x * shares[line, 1]


@inlined
def _hidden(shares: Array, value: Array, a: int, b: int, c: int) -> bool:
    """Whether line b, between a and c by slope, is nowhere above both of them."""
    ab = (value[b] - value[a]) * (shares[b, 1] - shares[c, 1])
    bc = (value[c] - value[b]) * (shares[a, 1] - shares[b, 1])
    return bc >= ab
