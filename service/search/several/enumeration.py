"""The exact front of a few cities under three or four objectives: all tours are compared."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import compiled, inlined
from service.search.archive import ROUNDING
from service.search.closing import opened_tours
from service.search.costs import Costs, make_costs, sum_lengths
from service.search.several.archive import BlockArchive, insert, make_archive, rows_of
from service.watch import Watch

Cities = NDArray[np.int32]

BLOCK = 500  # tours between two checks of the deadline, a fraction of a ms
ANY = -1  # no fixed end


def exact_tours_of_several(instance: Instance, watch: Watch[Any]) -> tuple[Cities, bool]:
    """Return a tour for every point of the front of up to nine cities, and True.

    Where time runs out first, return those found so far, one at least, and False.
    """
    costs = make_costs(instance)
    n = len(costs.cities)
    archive = make_archive(n, instance.objectives)
    order = np.arange(n, dtype=np.int32)
    ends = np.array([ANY if end is None else 1 + end for end in (instance.start, instance.end)])
    complete, left = True, True
    while left:
        left = insert_some(costs, archive, order, ends, BLOCK)
        if left and watch.ended() and archive.counts[0] > 0:
            complete = False
            break
    rows = rows_of(archive)
    distinct = np.ones(len(rows), np.bool_)
    mark_distinct(archive.points[rows], 1 + ROUNDING * n, distinct)
    return opened_tours(instance, archive.tours[rows[distinct]]), complete


@compiled
def mark_distinct(points: NDArray[np.float64], slack: float, distinct: NDArray[np.bool_]) -> None:
    """Mark each point that more than rounding keeps from being dominated by another one marked.

    Args:
        points: Shape (k, m).
        slack: What a length may be multiplied by, for rounding.
        distinct: The marks, shape (k,), all True.
    """
    for k in range(len(points)):
        for j in range(len(points)):
            if j != k and distinct[j] and no_worse(points, j, k, slack):
                distinct[k] = False
                break


@inlined
def no_worse(points: NDArray[np.float64], j: int, k: int, slack: float) -> bool:
    """Return whether point j is nowhere above point k, but for rounding."""
    below = True
    for m in range(points.shape[1]):
        below &= points[j, m] <= points[k, m] * slack
    return below


@compiled
def insert_some(
    costs: Costs,
    archive: BlockArchive,
    order: Cities,
    ends: NDArray[np.int64],
    count: int,
) -> bool:
    """Offer tours from an order of the cities on, in lexical order; return whether some are left.

    City 0 stays first. `ends` are the cities at the second place and the last, ANY where free.
    """
    last = len(order) - 1
    for _ in range(count):
        if (ends[0] == ANY or order[1] == ends[0]) and (ends[1] == ANY or order[last] == ends[1]):
            sum_lengths(costs, order, archive.lengths)
            insert(archive, archive.lengths, order)
        if not next_order(order):
            return False
    return True


@compiled
def next_order(order: Cities) -> bool:
    """Change an order to the next, but for its first city; return False after the last one."""
    last = len(order) - 1
    k = last - 1
    while k >= 1 and order[k] >= order[k + 1]:
        k -= 1
    if k < 1:
        return False
    j = last
    while order[j] <= order[k]:
        j -= 1
    order[k], order[j] = order[j], order[k]
    left, right = k + 1, last
    while left < right:
        order[left], order[right] = order[right], order[left]
        left, right = left + 1, right - 1
    return True
