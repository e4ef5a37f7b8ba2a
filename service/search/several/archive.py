"""The archive of three and four objectives: all nondominated tours found so far, in blocks.

Points cannot be sorted so that a look at two of them says whether they dominate another. Instead
they lie in blocks of neighbours, and each block has a box around its points. Most blocks are passed
by after a look at the box: only where its least corner is no worse than a new point can one of its
points dominate that. So a new point is compared with a few dozen of thousands (Jaszkiewicz and
Lust, 2018, have a whole tree of such boxes).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.archive import MAX_BYTES, MAX_POINTS, ROUNDING
from service.search.selection import select

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

WIDTH = 32  # points of a block at most; when one more comes, it is split


class BlockArchive(NamedTuple):
    """Points with their tours by row, and the rows of each block.

    Memory is reserved but not touched before it is needed, and rows that become free are reused.
    """

    points: Array  # (capacity, m), by row, in the unit of make_costs()
    tours: Cities  # (capacity, n), by row
    tries: Cities  # (capacity,), by row: how often a search has started from the tour
    free: Cities  # (capacity,), a stack of unused rows
    rows: Cities  # (capacity, WIDTH), by block: the rows of its points
    sizes: Cities  # (capacity,), by block: the number of its points
    lows: Array  # (capacity, m), by block: the least of each length
    highs: Array  # (capacity, m), by block: the greatest of each length
    lengths: Array  # (m,), scratch space for those of a tour that is offered
    counts: NDArray[
        np.int64
    ]  # (5,): points, unused rows, ever inserted, blocks, the last to refuse


def make_archive(n: int, objectives: int, capacity: int = MAX_POINTS) -> BlockArchive:
    """Return an empty archive for tours of n cities."""
    capacity = max(16, min(capacity, MAX_BYTES // (4 * n)))
    return BlockArchive(
        np.empty((capacity, objectives)),
        np.empty((capacity, n), np.int32),
        np.empty(capacity, np.int32),
        np.arange(capacity - 1, -1, -1, dtype=np.int32),
        np.empty((capacity, WIDTH), np.int32),
        np.empty(capacity, np.int32),
        np.empty((capacity, objectives)),
        np.empty((capacity, objectives)),
        np.empty(objectives),
        np.array([0, capacity, 0, 0, 0], np.int64),
    )


def rows_of(archive: BlockArchive) -> NDArray[np.int32]:
    """Return the rows of all points, by ascending first length, then second and so on."""
    used = np.arange(WIDTH) < archive.sizes[: archive.counts[3], np.newaxis]
    rows: NDArray[np.int32] = archive.rows[: archive.counts[3]][used]
    return rows[np.lexsort(archive.points[rows].T[::-1])]


@inlined
def at_most(a: Array, row: int, b: Array, slack: float) -> bool:
    """Return whether row `row` of a is nowhere above b, but for rounding."""
    below = True
    for m in range(a.shape[1]):
        below &= a[row, m] <= b[m] * slack
    return below


@inlined
def at_least(a: Array, row: int, b: Array) -> bool:
    """Return whether row `row` of a is nowhere below b."""
    above = True
    for m in range(a.shape[1]):
        above &= a[row, m] >= b[m]
    return above


@inlined
def refuses(archive: BlockArchive, block: int, point: Array, slack: float) -> bool:
    """Return whether a point of a block dominates or equals the given one, but for rounding."""
    if not at_most(archive.lows, block, point, slack):
        return False
    for k in range(archive.sizes[block]):
        if at_most(archive.points, archive.rows[block, k], point, slack):
            return True
    return False


@compiled
def accepts(archive: BlockArchive, point: Array) -> bool:
    """Return whether no point dominates or equals the given one, but for rounding.

    The block that refused the last point is asked first: the next is often refused by it as well.
    """
    slack = 1 + ROUNDING * archive.tours.shape[1]
    counts = archive.counts
    if counts[4] < counts[3] and refuses(archive, counts[4], point, slack):
        return False
    for block in range(counts[3]):
        if refuses(archive, block, point, slack):
            counts[4] = block
            return False
    return True


@compiled
def insert(archive: BlockArchive, point: Array, tour: Cities) -> bool:
    """Insert a tour unless it is dominated or equalled, and drop those that it dominates.

    Returns whether it was inserted. A full archive is thinned first.
    """
    if not accepts(archive, point):
        return False
    drop_dominated(archive, point)
    if archive.counts[1] == 0:
        thin(archive)
    archive.counts[1] -= 1
    row = archive.free[archive.counts[1]]
    for m in range(len(point)):
        archive.points[row, m] = point[m]
    for k in range(len(tour)):
        archive.tours[row, k] = tour[k]
    archive.tries[row] = 0
    place_row(archive, row)
    archive.counts[0] += 1
    archive.counts[2] += 1
    return True


@inlined
def drop_dominated(archive: BlockArchive, point: Array) -> None:
    """Drop the points that a new one dominates."""
    for block in range(archive.counts[3] - 1, -1, -1):
        if not at_least(archive.highs, block, point):
            continue
        left = 0
        for k in range(archive.sizes[block]):
            row = archive.rows[block, k]
            if at_least(archive.points, row, point):
                free_row(archive, row)
            else:
                archive.rows[block, left] = row
                left += 1
        shrink(archive, block, left)


@inlined
def free_row(archive: BlockArchive, row: int) -> None:
    """Give a row back whose point is dropped."""
    archive.free[archive.counts[1]] = row
    archive.counts[1] += 1
    archive.counts[0] -= 1


@inlined
def shrink(archive: BlockArchive, block: int, size: int) -> None:
    """Leave a block its first `size` rows; where there are none, the last block takes its place."""
    if size == archive.sizes[block]:
        return
    archive.sizes[block] = size
    if size > 0:
        draw_box(archive, block)
        return
    archive.counts[3] -= 1
    last = archive.counts[3]
    if last != block:
        archive.sizes[block] = archive.sizes[last]
        for k in range(archive.sizes[last]):
            archive.rows[block, k] = archive.rows[last, k]
        draw_box(archive, block)


@inlined
def draw_box(archive: BlockArchive, block: int) -> None:
    """Set the box of a block to that of its points."""
    for m in range(archive.points.shape[1]):
        low = high = archive.points[archive.rows[block, 0], m]
        for k in range(1, archive.sizes[block]):
            value = archive.points[archive.rows[block, k], m]
            low, high = min(low, value), max(high, value)
        archive.lows[block, m], archive.highs[block, m] = low, high


@compiled
def place_row(archive: BlockArchive, row: int) -> None:
    """Put a row into the block whose box grows least by it, which is split where it is full."""
    if archive.counts[3] == 0:
        archive.counts[3] = 1
        archive.sizes[0] = 0
        add_row(archive, 0, row)
        return
    least, block = np.inf, 0
    for other in range(archive.counts[3]):
        grown = growth(archive, other, row)
        if grown < least:
            least, block = grown, other
            if grown == 0.0:
                break
    if archive.sizes[block] == WIDTH:
        added = split(archive, block)
        if growth(archive, added, row) < growth(archive, block, row):
            block = added
    add_row(archive, block, row)


@inlined
def growth(archive: BlockArchive, block: int, row: int) -> float:
    """Return by how much the sides of a block's box would grow in all by the point of a row."""
    grown = 0.0
    for m in range(archive.points.shape[1]):
        value = archive.points[row, m]
        grown += max(0.0, archive.lows[block, m] - value)
        grown += max(0.0, value - archive.highs[block, m])
    return grown


@inlined
def add_row(archive: BlockArchive, block: int, row: int) -> None:
    """Add a row to a block that has room for it."""
    archive.rows[block, archive.sizes[block]] = row
    archive.sizes[block] += 1
    draw_box(archive, block)


@compiled
def split(archive: BlockArchive, block: int) -> int:
    """Move the upper half of a block, along the longest side of its box, to a new one."""
    longest, axis = -1.0, 0
    for m in range(archive.points.shape[1]):
        side = archive.highs[block, m] - archive.lows[block, m]
        if side > longest:
            longest, axis = side, m
    for k in range(1, archive.sizes[block]):
        row, place = archive.rows[block, k], k
        value = archive.points[row, axis]
        while place > 0 and archive.points[archive.rows[block, place - 1], axis] > value:
            archive.rows[block, place] = archive.rows[block, place - 1]
            place -= 1
        archive.rows[block, place] = row
    added = archive.counts[3]
    archive.counts[3] += 1
    half = archive.sizes[block] // 2
    archive.sizes[added] = archive.sizes[block] - half
    for k in range(archive.sizes[added]):
        archive.rows[added, k] = archive.rows[block, half + k]
    archive.sizes[block] = half
    draw_box(archive, block)
    draw_box(archive, added)
    return added


@compiled
def nearest_in_block(archive: BlockArchive, block: int, place: int) -> float:
    """Return how far a point is from the nearest other one in its block, infinite without one."""
    row, least = archive.rows[block, place], np.inf
    for k in range(archive.sizes[block]):
        if k == place:
            continue
        distance = 0.0
        for m in range(archive.points.shape[1]):
            distance += abs(archive.points[row, m] - archive.points[archive.rows[block, k], m])
        least = min(least, distance)
    return least


@allocating
def thin(archive: BlockArchive) -> None:
    """Drop points among the third that is nearest to another one, never two in a row.

    What is least under an objective stays.
    """
    size, objectives = archive.counts[0], archive.points.shape[1]
    distances = np.empty((archive.counts[3], WIDTH))
    gathered, count = np.empty(size), 0
    least = np.full(objectives, np.inf)
    for block in range(archive.counts[3]):
        for k in range(archive.sizes[block]):
            distances[block, k] = gathered[count] = nearest_in_block(archive, block, k)
            count += 1
        for m in range(objectives):
            least[m] = min(least[m], archive.lows[block, m])
    limit = select(gathered, size // 3)
    for block in range(archive.counts[3] - 1, -1, -1):
        left, dropped = 0, False
        for k in range(archive.sizes[block]):
            row = archive.rows[block, k]
            extreme = False
            for m in range(objectives):
                extreme = extreme or archive.points[row, m] == least[m]
            dropped = not dropped and not extreme and distances[block, k] <= limit
            if dropped:
                free_row(archive, row)
            else:
                archive.rows[block, left] = row
                left += 1
        shrink(archive, block, left)


@compiled
def best_row(archive: BlockArchive, weights: Array) -> int:
    """Return the row of the point with the least weighted sum; -1 where there is no point."""
    least, best = np.inf, -1
    for block in range(archive.counts[3]):
        for k in range(archive.sizes[block]):
            row = archive.rows[block, k]
            value = weighted_sum(archive, row, weights)
            if value < least:
                least, best = value, row
    return best


@inlined
def weighted_sum(archive: BlockArchive, row: int, weights: Array) -> float:
    """Return the weighted sum of a row's point."""
    value = 0.0
    for m in range(len(weights)):
        value += weights[m] * archive.points[row, m]
    return value
