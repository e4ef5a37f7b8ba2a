"""Exchange chosen points of a front for others close to them that add more to the hypervolume."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from paretour.choice import losses

from service.jit import compiled, inlined
from service.search.several.greedy_choice import Choice, added_volume, drop_chosen, keep_chosen

CLOSE = 30  # points that are tried in the place of one

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


class Places(NamedTuple):
    """Where the points of a front are, to find those that are close to one."""

    order: Numbers  # (k,): the points, ascending by their first loss
    ranks: Numbers  # (k,), by point: its place in `order`
    losses: Array  # (k, m), in this order
    close: Numbers  # (CLOSE,), scratch space: places in `order`, ascending by their distance
    distances: Array  # (CLOSE,), scratch space


def make_places(shares: Array) -> Places:
    """Return the places of points, shape (k, m), in the points' own box. O(k log k)."""
    own = losses(shares)
    order = np.argsort(own[:, 0], kind="stable")
    ranks = np.empty(len(order), np.int64)
    ranks[order] = np.arange(len(order))
    scratch = np.empty(CLOSE, np.int64), np.empty(CLOSE)
    return Places(order, ranks, np.ascontiguousarray(own[order]), *scratch)


@compiled
def exchange(choice: Choice, places: Places, point: int) -> bool:
    """Choose in place of a chosen point that which adds most: it, or one of those close to it.

    Returns whether it is another.
    """
    place = 0
    while choice.chosen[place] != point:
        place += 1
    best = drop_chosen(choice, place)
    most = added_volume(choice, best)
    for number in range(find_close(places, places.ranks[point])):
        other = places.order[places.close[number]]
        if not choice.taken[other]:
            added = added_volume(choice, other)
            if added > most:
                best, most = other, added
    keep_chosen(choice, best)
    return best != point


@compiled
def find_close(places: Places, rank: int) -> int:
    """Fill in the points closest to one by their largest difference of losses; return how many."""
    first, below, above, count = places.losses[:, 0], rank - 1, rank + 1, 0
    while below >= 0 or above < len(first):
        gap_below = first[rank] - first[below] if below >= 0 else np.inf
        gap_above = first[above] - first[rank] if above < len(first) else np.inf
        if count == CLOSE and min(gap_below, gap_above) >= places.distances[count - 1]:
            break
        if gap_below < gap_above:
            count = keep_close(places, rank, below, count)
            below -= 1
        else:
            count = keep_close(places, rank, above, count)
            above += 1
    return count


@inlined
def keep_close(places: Places, rank: int, other: int, count: int) -> int:
    """Keep a point if it is closer than one of those so far, or if these are few."""
    close, distances, distance = places.close, places.distances, 0.0
    for m in range(places.losses.shape[1]):
        distance = max(distance, abs(places.losses[other, m] - places.losses[rank, m]))
    if count == CLOSE and distance >= distances[count - 1]:
        return count
    place = min(count, CLOSE - 1)
    while place > 0 and distances[place - 1] > distance:
        distances[place], close[place] = distances[place - 1], close[place - 1]
        place -= 1
    distances[place], close[place] = distance, other
    return min(count + 1, CLOSE)
