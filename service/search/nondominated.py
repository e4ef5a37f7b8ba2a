"""Nondominated points of two, three or four objectives."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service import pareto
from service.jit import compiled, inlined
from service.objectives import OBJECTIVES

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Numbers = NDArray[np.int64]
Marks = NDArray[np.bool_]


def nondominated(points: Array) -> Indices:
    """Return the indices of the nondominated points, by ascending first length, then the second.

    Of equal points the first one stays. Of more than two objectives, a point with an infinite
    length is left out. O(k log k) of two and of three objectives, O(k log^2 k) of four.

    Args:
        points: Shape (k, m), in any order and unit; k may be 0.

    >>> nondominated(np.array([[5.0, 5, 1], [4, 6, 1], [4, 6, 2], [7, 7, 0]]))
    array([1, 0, 3])
    """
    if points.shape[1] == OBJECTIVES:
        return pareto.nondominated(points)
    order = np.lexsort(points.T[::-1])
    order = order[np.isfinite(points[order]).all(axis=1)]
    ordered = np.ascontiguousarray(points[order], np.float64)
    ranks = np.unique(ordered[:, -2], return_inverse=True)[1].astype(np.int64)
    last = ordered[:, -1].copy()
    dominated = np.zeros(len(order), np.bool_)
    least = np.full(1 + len(order), np.inf)
    if points.shape[1] == OBJECTIVES + 1:
        _mark_of_three(ranks, last, least, dominated)
    else:
        merge = Merge(ordered[:, 1].copy(), ranks, last, least, dominated)
        places = np.arange(len(order))
        _mark_of_four(merge, places, np.empty_like(places))
    return order[~dominated]


@compiled
def _mark_of_three(seconds: Numbers, thirds: Array, least: Array, dominated: Marks) -> None:
    """Mark each point that one before it equals or dominates: points ascend by the first length.

    Args:
        seconds: The ranks of the second lengths, shape (k,).
        thirds: The third lengths, shape (k,).
        least: Scratch space, shape (k + 1,), infinite.
        dominated: The marks, shape (k,).
    """
    for k in range(len(seconds)):
        if least_up_to(least, seconds[k]) <= thirds[k]:
            dominated[k] = True
        else:
            lower(least, seconds[k], thirds[k])


class Merge(NamedTuple):
    """Points of four objectives by ascending first length, and which are dominated."""

    seconds: Array  # (k,), the second lengths
    thirds: Numbers  # (k,), the ranks of the third lengths
    fourths: Array  # (k,), the fourth lengths
    least: Array  # (k + 1,), scratch space, infinite
    dominated: Marks  # (k,)


@compiled
def _mark_of_four(merge: Merge, places: Numbers, merged: Numbers) -> None:
    """Mark each point that one before it equals or dominates.

    This is a merge sort of the points by their second lengths. When two neighbouring runs are
    merged, each point of the later run meets those of the earlier one whose second length is not
    greater (Kung, Luccio and Preparata, 1975, divide alike).

    Args:
        merge: The points.
        places: The numbers from 0 to k - 1; these are sorted.
        merged: Scratch space, shape (k,).
    """
    size, width = len(places), 1
    while width < size:
        for begin in range(0, size, 2 * width):
            merge_runs(merge, places, merged, begin, width)
        for k in range(size):
            places[k] = merged[k]
        width *= 2


@inlined
def merge_runs(merge: Merge, places: Numbers, merged: Numbers, begin: int, width: int) -> None:
    """Merge the run that begins at a place with the next one, and mark what it dominates there."""
    middle = min(begin + width, len(places))
    end = min(middle + width, len(places))
    i, j = begin, middle
    for to in range(begin, end):
        if j == end or (i < middle and not merge.seconds[places[j]] < merge.seconds[places[i]]):
            k = places[i]
            i += 1
            lower(merge.least, merge.thirds[k], merge.fourths[k])
        else:
            k = places[j]
            j += 1
            if least_up_to(merge.least, merge.thirds[k]) <= merge.fourths[k]:
                merge.dominated[k] = True
        merged[to] = k
    for place in range(begin, middle):
        forget(merge.least, merge.thirds[places[place]])


@compiled
def lower(least: Array, rank: int, value: float) -> None:
    """Enter a value at a rank (Fenwick, 1994: a tree of the least values of ranges of ranks)."""
    node = rank + 1
    while node < len(least):
        least[node] = min(least[node], value)
        node += node & -node


@compiled
def least_up_to(least: Array, rank: int) -> float:
    """Return the least value entered at any rank up to the given one."""
    node, found = rank + 1, np.inf
    while node > 0:
        found = min(found, least[node])
        node -= node & -node
    return found


@compiled
def forget(least: Array, rank: int) -> None:
    """Take back all values that were entered at a rank; those of other ranks must go as well."""
    node = rank + 1
    while node < len(least):
        least[node] = np.inf
        node += node & -node
