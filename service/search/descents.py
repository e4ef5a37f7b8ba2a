"""Descend to a local optimum under one weight, from the best tour known.

Of a large instance, descents also begin at the best tours under the nearest weights. Then the best
tour takes the better parts of what these have found (edge assembly).
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.objectives import OBJECTIVES
from service.search.archive.insertion import insert
from service.search.archive.layout import best_row
from service.search.candidates import Scalarization
from service.search.costs import as_two, lengths
from service.search.edge_assembly.assembly import assemble
from service.search.local_search import least_gain, offer, sum_afresh
from service.search.sizes import GREEDY, LARGE
from service.search.starts.constructed_tour import constructed_tour
from service.search.state import SearchState
from service.search.three_opt.choice import LocalSearch
from service.search.weights import neighbours
from service.search.working_tour import enqueue_cities

Cities = NDArray[np.int32]

OFFERS = 50  # of a large tour on the way of a descent, in each sweep along it
LEAST_BLOCK = 20  # cities from the queue between two offers: a call takes as long as some cities
DESCENT_BLOCK = 2_000  # cities from the queue between two checks of the deadline
NEIGHBOURS = 6  # weights to begin at; of 3 objectives 3 leave a fifth of the gain, 10 add none
ASSEMBLIES = 2  # times that each tour is assembled from: what there is to choose at random differs


class Descents:
    """The descents of a search, which offer what they find to its archive.

    Args:
        instance: The instance.
        state: The state of the search.
        local_search: What descends.
        touched: The cities at which a descent begins where they are not all.
    """

    def __init__(
        self,
        instance: Instance,
        state: SearchState,
        local_search: LocalSearch,
        touched: Cities | None,
    ) -> None:
        self.instance, self.state, self.touched = instance, state, touched
        self.local_search = local_search
        self.weights = state.weighted_candidates.weights
        self.n = len(state.costs.cities)
        self.large = self.n >= LARGE

    def scalarization(self, k: int) -> Scalarization:
        """Return the weighted sum of weight k, and the candidates under it."""
        weights, candidates, candidate_costs = self.state.weighted_candidates
        costs, w0, w1 = as_two(self.state.costs, weights[k])
        return Scalarization(costs, candidates[k], candidate_costs[k], w0, w1)

    def load_best(self, k: int, scalarization: Scalarization, local_search: LocalSearch) -> None:
        """Load the best tour known under weight k, with its lengths under a weighted sum."""
        tour = self._best_tour(k)
        local_search.load(tour, *lengths(scalarization.costs, tour))

    def load_start(self, k: int, scalarization: Scalarization, construct: bool) -> bool:
        """Load the best tour known under weight k, or a constructed one if that is better.

        Returns whether the tour is constructed.
        """
        least, working = np.inf, self.local_search.working
        if self.state.archive.counts[0] > 0:
            self.load_best(k, scalarization, self.local_search)
            least = _value(scalarization, *working.length)
        if construct or least == np.inf:
            greedy = self.n >= GREEDY and scalarization.costs.symmetric
            tour = constructed_tour(self.instance, scalarization, greedy)
            constructed = lengths(scalarization.costs, tour)
            if _value(scalarization, *constructed) < least:
                self.local_search.load(tour, *constructed)
                return True
        return False

    def construct(self, k: int) -> None:
        """Offer a tour that is constructed under weight k, whose candidates are ranked."""
        self.load_start(k, self.scalarization(k), construct=True)
        offer(self.state, self.local_search.working)

    def _best_tour(self, k: int) -> Cities:
        """Return the best tour known under weight k."""
        archive = self.state.archive
        tour: Cities = archive.tours[best_row(archive, self.weights[k])]
        return tour.copy()

    def descend(self, k: int, scalarization: Scalarization, construct: bool) -> Iterator[int]:
        """Descend to a local optimum under weight k, whose candidates are ranked.

        With `construct` it begins at a constructed tour if that is better than the best known.
        """
        constructed = self.load_start(k, scalarization, construct)
        cities = self.local_search.working.tour if self.touched is None else self.touched
        yield from self._sweep(scalarization, cities, offering=self.large and not constructed)
        yield 1

    def descend_from_neighbours(
        self, k: int, scalarization: Scalarization, assembling: bool
    ) -> Iterator[int]:
        """Descend under weight k from the best tours under the weights nearest to it.

        With `assembling`, and symmetric costs, the best tour then takes the better parts of the
        tours found, and of the best one before.
        """
        assembling = assembling and scalarization.costs.symmetric
        tours = [self._best_tour(k)]
        for neighbour in neighbours(self.weights, k, NEIGHBOURS):
            self.load_best(neighbour, scalarization, self.local_search)
            cities = self.local_search.working.tour
            yield from self._sweep(scalarization, cities, offering=True)
            if assembling:
                tours.append(cities.copy())
        if assembling:
            yield from self._assemble(k, scalarization, tours)

    def _assemble(
        self, k: int, scalarization: Scalarization, tours: Sequence[Cities]
    ) -> Iterator[int]:
        """Put the better parts of these tours into the best one, and descend from there."""
        local_search, working = self.local_search, self.local_search.working
        self.load_best(k, scalarization, local_search)
        gained, threshold = 0.0, least_gain(scalarization, _value(scalarization, *working.length))
        for other in ASSEMBLIES * [*tours]:
            given = working.tour, working.position, other
            gained += assemble(given, scalarization, threshold, self.state.random)
            yield 0
        if gained > 0.0:
            local_search.load(working.tour, *lengths(scalarization.costs, working.tour))
            yield from self._sweep(scalarization, working.tour, offering=False)

    def _sweep(self, scalarization: Scalarization, cities: Cities, offering: bool) -> Iterator[int]:
        """Descend from the working tour, beginning at these cities, and offer the local optimum.

        With `offering`, tours on the way are offered too. Those between the best tours of two
        weights may be on the front.
        """
        working = self.local_search.working
        enqueue_cities(working, cities)
        block = max(LEAST_BLOCK, 1 + self.n // OFFERS) if offering else DESCENT_BLOCK
        while self.local_search.descend(scalarization, block) == 0:
            if offering:
                self._offer_on_the_way()
            yield 0
        sum_afresh(working, scalarization)
        offer(self.state, working)

    def _offer_on_the_way(self) -> None:
        """Offer a tour; of two objectives with lengths as updated.

        To sum them afresh takes as long as the rest.
        """
        working, archive = self.local_search.working, self.state.archive
        if len(archive.lengths) == OBJECTIVES:
            insert(archive, working.length, working.tour)
        else:
            offer(self.state, working)


def _value(scalarization: Scalarization, first: float, second: float) -> float:
    """Return the weighted sum of two lengths."""
    return scalarization.w0 * first + scalarization.w1 * second
