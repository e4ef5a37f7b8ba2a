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
    counts: Numbers  # (2,): points chosen; cells in the heap
    sweep: Sweep  # scratch space


def make_choice(shares: Array, cells: Cells, size: int) -> Choice:
    """Return a choice of no points yet, and of up to `size` later."""
    gains = (1 - shares[cells.firsts]).prod(axis=1)
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
        np.array([0, len(gains)]),
        make_sweep(size, shares.shape[1]),
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
    place, last = counts[0], choice.shares.shape[1] - 1
    while place > 0 and choice.shares[choice.chosen[place - 1], last] > choice.shares[point, last]:
        choice.chosen[place] = choice.chosen[place - 1]
        place -= 1
    choice.chosen[place] = point
    counts[0] += 1


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
    choice.taken[choice.members[at]] = True
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


@compiled
def added_volume(choice: Choice, point: int) -> float:
    """Return by how much a point would increase the hypervolume of those chosen.

    These are ascending by the last length. Each covers a part of the box of the point: the box of
    the point whose lengths are the greater ones of the two points.
    """
    shares, sweep, count = choice.shares, choice.sweep, choice.counts[0]
    box, objectives = 1.0, shares.shape[1]
    for m in range(objectives):
        box *= 1.0 - shares[point, m]
    for j in range(count):
        for m in range(objectives):
            sweep.points[j, m] = max(shares[choice.chosen[j], m], shares[point, m])
    return box - volume_of(sweep, count)
