"""Candidate lists: for each city, the few cheapest to go to under a weighted sum.

Ranking all n cities anew under each of many weights takes O(n^2) a weight. So the cheapest under
a few weights are pooled once, and the lists of all other weights are ranked from that pool. From
coordinates that are not tabulated, k-d trees find them without a look at all pairs.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import allocating, by_reference, inlined
from service.search.closing import NEVER_ADDED, is_closing
from service.search.costs import Costs, make_costs, step_costs
from service.search.kd_tree import (
    KdTrees,
    fill_kd_tree,
    find_nearest,
    insert_smallest,
    make_kd_trees,
    make_nearest,
)

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

CANDIDATES_PER_CITY = 8  # from 5 to 12 make no difference that could be measured
POOL_WEIGHTS = 5  # weights under which the pool collects candidates
POOL_BLOCK = 200_000  # costs computed between two checks of the deadline
TREE_BLOCK = 500  # rows filled by a tree between two checks of the deadline


@by_reference
class CandidatePool(NamedTuple):
    """For each city, the union of its cheapest successors under a few weights, unordered."""

    cities: Cities  # (n, width)
    costs: Array  # (n, width, 2), both costs of going there
    sizes: Cities  # (n,), how many of a row are used


class Scalarization(NamedTuple):
    """The weighted sum w0 f1 + w1 f2 as one objective, with its candidate lists."""

    costs: Costs
    candidates: Cities  # (n, candidates), ascending by weighted cost
    candidate_costs: Array  # (n, candidates), the weighted costs
    w0: float
    w1: float


def make_candidate_pool(n: int) -> CandidatePool:
    """Return an empty pool for n cities."""
    width = min(n - 1, CANDIDATES_PER_CITY * POOL_WEIGHTS)
    return CandidatePool(
        np.zeros((n, width), np.int32), np.zeros((n, width, 2)), np.zeros(n, np.int32)
    )


def fill_in_blocks(pool: CandidatePool, costs: Costs, weights: Array) -> Iterator[int]:
    """Fill an empty pool with the cheapest cities under weights (k, 2).

    O(n^2) where costs are tabulated, else O(n log n). Yields every few milliseconds under how many
    of the weights it is filled so far.
    """
    n = len(pool.cities)
    if len(costs.matrix):
        compared = n
    else:
        compared = 1 if costs.closing.size else 0  # the invented city is in no plane
        cities = np.arange(compared, n, dtype=np.int32)
        trees = make_kd_trees(weights, cities, costs.cities.shape[1])
        for k in range(len(weights)):
            fill_kd_tree(trees, costs, k)
            for begin in range(compared, n, TREE_BLOCK):
                fill_pool_by_tree(pool, costs, trees, k, begin, min(begin + TREE_BLOCK, n))
                yield k
    rows = max(1, POOL_BLOCK // n)
    for begin in range(0, compared, rows):
        fill_pool(pool, costs, weights, begin, min(begin + rows, compared))
        yield 0
    yield len(weights)


def warm_up(instance: Instance) -> None:
    """Compile what finds the candidates of more cities than are tabulated, or load it."""
    costs = make_costs(instance)._replace(matrix=np.zeros((0, 0, 2)))
    for _ in fill_in_blocks(make_candidate_pool(len(costs.cities)), costs, np.full((1, 2), 0.5)):
        pass


@inlined
def weighted_cost(scalarization: Scalarization, i: int, j: int) -> float:
    """Return the weighted cost of the step from city i to city j."""
    c = step_costs(scalarization.costs, i, j)
    return scalarization.w0 * c[0] + scalarization.w1 * c[1]


@inlined
def candidate_costs(costs: Costs, i: int, j: int) -> tuple[float, float]:
    """Return both costs of a step as a candidate.

    A step that has to stay in the tour is never added. Where costs are symmetric, no step of an
    invented city is: at no cost it would be tried at every city, and took a fifth of the time,
    while 2-opt and Or-opt find the same moves from the cities that these bring together elsewhere.
    """
    first, second = step_costs(costs, i, j)
    if is_closing(costs.closing, i, j):
        return (NEVER_ADDED, NEVER_ADDED) if costs.symmetric else (abs(first), abs(second))
    return first, second


@inlined
def select_smallest(keys: Array, skipped: int, chosen: Cities, chosen_keys: Array) -> None:
    """Fill `chosen` with the indices of the smallest keys, ascending, without index `skipped`.

    Of equal keys the lower index comes first. Insertion into a list of k: O(n k).
    """
    chosen_keys[:] = np.inf
    for j in range(len(keys)):
        if j != skipped:
            insert_smallest(chosen, chosen_keys, j, keys[j])


@allocating
def fill_pool(pool: CandidatePool, costs: Costs, weights: Array, begin: int, end: int) -> None:
    """Fill the rows begin to end - 1 of a pool with the cheapest cities under weights (k, 2)."""
    n = len(pool.cities)
    rows = np.empty((2, n))
    keys = np.empty(n)
    chosen = np.empty(min(CANDIDATES_PER_CITY, n - 1), np.int32)
    chosen_keys = np.empty(len(chosen))
    seen = np.full(n, -1, np.int32)
    for i in range(begin, end):
        pool.sizes[i] = 0
        for j in range(n):
            rows[0, j], rows[1, j] = candidate_costs(costs, i, j)
        for k in range(len(weights)):
            for m in range(n):
                keys[m] = weights[k, 0] * rows[0, m] + weights[k, 1] * rows[1, m]
            select_smallest(keys, i, chosen, chosen_keys)
            pool_chosen(pool, costs, i, chosen, seen)


@allocating
def fill_pool_by_tree(
    pool: CandidatePool, costs: Costs, trees: KdTrees, k: int, begin: int, end: int
) -> None:
    """Fill the rows begin to end - 1 of a pool with the cheapest cities under weights k as well.

    Under all weights in turn, that is what fill_pool() fills in, but for cities at equal costs.
    O(log n) a row.
    """
    found = make_nearest(CANDIDATES_PER_CITY)
    seen = np.full(len(pool.cities), -1, np.int32)
    for i in range(begin, end):
        for place in range(pool.sizes[i]):
            seen[pool.cities[i, place]] = i
        find_nearest(trees, costs, k, i, found)
        pool_chosen(pool, costs, i, found.cities, seen)


@inlined
def pool_chosen(pool: CandidatePool, costs: Costs, i: int, chosen: Cities, seen: Cities) -> None:
    """Add those cities to row i of a pool that it does not hold yet; `seen` is of all cities."""
    for j in chosen:
        if seen[j] != i:
            seen[j] = i
            place = pool.sizes[i]
            pool.cities[i, place] = j
            pool.costs[i, place, 0], pool.costs[i, place, 1] = candidate_costs(costs, i, j)
            pool.sizes[i] = place + 1


@allocating
def rank_candidates(pool: CandidatePool, scalarization: Scalarization) -> None:
    """Fill the candidate lists of a weighted sum from the pool."""
    candidates, w0, w1 = scalarization.candidates, scalarization.w0, scalarization.w1
    keys = np.empty(pool.cities.shape[1])
    chosen = np.empty(candidates.shape[1], np.int32)
    chosen_keys = np.empty(candidates.shape[1])
    for i in range(len(candidates)):
        size = pool.sizes[i]
        for k in range(size):
            keys[k] = w0 * pool.costs[i, k, 0] + w1 * pool.costs[i, k, 1]
        select_smallest(keys[:size], -1, chosen, chosen_keys)
        for k in range(len(chosen)):
            candidates[i, k] = pool.cities[i, chosen[k]]
            scalarization.candidate_costs[i, k] = chosen_keys[k]
