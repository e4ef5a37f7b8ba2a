"""The schedule of a search: which weighted sum to improve next, or which gap of the front to fill.

1. Every weight gets a tour by descent.
2. Every weight gets iterated local search, in two rounds, between which gaps in the front are
   filled.
3. From then on weights and gaps compete for the time: whichever gained more hypervolume lately has
   the next turn.

Of 500 cities or more, the gaps are too wide to be filled. So only some weights get their first tour
by descent. The others, and later every weight at its turn, first descend from the best tours under
the two neighbouring weights: tours on the way are offered to the archive, and the best parts of
these tours are put together (edge assembly).

Where a search starts from the tours of an earlier front, descents begin at the cities that have
changed, and there are other rounds, or none.
"""

from collections.abc import Iterator
from functools import partial
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive.layout import MAX_POINTS
from service.search.archive.sorted_points import dominated_area
from service.search.candidates import (
    POOL_WEIGHTS,
    fill_in_blocks,
    make_candidate_pool,
    rank_candidates,
)
from service.search.costs import scaled_reference
from service.search.enumeration import enumerate_tours
from service.search.front_search import BLOCK, CONSTRUCTIONS, PATIENCE, FrontSearch
from service.search.pareto_local_search import (
    STEPS,
    fill_gaps,
    rounds,
)
from service.search.sizes import LARGE, VAST
from service.search.weights import bisection_order

Array = NDArray[np.float64]

LARGE_CONSTRUCTIONS = 5  # the same, of a large instance
LARGE_DESCENTS = 25  # of a large instance: weights descended to before others from their neighbours
FULL_BLOCK = 1_000  # cities beyond which iterations take longer, and fewer are a block
EXPLORE_EVERY = 10  # one turn in ten goes to the method that has lately gained less
MAX_PROVED = 11  # cities, the invented one among them, up to which convergence is proved


class Search(FrontSearch):
    """A search for the front of an instance of two objectives; see FrontSearch."""

    def __init__(
        self,
        instance: Instance,
        seed: int,
        reference_point: Array,
        capacity: int = MAX_POINTS,
        touched: NDArray[np.integer] | None = None,
    ) -> None:
        super().__init__(instance, seed, reference_point, capacity, touched)
        self.corner = scaled_reference(instance, reference_point)
        self.common = scaled_reference(instance, instance.reference_point)
        self.large = self.n >= LARGE
        self.block = max(STEPS, BLOCK * FULL_BLOCK // max(FULL_BLOCK, self.n))
        self.bisection = bisection_order(len(self.weights))

    @property
    def middle(self) -> int:
        """The number of a weight under which each objective counts."""
        return len(self.weights) // 2

    def run(self) -> Iterator[int]:
        """Search, and yield about every millisecond the number of iterations done since.

        Ends when the search has converged. Of few cities the front is proved then: all tours are
        enumerated that could still be on it.
        """
        yield from self.pool_candidates()
        ahead = rounds(self.n, self.touched)
        yield from self._reach_weights(
            LARGE_DESCENTS if self.large and ahead else len(self.weights)
        )
        for number, (divisor, fills) in enumerate(ahead):
            for k in self._order_in_round(number):
                yield from self._iterate(k, self.n // divisor)
            for _ in range(fills):
                yield from self._fill_gaps()
        yield from self._compete()
        if self.n <= MAX_PROVED:
            for _ in enumerate_tours(self.state.costs, self.state.archive):
                yield 0

    def _order_in_round(self, number: int) -> list[int]:
        """Return the order of the weights in a round: from earlier tours, to and fro."""
        if self.touched is None or self.large:
            return self.bisection
        order = list(range(len(self.weights)))
        return order[::-1] if number % 2 else order

    def _reach_weights(self, descents: int) -> Iterator[int]:
        """Find a tour under each weight: under some by descent, then from neighbours' tours."""
        order = self.bisection
        constructions = LARGE_CONSTRUCTIONS if self.large else CONSTRUCTIONS
        for rank, k in enumerate(order[:descents]):
            scalarization = self.descents.scalarization(k)
            rank_candidates(self.pool, scalarization)
            construct = rank < constructions and self.touched is None
            yield from self.descents.descend(k, scalarization, construct)
        for k in order[descents:]:
            scalarization = self.descents.scalarization(k)
            rank_candidates(self.pool, scalarization)
            assembling = self.n < VAST
            yield from self.descents.descend_from_neighbours(k, scalarization, assembling)
            yield 1

    def pool_candidates(self) -> Iterator[int]:
        """Fill the pool from which the candidates under each weight are ranked.

        Of very many cities without a tour the first one is then constructed as soon as it can be.
        """
        self.pool = make_candidate_pool(self.n)
        pooled = np.linspace(0, len(self.weights) - 1, POOL_WEIGHTS).astype(int)
        if self.n >= VAST:
            pooled = pooled[np.argsort(np.abs(pooled - self.middle), kind="stable")]
        for filled in fill_in_blocks(self.pool, self.state.costs, self.weights[pooled]):
            if filled == 1 and self.n >= VAST and not self.size:
                rank_candidates(self.pool, self.descents.scalarization(self.middle))
                self.descents.construct(self.middle)
            yield 0

    def _iterate(self, k: int, iterations: int) -> Iterator[int]:
        """Run a number of iterations of iterated local search under weight k."""
        scalarization = self.descents.scalarization(k)
        if self.large:
            yield from self.descents.descend_from_neighbours(k, scalarization, assembling=True)
        effort = self.local_search.effort
        block = BLOCK if self.large else max(1, self.block // effort)
        yield from self.iterate(k, scalarization, max(1, iterations // effort), block)

    def _fill_gaps(self) -> Iterator[int]:
        """Run about n iterations of Pareto local search."""
        for _ in range(max(1, self.n // self.block)):
            fill_gaps(self.state, self.common, self.block // STEPS)
            yield self.block

    def _compete(self) -> Iterator[int]:
        """Iterate under weights or fill gaps, whichever lately gained more, until convergence.

        Gain is hypervolume per iteration, as a moving average.
        """
        next_weight = cycle(self.bisection)
        area = partial(dominated_area, self.state.archive, self.corner)
        rates = [np.inf, np.inf]
        quiet, turn = 0, 0
        while quiet < PATIENCE * self.n:
            turn += 1
            slower = int(rates[0] > rates[1])
            kind = slower if turn % EXPLORE_EVERY == 0 else 1 - slower
            before, inserted = area(), self.state.archive.counts[2]
            spent = 0
            for done in self._fill_gaps() if kind else self._iterate(next(next_weight), self.n):
                spent += done
                yield done
            rate = (area() - before) / spent
            rates[kind] = rate if rates[kind] == np.inf else 0.9 * rates[kind] + 0.1 * rate
            quiet = quiet + spent if self.state.archive.counts[2] == inserted else 0
