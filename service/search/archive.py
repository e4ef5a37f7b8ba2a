"""All the nondominated tours found so far, sorted by their first length."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

MOST_POINTS = 50_000
MOST_BYTES = 2**28
TOLERANCE = 1e-12  # lengths nearer to one another than this share are held to be equal


class Archive(NamedTuple):
    """Points by ascending first length, so by descending second length, and their tours.

    Point k belongs to the tour in row slots[k] of tours. Memory for tours is reserved but not
    touched before it is needed, and rows that become free are used again first.
    """

    points: Array  # (most, 2)
    slots: Cities  # (most,)
    tours: Cities  # (most, n)
    free: Cities  # (most,), a stack
    tries: Cities  # (most,), by row: how often the search has set out from the tour
    counts: NDArray[np.int64]  # (3,): points, free rows, tours ever admitted


def make_archive(n: int, most: int = MOST_POINTS) -> Archive:
    """An empty archive for tours of n cities."""
    most = max(16, min(most, MOST_BYTES // (4 * n)))
    return Archive(
        np.empty((most, 2)),
        np.empty(most, np.int32),
        np.empty((most, n), np.int32),
        np.arange(most - 1, -1, -1, dtype=np.int32),
        np.empty(most, np.int32),
        np.array([0, most, 0], np.int64),
    )


@inlined
def above(archive: Archive, bound: float) -> int:
    """How many points have a first length of at most the bound."""
    low, high = 0, archive.counts[0]
    while low < high:
        middle = (low + high) >> 1
        if archive.points[middle, 0] <= bound:
            low = middle + 1
        else:
            high = middle
    return low


@inlined
def accepts(archive: Archive, first: float, second: float) -> bool:
    """Whether no point is as good in both lengths."""
    k = above(archive, first * (1 + TOLERANCE))
    return k == 0 or archive.points[k - 1, 1] > second * (1 + TOLERANCE)


@inlined
def move_point(archive: Archive, source: int, target: int) -> None:
    """Copies one point to another place."""
    archive.points[target, 0] = archive.points[source, 0]
    archive.points[target, 1] = archive.points[source, 1]
    archive.slots[target] = archive.slots[source]


@compiled
def replace(archive: Archive, begin: int, end: int, point: tuple[float, float]) -> int:
    """Puts one point where those from begin to end were, and gives the row for its tour."""
    size = archive.counts[0]
    for k in range(begin, end):
        archive.free[archive.counts[1]] = archive.slots[k]
        archive.counts[1] += 1
    shift = 1 - (end - begin)
    if shift > 0:
        for k in range(size - 1, end - 1, -1):
            move_point(archive, k, k + 1)
    elif shift < 0:
        for k in range(end, size):
            move_point(archive, k, k + shift)
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
    """Keeps a tour if it is nondominated, drops those it dominates, and says whether it stays."""
    first, second = point
    if not accepts(archive, first, second):
        return False
    if archive.counts[1] == 0:
        thin(archive)
    begin = above(archive, first)
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
    """Makes room: of the third that adds least hypervolume, drops what has no dropped neighbour."""
    size = archive.counts[0]
    added = np.empty(size)
    added[0] = added[-1] = np.inf
    for k in range(1, size - 1):
        width = archive.points[k + 1, 0] - archive.points[k, 0]
        added[k] = width * (archive.points[k - 1, 1] - archive.points[k, 1])
    limit = np.sort(added)[size // 3]
    kept = 0
    dropped = False
    for k in range(size):
        dropped = not dropped and added[k] <= limit
        if dropped:
            archive.free[archive.counts[1]] = archive.slots[k]
            archive.counts[1] += 1
        else:
            move_point(archive, k, kept)
            kept += 1
    archive.counts[0] = kept


@compiled
def best(archive: Archive, w0: float, w1: float) -> int:
    """Which point has the least weighted sum."""
    least, found = np.inf, 0
    for k in range(archive.counts[0]):
        value = w0 * archive.points[k, 0] + w1 * archive.points[k, 1]
        if value < least:
            least, found = value, k
    return found


@compiled
def area(archive: Archive, first: float, second: float) -> float:
    """The hypervolume up to a reference point, as an area."""
    total = 0.0
    ceiling = second
    for k in range(archive.counts[0]):
        width = first - archive.points[k, 0]
        if width <= 0:
            break
        total += width * max(0.0, ceiling - archive.points[k, 1])
        ceiling = min(ceiling, archive.points[k, 1])
    return total
