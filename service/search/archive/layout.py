"""The arrays of an archive, and what is read from them whatever the number of objectives."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import by_reference, compiled, inlined
from service.objectives import OBJECTIVES

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

MAX_POINTS = 50_000
MAX_BYTES = 2**28  # of tours
ROUNDING = 2.0**-52  # relative: as much as two sums of the same steps may differ for each step
WIDTH = 32  # points of a block at most, of more than two objectives


@by_reference
class Archive(NamedTuple):
    """Points with their tours by row, and blocks of rows whose points are neighbours.

    Of two objectives a block is one point. Blocks are by ascending first length then, and so by
    descending second length. Memory is reserved but not touched before it is needed, and rows that
    become free are reused first.
    """

    points: Array  # (capacity, m), by row, in the unit of make_costs()
    tours: Cities  # (capacity, n), by row
    tries: Cities  # (capacity,), by row: how often a search has started from the tour
    free: Cities  # (capacity,), a stack of unused rows
    rows: Cities  # (capacity, WIDTH), by block: the rows of its points; (capacity, 1) if sorted
    sizes: Cities  # (capacity,), by block: the number of its points
    lows: Array  # (capacity, m), by block: the least of each length
    highs: Array  # (capacity, m), by block: the greatest of each length; unused if sorted
    lengths: Array  # (m,), scratch space for those of a tour that is offered
    counts: NDArray[np.int64]  # (5,): points, unused rows, ever inserted, blocks, last to refuse


def make_archive(n: int, objectives: int, capacity: int = MAX_POINTS) -> Archive:
    """Return an empty archive for tours of n cities."""
    capacity = max(16, min(capacity, MAX_BYTES // (4 * n)))
    return Archive(
        np.empty((capacity, objectives)),
        np.empty((capacity, n), np.int32),
        np.empty(capacity, np.int32),
        np.arange(capacity - 1, -1, -1, dtype=np.int32),
        np.empty((capacity, 1 if objectives == OBJECTIVES else WIDTH), np.int32),
        np.ones(capacity, np.int32),
        np.empty((capacity, objectives)),
        np.empty((capacity, objectives)),
        np.empty(objectives),
        np.array([0, capacity, 0, 0, 0], np.int64),
    )


def rows_of(archive: Archive) -> NDArray[np.int32]:
    """Return the rows of all points, by ascending first length, then second and so on."""
    used = np.arange(archive.rows.shape[1]) < archive.sizes[: archive.counts[3], np.newaxis]
    rows: NDArray[np.int32] = archive.rows[: archive.counts[3]][used]
    if archive.rows.shape[1] == 1:
        return rows
    return rows[np.lexsort(archive.points[rows].T[::-1])]


@inlined
def is_sorted(archive: Archive) -> bool:
    """Return whether the points are sorted by their first length, as those of two objectives."""
    return archive.rows.shape[1] == 1


@inlined
def slack_of(archive: Archive) -> float:
    """Return what a length may be multiplied by, for rounding."""
    return 1 + ROUNDING * archive.tours.shape[1]


@inlined
def take_row(archive: Archive, point: Array, tour: Cities) -> int:
    """Return an unused row, in which a point and its tour are now."""
    archive.counts[0] += 1
    archive.counts[1] -= 1
    archive.counts[2] += 1
    row = archive.free[archive.counts[1]]
    for m in range(len(point)):
        archive.points[row, m] = point[m]
    for k in range(len(tour)):
        archive.tours[row, k] = tour[k]
    archive.tries[row] = 0
    return row


@inlined
def free_row(archive: Archive, row: int) -> None:
    """Give a row back whose point is dropped."""
    archive.free[archive.counts[1]] = row
    archive.counts[1] += 1
    archive.counts[0] -= 1


@compiled
def best_row(archive: Archive, weights: Array) -> int:
    """Return the row of the point with the least weighted sum, the first; -1 without a point."""
    least, best = np.inf, -1
    for block in range(archive.counts[3]):
        for k in range(archive.sizes[block]):
            row = archive.rows[block, k]
            value = weighted_sum(archive, row, weights)
            if value < least:
                least, best = value, row
    return best


@inlined
def weighted_sum(archive: Archive, row: int, weights: Array) -> float:
    """Return the weighted sum of a row's point."""
    value = 0.0
    for m in range(len(weights)):
        value += weights[m] * archive.points[row, m]
    return value
