"""Choose points of a front of several objectives by the hypervolume that each adds.

One point after another is chosen, each time that which adds most. What a point adds can only fall
as more are chosen. So cells of points lie in a heap by what the best of their points added when it
was last looked at, and only those that rise to its top are looked at again (Minoux, 1978). Where
there is a cell for each point, no other point would add more than the one that is chosen.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined
from service.search.several.volume import Sweep, make_sweep, volume_of
from service.search.thinning import Cells

MOST_COMPARED = 8  # points of a cell, to find the one of them that adds most
_MANY = 64  # points chosen, from which on it pays to drop boxes that others contain
_FEW = 8  # boxes: with so few or fewer, dropping them does not pay

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


class Choice(NamedTuple):
    """A choice of points that grows."""

    shares: Array  # (k, m), all below 1
    members: Numbers  # (k,): the points of the cells, one cell after another
    starts: Numbers  # (c + 1,): where each cell begins in `members`, and the end
    best: Numbers  # (c,), by cell: where the point is in `members` that added most
    gains: Array  # (c,), by cell: what that point adds at most
    looked_at: Numbers  # (c,), by cell: how many points were chosen when its gain was computed
    heap: Numbers  # (c,): cells, a heap by `gains`
    taken: NDArray[np.bool_]  # (k,): which points are chosen
    chosen: Numbers  # (size,): ascending by the last length
    lengths: Array  # (m, size): of those chosen
    counts: Numbers  # (2,): points chosen; cells in the heap
    corners: Array  # (m, size), scratch space: the corners of boxes
    volumes: Array  # (size,), scratch space: their volumes
    sweep: Sweep  # scratch space


def make_choice(shares: Array, cells: Cells, size: int) -> Choice:
    """Return a choice of no points yet, and of up to `size` later."""
    gains, objectives = (1 - shares[cells.firsts]).prod(axis=1), shares.shape[1]
    return Choice(
        shares,
        cells.members.astype(np.int64),
        cells.starts.astype(np.int64),
        cells.starts[:-1].astype(np.int64),
        gains,
        np.full(len(gains), -1),
        np.argsort(-gains, kind="stable"),
        np.zeros(len(shares), np.bool_),
        np.empty(size, np.int64),
        np.empty((objectives, size)),
        np.array([0, len(gains)]),
        np.empty((objectives, size)),
        np.empty(size),
        make_sweep(size, objectives),
    )


@compiled
def choose_next(choice: Choice) -> None:
    """Choose one more point: of the cell whose best point adds most, that which adds most."""
    heap, counts = choice.heap, choice.counts
    while choice.looked_at[heap[0]] != counts[0]:
        cell = heap[0]
        point = choice.members[choice.best[cell]]
        choice.gains[cell] = max(0.0, added_volume(choice, point))
        choice.looked_at[cell] = counts[0]
        sink(choice)
    point = take_best(choice, heap[0])
    if choice.gains[heap[0]] < 0.0:
        counts[1] -= 1
        heap[0] = heap[counts[1]]
    sink(choice)
    keep_chosen(choice, point)


@inlined
def take_best(choice: Choice, cell: int) -> int:
    """Take the point of a cell that adds most, and return it.

    The cell's gain becomes that of its second best point, or -1 where it has none.
    """
    first, second, at, after = -1.0, -1.0, -1, -1
    begin, end = choice.starts[cell], choice.starts[cell + 1]
    for place in range(begin, min(end, begin + MOST_COMPARED)):
        point = choice.members[place]
        if choice.taken[point]:
            continue
        gain = choice.gains[cell]
        if place != choice.best[cell]:
            gain = max(0.0, added_volume(choice, point))
        if gain > first:
            second, after = first, at
            first, at = gain, place
        elif gain > second:
            second, after = gain, place
    choice.gains[cell], choice.best[cell], choice.looked_at[cell] = second, after, -1
    return choice.members[at]


@inlined
def sink(choice: Choice) -> None:
    """Move the first cell down the heap, to where none below it has a larger gain."""
    heap, gains, size = choice.heap, choice.gains, choice.counts[1]
    moved, place = heap[0], 0
    while 2 * place + 1 < size:
        child = 2 * place + 1
        if child + 1 < size and gains[heap[child + 1]] > gains[heap[child]]:
            child += 1
        if gains[heap[child]] <= gains[moved]:
            break
        heap[place] = heap[child]
        place = child
    heap[place] = moved


@inlined
def keep_chosen(choice: Choice, point: int) -> None:
    """Add a point to those chosen, which are ascending by the last length."""
    choice.taken[point] = True
    chosen, lengths, place = choice.chosen, choice.lengths, choice.counts[0]
    objectives = len(lengths)
    while place > 0 and lengths[objectives - 1, place - 1] > choice.shares[point, objectives - 1]:
        chosen[place] = chosen[place - 1]
        for m in range(objectives):
            lengths[m, place] = lengths[m, place - 1]
        place -= 1
    chosen[place] = point
    for m in range(objectives):
        lengths[m, place] = choice.shares[point, m]
    choice.counts[0] += 1


@inlined
def drop_chosen(choice: Choice, place: int) -> int:
    """Take back the choice at this place of those chosen, and return the point."""
    chosen, lengths = choice.chosen, choice.lengths
    point = chosen[place]
    choice.counts[0] -= 1
    for after in range(place, choice.counts[0]):
        chosen[after] = chosen[after + 1]
        for m in range(len(lengths)):
            lengths[m, after] = lengths[m, after + 1]
    choice.taken[point] = False
    return point


@inlined
def added_volume(choice: Choice, point: int) -> float:
    """Return by how much a point would increase the hypervolume of those chosen.

    Each of these covers a part of the box of the point: the box of the point whose lengths are the
    greater ones of the two points.
    """
    count, shares, own = choice.counts[0], choice.shares, 1.0
    for m in range(shares.shape[1]):
        own *= 1.0 - shares[point, m]
    if count < _MANY:
        return own - volume_covered(choice.sweep, shares, choice.chosen, count, point)
    return own - volume_covered_by_many(
        choice.sweep, choice.corners, choice.volumes, choice.lengths, count, shares[point]
    )


@compiled
def volume_covered(sweep: Sweep, shares: Array, chosen: Numbers, count: int, point: int) -> float:
    """Return the volume of the part of the box of a point that the chosen points cover."""
    for j in range(count):
        for m in range(shares.shape[1]):
            sweep.points[j, m] = max(shares[chosen[j], m], shares[point, m])
    return volume_of(sweep, count)


@compiled
def volume_covered_by_many(
    sweep: Sweep, corners: Array, volumes: Array, lengths: Array, count: int, point: Array
) -> float:
    """Return the same where it pays to drop boxes first: a few large ones contain nearly all."""
    for j in range(count):
        volumes[j] = 1.0
    for m in range(len(corners)):
        for j in range(count):
            corners[m, j] = max(lengths[m, j], point[m])
            volumes[j] *= 1.0 - corners[m, j]
    left = drop_contained(corners, volumes, count)
    for j in range(left):
        for m in range(len(corners)):
            sweep.points[j, m] = corners[m, j]
    return volume_of(sweep, left)


@inlined
def drop_contained(corners: Array, volumes: Array, count: int) -> int:
    """Drop boxes that the largest ones contain, until few are left; return how many are.

    The others move up, in their order.
    """
    before = np.inf
    while count > _FEW:
        largest, volume = -1, -1.0
        for j in range(count):
            if volume < volumes[j] < before:
                largest, volume = j, volumes[j]
        if largest < 0:
            break
        before = volume
        count = drop_contained_in(largest, corners, volumes, count)
    return count


@inlined
def drop_contained_in(largest: int, corners: Array, volumes: Array, count: int) -> int:
    """Drop all boxes that one of them contains, but itself; return how many are left."""
    last, left = len(corners) - 1, 0
    a, b, c = corners[0, largest], corners[1, largest], corners[2, largest]
    d = corners[last, largest]
    for j in range(count):
        # Without a branch, which could not be predicted.
        reaches = (corners[0, j] < a) | (corners[1, j] < b) | (corners[2, j] < c)
        reaches = reaches | (corners[last, j] < d) | (j == largest)
        for m in range(len(corners)):
            corners[m, left] = corners[m, j]
        volumes[left] = volumes[j]
        left += reaches
    return left
