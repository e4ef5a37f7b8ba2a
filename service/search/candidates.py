"""Candidate lists: for each city, the few that are worth going to under a weight."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, inlined
from service.search.costs import Costs, pair

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

NEAREST = 8  # 5 to 12 make no difference that could be measured
POOL_WEIGHTS = 5


class Pool(NamedTuple):
    """For each city, all that are nearest under some weight, with what they cost."""

    cities: Cities  # (n, width)
    costs: Array  # (n, width, 2)
    sizes: Cities  # (n,)


class Scalarization(NamedTuple):
    """One objective made of two: costs under a weight, and the candidates under that weight."""

    costs: Costs
    near: Cities  # (n, nearest), ascending by weighted cost
    near_costs: Array  # (n, nearest), the weighted costs
    w0: float
    w1: float


def empty_pool(n: int) -> Pool:
    """A pool of n cities, yet to be filled."""
    width = min(n - 1, NEAREST * POOL_WEIGHTS)
    return Pool(np.zeros((n, width), np.int32), np.zeros((n, width, 2)), np.zeros(n, np.int32))


@inlined
def weighted(scalar: Scalarization, i: int, j: int) -> float:
    """The weighted cost of the step from city i to city j."""
    c = pair(scalar.costs, i, j)
    return scalar.w0 * c[0] + scalar.w1 * c[1]


@inlined
def smallest(keys: Array, skipped: int, chosen: Cities, chosen_keys: Array) -> None:
    """Fills chosen with the indices of the smallest keys, ascending, leaving one index out."""
    kept = len(chosen)
    chosen_keys[:] = np.inf
    for j in range(len(keys)):
        key = keys[j]
        if key >= chosen_keys[kept - 1] or j == skipped:
            continue
        place = kept - 1
        while place > 0 and chosen_keys[place - 1] > key:
            chosen_keys[place] = chosen_keys[place - 1]
            chosen[place] = chosen[place - 1]
            place -= 1
        chosen_keys[place] = key
        chosen[place] = j


@allocating
def fill_pool(pool: Pool, costs: Costs, weights: Array, begin: int, end: int) -> None:
    """Pools the nearest cities of cities begin to end, under weights (k, 2)."""
    n = len(pool.cities)
    rows = np.empty((2, n))
    keys = np.empty(n)
    chosen = np.empty(min(NEAREST, n - 1), np.int32)
    chosen_keys = np.empty(len(chosen))
    seen = np.full(n, -1, np.int32)
    for i in range(begin, end):
        pool.sizes[i] = 0
        for j in range(n):
            rows[0, j], rows[1, j] = pair(costs, i, j)
        for k in range(len(weights)):
            for m in range(n):
                keys[m] = weights[k, 0] * rows[0, m] + weights[k, 1] * rows[1, m]
            smallest(keys, i, chosen, chosen_keys)
            for c in range(len(chosen)):
                j = chosen[c]
                if seen[j] != i:
                    seen[j] = i
                    place = pool.sizes[i]
                    pool.cities[i, place] = j
                    pool.costs[i, place, 0] = rows[0, j]
                    pool.costs[i, place, 1] = rows[1, j]
                    pool.sizes[i] = place + 1


@allocating
def nearest(pool: Pool, near: Cities, near_costs: Array, w0: float, w1: float) -> None:
    """Fills near and near_costs, shape (n, nearest), from the pool, under a weight."""
    keys = np.empty(pool.cities.shape[1])
    chosen = np.empty(near.shape[1], np.int32)
    chosen_keys = np.empty(near.shape[1])
    for i in range(len(near)):
        size = pool.sizes[i]
        for k in range(size):
            keys[k] = w0 * pool.costs[i, k, 0] + w1 * pool.costs[i, k, 1]
        smallest(keys[:size], -1, chosen, chosen_keys)
        for k in range(len(chosen)):
            near[i, k] = pool.cities[i, chosen[k]]
            near_costs[i, k] = chosen_keys[k]
