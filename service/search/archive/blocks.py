"""Archives of three and four objectives: blocks of up to WIDTH neighbours, with a box around each.

Points cannot be sorted so that a look at two of them says whether they dominate another. Most
blocks are passed by after a look at the box: its points can dominate a new point only if its least
corner is as good or better in each objective. So a new point is compared with a few dozen points of
thousands (Jaszkiewicz and Lust, 2018, have a whole tree of such boxes).
"""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined, standalone
from service.search.archive.layout import WIDTH, Archive, free_row, slack_of, take_row
from service.search.selection import select

Array = NDArray[np.float64]
Cities = NDArray[np.int32]


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
def refuses(archive: Archive, block: int, point: Array, slack: float) -> bool:
    """Return whether a point of a block dominates or equals the given one, but for rounding."""
    if not at_most(archive.lows, block, point, slack):
        return False
    for k in range(archive.sizes[block]):
        if at_most(archive.points, archive.rows[block, k], point, slack):
            return True
    return False


@compiled
def accepts(archive: Archive, point: Array) -> bool:
    """Return whether no point dominates or equals the given one, but for rounding.

    The block that refused the last point is asked first: the next is often refused by it as well.
    """
    slack = slack_of(archive)
    counts = archive.counts
    if counts[4] < counts[3] and refuses(archive, counts[4], point, slack):
        return False
    for block in range(counts[3]):
        if refuses(archive, block, point, slack):
            counts[4] = block
            return False
    return True


@compiled
def insert(archive: Archive, point: Array, tour: Cities) -> bool:
    """Insert a tour unless it is dominated or equalled; return whether it was inserted."""
    if not accepts(archive, point):
        return False
    insert_accepted(archive, point, tour)
    return True


@standalone
def insert_accepted(archive: Archive, point: Array, tour: Cities) -> None:
    """Insert a tour, and drop those that it dominates."""
    drop_dominated(archive, point)
    if archive.counts[1] == 0:
        thin(archive)
    place_row(archive, take_row(archive, point, tour))


@inlined
def drop_dominated(archive: Archive, point: Array) -> None:
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
def shrink(archive: Archive, block: int, size: int) -> None:
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
def draw_box(archive: Archive, block: int) -> None:
    """Set the box of a block to that of its points."""
    for m in range(archive.points.shape[1]):
        low = high = archive.points[archive.rows[block, 0], m]
        for k in range(1, archive.sizes[block]):
            value = archive.points[archive.rows[block, k], m]
            low, high = min(low, value), max(high, value)
        archive.lows[block, m], archive.highs[block, m] = low, high


@compiled
def place_row(archive: Archive, row: int) -> None:
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
def growth(archive: Archive, block: int, row: int) -> float:
    """Return by how much the sides of a block's box would grow in all by the point of a row."""
    grown = 0.0
    for m in range(archive.points.shape[1]):
        value = archive.points[row, m]
        grown += max(0.0, archive.lows[block, m] - value)
        grown += max(0.0, value - archive.highs[block, m])
    return grown


@inlined
def add_row(archive: Archive, block: int, row: int) -> None:
    """Add a row to a block that has room for it."""
    archive.rows[block, archive.sizes[block]] = row
    archive.sizes[block] += 1
    draw_box(archive, block)


@compiled
def split(archive: Archive, block: int) -> int:
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
def nearest_in_block(archive: Archive, block: int, place: int) -> float:
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
def thin(archive: Archive) -> None:
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
