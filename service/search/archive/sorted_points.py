"""Archives of two objectives: blocks of one point each, sorted by the first length.

So two points say whether any dominates a new one, and those that this one dominates lie together.
"""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.archive.layout import Archive, free_row, slack_of, take_row
from service.search.selection import select

Array = NDArray[np.float64]
Cities = NDArray[np.int32]


@inlined
def count_up_to(archive: Archive, bound: float) -> int:
    """Return how many points have a first length of at most `bound`. O(log k)."""
    low, high = 0, archive.counts[3]
    while low < high:
        middle = (low + high) >> 1
        if archive.lows[middle, 0] <= bound:
            low = middle + 1
        else:
            high = middle
    return low


@compiled
def accepts(archive: Archive, point: Array) -> bool:
    """Return whether no point dominates or equals the given one, but for rounding. O(log k)."""
    slack = slack_of(archive)
    k = count_up_to(archive, point[0] * slack)
    return k == 0 or archive.lows[k - 1, 1] > point[1] * slack


@inlined
def copy_block(archive: Archive, source: int, target: int) -> None:
    """Copy a block from one place to another."""
    archive.lows[target, 0] = archive.lows[source, 0]
    archive.lows[target, 1] = archive.lows[source, 1]
    archive.rows[target, 0] = archive.rows[source, 0]


@compiled
def make_room(archive: Archive, begin: int, end: int) -> None:
    """Drop the points begin to end - 1, and leave one place for a new one there."""
    size = archive.counts[3]
    for k in range(begin, end):
        free_row(archive, archive.rows[k, 0])
    shift = 1 - (end - begin)
    if shift > 0:
        for k in range(size - 1, end - 1, -1):
            copy_block(archive, k, k + 1)
    elif shift < 0:
        for k in range(end, size):
            copy_block(archive, k, k + shift)
    archive.counts[3] = size + shift


@compiled
def insert(archive: Archive, point: Array, tour: Cities) -> bool:
    """Insert a tour unless it is dominated or equalled; return whether it was. O(k + n)."""
    if not accepts(archive, point):
        return False
    if archive.counts[1] == 0:
        thin(archive)
    begin = count_up_to(archive, point[0])
    while begin > 0 and archive.lows[begin - 1, 0] >= point[0]:
        begin -= 1
    end = begin
    while end < archive.counts[3] and archive.lows[end, 1] >= point[1]:
        end += 1
    make_room(archive, begin, end)
    archive.rows[begin, 0] = take_row(archive, point, tour)
    archive.lows[begin, 0], archive.lows[begin, 1] = point[0], point[1]
    return True


@allocating
def thin(archive: Archive) -> None:
    """Drop points among the third that contribute least hypervolume, never two neighbours.

    Both ends stay. O(k).
    """
    size, lows = archive.counts[3], archive.lows
    contribution, reordered = np.empty(size), np.empty(size)
    contribution[0] = contribution[-1] = reordered[0] = reordered[-1] = np.inf
    for k in range(1, size - 1):
        contribution[k] = (lows[k + 1, 0] - lows[k, 0]) * (lows[k - 1, 1] - lows[k, 1])
        reordered[k] = contribution[k]
    limit = select(reordered, size // 3)
    left = 0
    dropped = False
    for k in range(size):
        dropped = not dropped and contribution[k] <= limit
        if dropped:
            free_row(archive, archive.rows[k, 0])
        else:
            copy_block(archive, k, left)
            left += 1
    archive.counts[3] = left


@compiled
def dominated_area(archive: Archive, reference_point: Array) -> float:
    """Return the area that the points dominate up to the reference point. O(k)."""
    total = 0.0
    ceiling = reference_point[1]
    for k in range(archive.counts[3]):
        width = reference_point[0] - archive.lows[k, 0]
        if width <= 0:
            break
        total += width * max(0.0, ceiling - archive.lows[k, 1])
        ceiling = min(ceiling, archive.lows[k, 1])
    return total
