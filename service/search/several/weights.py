"""The weights of a search for three or four objectives, and the candidates under each of them."""

from collections.abc import Generator, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import PLANE, Instance
from service.preferences import lattice, spread_out
from service.search.candidates import (
    CANDIDATES_PER_CITY,
    CandidatePool,
    Scalarization,
    fill_in_blocks,
    make_candidate_pool,
    rank_candidates,
)
from service.search.closing import NEVER_ADDED
from service.search.costs import Costs
from service.search.several.costs import ObjectiveCosts, weighted_costs

Array = NDArray[np.float64]

PARTS = {3: 13, 4: 7}  # of 1, that the weights of a lattice share: 105 and 120 weights
LEAST_SHARE = 1e-3  # of a weight: the other lengths still count at the ends, to break ties


class _Pool(NamedTuple):
    """For each city, those that are near to it under some weight, each once."""

    cities: NDArray[np.int32]  # (n, width)
    sizes: NDArray[np.int32]  # (n,), how many of a row are used


def search_weights(instance: Instance) -> Array:
    """Return weights of scaled lengths, shape (k, m), rows adding to 1, in the order of use.

    Each is as far as it can be from those before. So after any number of them the front is known
    evenly, and each has one near to it whose tour is a good start.
    """
    shares = lattice(instance.objectives, PARTS[instance.objectives])
    shares = shares[spread_out(shares)].clip(LEAST_SHARE)
    weights = shares / np.ldexp(instance.scale, instance.shifts)
    return weights / weights.sum(axis=1, keepdims=True)


class WeightedSums:
    """The weighted sums of a search; the candidates under a weight are found when first needed."""

    def __init__(self, costs: ObjectiveCosts, weights: Array) -> None:
        self.weights = weights
        self._costs = costs
        n = len(costs.cities)
        width = min(CANDIDATES_PER_CITY, n - 1)
        self._candidates = np.zeros((len(weights), n, width), np.int32)
        self._candidate_costs = np.zeros((len(weights), n, width))
        self._ranked = np.zeros(len(weights), bool)
        self._pool: _Pool | None = None

    def rank(self, k: int) -> Iterator[None]:
        """Rank the candidates under weight k, unless they are; yield every few milliseconds."""
        if self._ranked[k]:
            return
        scalarization = self.scalarization(k)
        n = len(self._costs.cities)
        if len(self._costs.table):
            pool = make_candidate_pool(n)
            yield from fill_in_blocks(pool, scalarization.costs, np.array([[1.0, 0.0]]))
        else:
            if self._pool is None:
                self._pool = yield from _pooled(self._costs)
            pool = _priced(self._costs, self._pool, self.weights[k])
        rank_candidates(pool, scalarization)
        self._ranked[k] = True
        yield

    def scalarization(self, k: int) -> Scalarization:
        """Return the weighted sum of weight k as the first of two costs, and its candidates."""
        costs = weighted_costs(self._costs, self.weights[k])
        return Scalarization(costs, self._candidates[k], self._candidate_costs[k], 1.0, 0.0)


def _pooled(costs: ObjectiveCosts) -> Generator[None, None, _Pool]:
    """Find for each city those near to it in one plane, or in two planes together.

    By k-d trees, which know two planes; costs are not tabulated.
    """
    n, objectives = len(costs.cities), costs.cities.shape[1] // PLANE
    planes = costs.cities.reshape(n, objectives, PLANE)
    found = []
    for m in range(objectives):
        both = np.ascontiguousarray(planes[:, [m, (m + 1) % objectives]].reshape(n, -1))
        pair = Costs(both, np.zeros((0, 0, 2)), True, costs.closing, np.ones(2))
        pool = make_candidate_pool(n)
        yield from fill_in_blocks(pool, pair, np.array([[1.0, 0.0], [0.5, 0.5]]))
        used = np.arange(pool.cities.shape[1]) < pool.sizes[:, np.newaxis]
        found.append(np.where(used, pool.cities, n))
    cities = np.sort(np.concatenate(found, axis=1), axis=1)
    cities[:, 1:][cities[:, 1:] == cities[:, :-1]] = n  # each once
    cities.sort(axis=1)
    sizes = (cities < n).sum(axis=1)
    cities = cities[:, : sizes.max()]
    return _Pool(np.where(cities < n, cities, 0).astype(np.int32), sizes.astype(np.int32))


def _priced(costs: ObjectiveCosts, pool: _Pool, weights: Array) -> CandidatePool:
    """Return a pool with the weighted costs of its cities, as the first of two."""
    n = len(pool.cities)
    planes = costs.cities.reshape(n, -1, PLANE)
    priced = np.zeros((*pool.cities.shape, 2))
    for plane, weight in zip(planes.swapaxes(0, 1), weights, strict=True):
        steps = plane[pool.cities] - plane[:, np.newaxis]
        priced[..., 0] += weight * np.hypot(steps[..., 0], steps[..., 1])
    if costs.invented:
        priced[0, :, 0] = NEVER_ADDED
    return CandidatePool(pool.cities, priced, pool.sizes)
