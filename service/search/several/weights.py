"""The weights of a search for three or four objectives, and the candidates under each of them."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.preferences import lattice, spread_out
from service.search.candidates import (
    CANDIDATES_PER_CITY,
    Scalarization,
    fill_in_blocks,
    make_candidate_pool,
    rank_candidates,
)
from service.search.costs import Costs, weighted_costs

Array = NDArray[np.float64]

PARTS = {3: 13, 4: 7}  # of 1, that the weights of a lattice share: 105 and 120 weights
LEAST_SHARE = 1e-3  # of a weight: the other lengths still count at the ends, to break ties


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

    def __init__(self, costs: Costs, weights: Array) -> None:
        self.weights = weights
        self._costs = costs
        n = len(costs.cities)
        width = min(CANDIDATES_PER_CITY, n - 1)
        self._candidates = np.zeros((len(weights), n, width), np.int32)
        self._candidate_costs = np.zeros((len(weights), n, width))
        self._ranked = np.zeros(len(weights), bool)

    def rank(self, k: int) -> Iterator[None]:
        """Rank the candidates under weight k, unless they are; yield every few milliseconds."""
        if self._ranked[k]:
            return
        scalarization = self.scalarization(k)
        pool = make_candidate_pool(len(self._costs.cities))
        for _ in fill_in_blocks(pool, scalarization.costs, np.ones((1, 2))):
            yield
        rank_candidates(pool, scalarization)
        self._ranked[k] = True
        yield

    def nearest(self, k: int, count: int) -> NDArray[np.intp]:
        """Return the `count` weights nearest to weight k, the nearest first, without itself."""
        shares = self.weights / self.weights.max(axis=0)
        shares /= shares.sum(axis=1, keepdims=True)
        away = ((shares - shares[k]) ** 2).sum(axis=1)
        away[k] = np.inf
        return away.argsort(kind="stable")[:count]

    def scalarization(self, k: int) -> Scalarization:
        """Return the weighted sum of weight k as the sum of two costs, and its candidates."""
        costs = weighted_costs(self._costs, self.weights[k])
        return Scalarization(costs, self._candidates[k], self._candidate_costs[k], 1.0, 1.0)
