"""The schedule of a search for three or four objectives: which weight, and from which tours.

1. Every weight gets a tour by descent, from the best one known under it.
2. Each weight in turn has its tour improved: by the better parts of the tours of other weights,
   then by iterated local search. Then the search goes on from points of the front near that tour.

Up to some hundred cities, every tour on the way is offered to the archive.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive import MAX_POINTS
from service.search.archive import make_archive as make_sorted_archive
from service.search.candidates import Scalarization
from service.search.costs import make_costs, sum_lengths, weighted_costs
from service.search.front_search import FrontSearch
from service.search.pareto_local_search import SearchState, WeightedCandidates
from service.search.several.archive import (
    accepts,
    insert,
    make_archive,
    rows_of,
)
from service.search.several.descents import DescentsOfSeveral
from service.search.several.local_search import (
    StateOfSeveral,
    iterate,
    offer,
    search_from_points,
)
from service.search.several.weights import WeightedSums, search_weights
from service.search.three_opt.choice import TwoOptSearch, choose_local_searches
from service.search.working_tour import make_working_tour

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

CONSTRUCTIONS = 17  # weights for which a tour is constructed as well
BLOCK = 300  # iterations between two checks of the deadline, some milliseconds
LONG_BLOCK = 50  # the same by three-opt
STEPS = 10  # of the iterated local search from each point
PATIENCE = 1_000  # iterations per city without a new tour, after which the search has converged
# Iterations under each weight as shares of n, by the round: of its best tour, and from points.
ROUNDS = ((0.25, 0.0), (0.5, 0.5), (0.5, 1.0))


class SearchOfSeveral(FrontSearch):
    """A search for the front of an instance of three or four objectives; see FrontSearch."""

    def __init__(
        self,
        instance: Instance,
        seed: int,
        reference_point: Array,
        capacity: int = MAX_POINTS,
        touched: NDArray[np.integer] | None = None,
    ) -> None:
        self._costs = make_costs(instance)
        self._n = len(self._costs.cities)
        self._sums = WeightedSums(self._costs, search_weights(instance))
        self._weights = self._sums.weights
        self._archive = make_archive(self._n, instance.objectives, capacity)
        super().__init__(instance, reference_point, self._archive, touched)
        self._state = StateOfSeveral(
            self._costs,
            self._archive,
            make_working_tour(self._n),
            np.random.default_rng(seed).integers(1, 2**63 - 1, 1),
        )
        descent, self._local_search = choose_local_searches(
            self._state_of_two(), touched is not None
        )
        self._descents = DescentsOfSeveral(instance, self._state, self._sums, descent, self.touched)
        self._lengths = np.empty(instance.objectives)
        self._sorted = 0, np.empty(0, np.int32)  # tours ever inserted, and the rows then

    def _state_of_two(self) -> SearchState:
        """Return the state of a search for two objectives, for its local searches.

        What they offer, under two costs, goes to an archive of its own that nobody reads.
        """
        n = self._n
        return SearchState(
            weighted_costs(self._costs, self._weights[0]),
            WeightedCandidates(
                np.zeros((0, 2)), np.zeros((0, n, 0), np.int32), np.zeros((0, n, 0))
            ),
            make_sorted_archive(n, capacity=0),
            self._state.working,
            self._state.random,
        )

    def _front(self) -> tuple[Cities, Array]:
        inserted = int(self._archive.counts[2])
        if inserted != self._sorted[0]:  # else it is sorted already
            self._sorted = inserted, rows_of(self._archive)
        rows = self._sorted[1]
        return rows, self._archive.points[rows]

    def _insert(self, tour: Cities) -> None:
        sum_lengths(self._costs, tour, self._lengths)
        insert(self._archive, self._lengths, tour)

    def _accepts(self, tour: Cities) -> bool:
        sum_lengths(self._costs, tour, self._lengths)
        return accepts(self._archive, self._lengths)

    def _middle(self) -> Scalarization:
        return self._sums.scalarization(0)

    def run(self) -> Iterator[int]:
        """Search, and yield about every millisecond the number of iterations done since.

        Ends when the search has converged.
        """
        for k in range(len(self._weights)):
            yield from self._rank(k)
            construct = k < CONSTRUCTIONS and self.touched is None
            yield from self._descents.descend(k, self._sums.scalarization(k), construct)
        rounds = iter(ROUNDS)
        share, quiet = next(rounds), 0
        while quiet < PATIENCE * self._n:
            for k in range(len(self._weights)):
                inserted = self._archive.counts[2]
                for done in self._take_turn(k, *share):
                    quiet += done
                    yield done
                quiet = quiet if self._archive.counts[2] == inserted else 0
            share = next(rounds, share)

    def _take_turn(self, k: int, own: float, gaps: float) -> Iterator[int]:
        """Improve the best tour under weight k, and search from points of the front near to it."""
        yield from self._rank(k)
        scalarization = self._sums.scalarization(k)
        if self._descents.assembling:
            yield from self._descents.assemble(k, scalarization)
        if own:
            yield from self._improve_best(k, scalarization, max(1, int(own * self._n)))
        if gaps:
            yield from self._search_near(k, scalarization, max(STEPS, int(gaps * self._n)))

    def _rank(self, k: int) -> Iterator[int]:
        """Rank the candidates under weight k, unless they are."""
        for _ in self._sums.rank(k):
            yield 0

    def _improve_best(self, k: int, scalarization: Scalarization, steps: int) -> Iterator[int]:
        """Run iterated local search from the best tour known under weight k."""
        self._descents.load_best(k, scalarization, self._local_search)
        if isinstance(self._local_search, TwoOptSearch):
            for done in range(0, steps, BLOCK):
                block = min(steps - done, BLOCK)
                iterate(self._state, scalarization, block)
                yield block
            return
        for done in range(0, steps, LONG_BLOCK):
            block = min(steps - done, LONG_BLOCK)
            self._local_search.iterate(scalarization, block)
            offer(self._state, self._local_search.working)
            yield block * self._local_search.effort

    def _search_near(self, k: int, scalarization: Scalarization, steps: int) -> Iterator[int]:
        """Run iterated local search by two-opt under weight k from points of the front."""
        weights, least = self._weights[k], self._descents.least(k)
        for done in range(0, steps, BLOCK):
            block = min(steps - done, BLOCK)
            rounds = max(1, block // STEPS)
            search_from_points(self._state, scalarization, weights, least, rounds, STEPS)
            yield block
