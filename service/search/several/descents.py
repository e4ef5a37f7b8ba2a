"""Descend to a local optimum under one weight of three or four objectives.

A descent begins at the best tour known under its weight. Of some hundred cities or more, descents
then begin at the best tours of the nearest weights as well, and the best tour takes the better
parts of what these have found (edge assembly).
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.candidates import Scalarization
from service.search.costs import lengths
from service.search.edge_assembly.assembly import assemble
from service.search.local_search import least_gain
from service.search.pareto_local_search import LARGE
from service.search.several.archive import best_row
from service.search.several.local_search import StateOfSeveral, offer
from service.search.several.weights import WeightedSums
from service.search.sizes import GREEDY
from service.search.starts.constructed_tour import constructed_tour
from service.search.three_opt.choice import LocalSearch
from service.search.working_tour import enqueue_cities

Cities = NDArray[np.int32]

DESCENT_BLOCK = 2_000  # cities from the queue between two checks of the deadline
OFFERS = 50  # of a large tour on the way of a descent, in each sweep along it
ASSEMBLED = 150  # cities from which on tours are assembled; of 100 iterations find more
NEIGHBOURS = 6  # weights whose tours are assembled from: 3 leave a fifth of the gain, 10 add none
ASSEMBLIES = 2  # times that each tour is assembled from: what there is to choose at random differs


class DescentsOfSeveral:
    """The descents of a search under three or four objectives, which offer what they find.

    Args:
        instance: The instance.
        state: The state of the search.
        sums: The weighted sums, by the number of their weight.
        local_search: What descends.
        touched: The cities at which a descent begins where they are not all.
    """

    def __init__(
        self,
        instance: Instance,
        state: StateOfSeveral,
        sums: WeightedSums,
        local_search: LocalSearch,
        touched: Cities | None,
    ) -> None:
        self._instance, self._state, self._sums = instance, state, sums
        self._local_search = local_search
        self._touched = touched
        self._n = len(state.costs.cities)

    @property
    def assembling(self) -> bool:
        """Whether tours are assembled."""
        return self._n >= ASSEMBLED and self._state.costs.symmetric

    def least(self, k: int) -> float:
        """Return the least weighted sum under weight k of the tours found so far."""
        archive = self._state.archive
        row = best_row(archive, self._sums.weights[k])
        return float(archive.points[row] @ self._sums.weights[k])

    def load_best(self, k: int, scalarization: Scalarization, local_search: LocalSearch) -> None:
        """Load the best tour known under weight k."""
        tour = self._best_tour(k)
        local_search.load(tour, *lengths(scalarization.costs, tour))

    def descend(self, k: int, scalarization: Scalarization, construct: bool) -> Iterator[int]:
        """Descend to a local optimum under weight k.

        Args:
            k: The number of the weight.
            scalarization: Its weighted sum, and the candidates under it.
            construct: Whether to begin at a constructed tour if that is better than the best known.
                If none is known, one is constructed in any case.
        """
        known = self._state.archive.counts[0] > 0
        constructed = (construct or not known) and self._load_constructed(k, scalarization)
        if not constructed:
            self.load_best(k, scalarization, self._local_search)
        cities = self._local_search.working.tour if self._touched is None else self._touched
        offering = self._n >= LARGE and not constructed
        yield from self._sweep(scalarization, cities, offering)
        yield 1

    def assemble(self, k: int, scalarization: Scalarization) -> Iterator[int]:
        """Improve the best tour under weight k by the tours of the weights nearest to it.

        A descent begins at each of these. Then the best tour takes their better parts.
        """
        local_search, working = self._local_search, self._local_search.working
        tours = [self._best_tour(k)]
        for neighbour in self._sums.nearest(k, NEIGHBOURS):
            self.load_best(neighbour, scalarization, local_search)
            yield from self._sweep(scalarization, working.tour, offering=True)
            tours.append(working.tour.copy())
        self.load_best(k, scalarization, local_search)
        gained, threshold = 0.0, least_gain(scalarization, working.length.sum())
        for other in ASSEMBLIES * tours:
            given = working.tour, working.position, other
            gained += assemble(given, scalarization, threshold, self._state.random)
            yield 0
        if gained > 0.0:
            local_search.load(working.tour, *lengths(scalarization.costs, working.tour))
            yield from self._sweep(scalarization, working.tour, offering=False)
        yield 1

    def _load_constructed(self, k: int, scalarization: Scalarization) -> bool:
        """Load a tour constructed under weight k if it is better than the best one known.

        Returns whether it is.
        """
        greedy = self._n >= GREEDY and self._state.costs.symmetric
        tour = constructed_tour(self._instance, scalarization, greedy)
        first, second = lengths(scalarization.costs, tour)
        if self._state.archive.counts[0] > 0 and first + second >= self.least(k):
            return False
        self._local_search.load(tour, first, second)
        return True

    def _best_tour(self, k: int) -> Cities:
        """Return the best tour known under weight k."""
        archive = self._state.archive
        tour: Cities = archive.tours[best_row(archive, self._sums.weights[k])]
        return tour.copy()

    def _sweep(self, scalarization: Scalarization, cities: Cities, offering: bool) -> Iterator[int]:
        """Descend from the working tour, beginning at these cities, and offer the local optimum.

        With `offering`, tours on the way are offered too. Those between the best tours of two
        weights may be on the front.
        """
        working = self._local_search.working
        enqueue_cities(working, cities)
        block = 1 + self._n // OFFERS if offering else DESCENT_BLOCK
        while self._local_search.descend(scalarization, block) == 0:
            if offering:
                offer(self._state, working)
            yield 0
        offer(self._state, working)
