"""The schedule of a search for three or four objectives: which weight, and from which tours.

1. Every weight gets a tour by descent, from the best one known under it.
2. Each weight in turn has its tour improved: by the better parts of the tours of other weights,
   then by iterated local search. Then the search goes on from points of the front near that tour.

Up to some hundred cities, every tour on the way is offered to the archive.
"""

from collections.abc import Iterator

import numpy as np

from service.search.archive.layout import best_row
from service.search.candidates import (
    Scalarization,
    fill_in_blocks,
    make_candidate_pool,
    rank_candidates,
)
from service.search.front_search import BLOCK, CONSTRUCTIONS, PATIENCE, FrontSearch
from service.search.pareto_local_search import STEPS, search_from_points
from service.search.three_opt.choice import TwoOptSearch

LONG_BLOCK = 50  # iterations by three-opt between two checks of the deadline
ASSEMBLED = 150  # cities from which on tours are assembled; of 100 iterations find more
# Iterations under each weight as shares of n, by the round: of its best tour, and from points.
ROUNDS = ((0.25, 0.0), (0.5, 0.5), (0.5, 1.0))


class SearchOfSeveral(FrontSearch):
    """A search for the front of an instance of three or four objectives; see FrontSearch."""

    middle = 0

    def run(self) -> Iterator[int]:
        """Search, and yield about every millisecond the number of iterations done since.

        Ends when the search has converged.
        """
        for k in range(len(self.weights)):
            scalarization = self.descents.scalarization(k)
            yield from self._rank(scalarization)
            construct = k < CONSTRUCTIONS and self.touched is None
            yield from self.descents.descend(k, scalarization, construct)
        rounds = iter(ROUNDS)
        share, quiet = next(rounds), 0
        while quiet < PATIENCE * self.n:
            for k in range(len(self.weights)):
                inserted = self.state.archive.counts[2]
                for done in self._take_turn(k, *share):
                    quiet += done
                    yield done
                quiet = quiet if self.state.archive.counts[2] == inserted else 0
            share = next(rounds, share)

    def _take_turn(self, k: int, own: float, gaps: float) -> Iterator[int]:
        """Improve the best tour under weight k, and search from points of the front near to it."""
        scalarization = self.descents.scalarization(k)
        if self.n >= ASSEMBLED and scalarization.costs.symmetric:
            yield from self.descents.descend_from_neighbours(k, scalarization, assembling=True)
            yield 1
        if own:
            block = BLOCK if isinstance(self.local_search, TwoOptSearch) else LONG_BLOCK
            yield from self.iterate(k, scalarization, max(1, int(own * self.n)), block)
        if gaps:
            yield from self._search_near(k, scalarization, max(STEPS, int(gaps * self.n)))

    def _rank(self, scalarization: Scalarization) -> Iterator[int]:
        """Rank the candidates under a weighted sum; yield every few milliseconds."""
        pool = make_candidate_pool(self.n)
        for _ in fill_in_blocks(pool, scalarization.costs, np.ones((1, 2))):
            yield 0
        rank_candidates(pool, scalarization)
        yield 0

    def _search_near(self, k: int, scalarization: Scalarization, steps: int) -> Iterator[int]:
        """Run iterated local search by two-opt under weight k from points of the front."""
        weights, archive = self.weights[k], self.state.archive
        least = float(archive.points[best_row(archive, weights)] @ weights)
        for done in range(0, steps, BLOCK):
            block = min(steps - done, BLOCK)
            rounds = max(1, block // STEPS)
            search_from_points(self.state, scalarization, weights, least, rounds)
            yield block
