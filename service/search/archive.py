"""The archive: all nondominated tours found so far, sorted by their first length."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.selection import select

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

MAX_POINTS = 50_000
MAX_BYTES = 2**28  # of tours
ROUNDING = 2.0**-52  # relative: as much as two sums of the same steps may differ for each step


class Archive(NamedTuple):
    """Points by ascending first length, so by descending second length, and their tours.

    Point k belongs to the tour in row slots[k] of tours. Memory for tours is reserved but not
    touched before it is needed, and rows that become free are reused first.
    """

    points: Array  # (capacity, 2), in the unit of make_costs()
    slots: Cities  # (capacity,)
    tours: Cities  # (capacity, n)
    free: Cities  # (capacity,), a stack of unused rows
    tries: Cities  # (capacity,), by row: how often a search has started from the tour
    counts: NDArray[np.int64]  # (3,): points, unused rows, tours ever inserted


def make_archive(n: int, capacity: int = MAX_POINTS) -> Archive:
    """Return an empty archive for tours of n cities."""
    capacity = max(16, min(capacity, MAX_BYTES // (4 * n)))
    return Archive(
        np.empty((capacity, 2)),
        np.empty(capacity, np.int32),
        np.empty((capacity, n), np.int32),
        np.arange(capacity - 1, -1, -1, dtype=np.int32),
        np.empty(capacity, np.int32),
        np.array([0, capacity, 0], np.int64),
    )


@inlined
def count_up_to(archive: Archive, bound: float) -> int:
    """Return how many points have a first length of at most `bound`. O(log m)."""
    low, high = 0, archive.counts[0]
    while low < high:
        middle = (low + high) >> 1
        if archive.points[middle, 0] <= bound:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def accepts(archive: Archive, first: float, second: float) -> bool:
    """Return whether no point dominates or equals the given one, but for rounding. O(log m)."""
    slack = 1 + ROUNDING * archive.tours.shape[1]
    k = count_up_to(archive, first * slack)
    return k == 0 or archive.points[k - 1, 1] > second * slack


@inlined
def copy_point(archive: Archive, source: int, target: int) -> None:
    """Copy a point from one place to another."""
    archive.points[target, 0] = archive.points[source, 0]
    archive.points[target, 1] = archive.points[source, 1]
    archive.slots[target] = archive.slots[source]


@compiled
def replace(archive: Archive, begin: int, end: int, point: tuple[float, float]) -> int:
    """Replace the points begin to end - 1 by one, and return the row for its tour."""
    size = archive.counts[0]
    for k in range(begin, end):
        archive.free[archive.counts[1]] = archive.slots[k]
        archive.counts[1] += 1
    shift = 1 - (end - begin)
    if shift > 0:
        for k in range(size - 1, end - 1, -1):
            copy_point(archive, k, k + 1)
    elif shift < 0:
        for k in range(end, size):
            copy_point(archive, k, k + shift)
    archive.counts[0] = size + shift
    archive.counts[1] -= 1
    archive.counts[2] += 1
    slot = archive.free[archive.counts[1]]
    archive.points[begin, 0], archive.points[begin, 1] = point
    archive.slots[begin] = slot
    archive.tries[slot] = 0
    return slot


@compiled
def insert(archive: Archive, point: tuple[float, float], tour: Cities) -> bool:
    """Insert a tour unless it is dominated or equalled, and drop those that it dominates.

    Returns whether it was inserted. A full archive is thinned first. O(m + n).
    """
    first, second = point
    if not accepts(archive, first, second):
        return False
    if archive.counts[1] == 0:
        thin(archive)
    begin = count_up_to(archive, first)
    while begin > 0 and archive.points[begin - 1, 0] >= first:
        begin -= 1
    end = begin
    while end < archive.counts[0] and archive.points[end, 1] >= second:
        end += 1
    slot = replace(archive, begin, end, point)
    for k in range(len(tour)):
        archive.tours[slot, k] = tour[k]
    return True


@allocating
def thin(archive: Archive) -> None:
    """Drop points among the third that contribute least hypervolume, never two neighbours.

    Both ends stay. O(m).
    """
    size = archive.counts[0]
    contribution, reordered = np.empty(size), np.empty(size)
    contribution[0] = contribution[-1] = reordered[0] = reordered[-1] = np.inf
    for k in range(1, size - 1):
        width = archive.points[k + 1, 0] - archive.points[k, 0]
        contribution[k] = width * (archive.points[k - 1, 1] - archive.points[k, 1])
        reordered[k] = contribution[k]
    limit = select(reordered, size // 3)
    left = 0
    dropped = False
    for k in range(size):
        dropped = not dropped and contribution[k] <= limit
        if dropped:
            archive.free[archive.counts[1]] = archive.slots[k]
            archive.counts[1] += 1
        else:
            copy_point(archive, k, left)
            left += 1
    archive.counts[0] = left


@compiled
def best_point(archive: Archive, w0: float, w1: float) -> int:
    """Return the index of the point with the least weighted sum, the first of equal ones."""
    least, index = np.inf, 0
    for k in range(archive.counts[0]):
        value = w0 * archive.points[k, 0] + w1 * archive.points[k, 1]
        if value < least:
            least, index = value, k
    return index


@compiled
def dominated_area(archive: Archive, first: float, second: float) -> float:
    """Return the area dominated up to the reference point (first, second). O(m)."""
    total = 0.0
    ceiling = second
    for k in range(archive.counts[0]):
        width = first - archive.points[k, 0]
        if width <= 0:
            break
        total += width * max(0.0, ceiling - archive.points[k, 1])
        ceiling = min(ceiling, archive.points[k, 1])
    return total
