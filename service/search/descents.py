"""Descend to a local optimum under one weight, from the best tour known.

Of a large instance, descents also begin at the best tours under the weights before and after. Then
the best tour takes the better parts of what these have found (edge assembly).
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive import best_point, insert
from service.search.candidates import Scalarization
from service.search.costs import lengths
from service.search.edge_assembly.assembly import assemble
from service.search.local_search import least_gain, offer, sum_afresh
from service.search.pareto_local_search import LARGE, SearchState
from service.search.sizes import GREEDY
from service.search.starts.constructed_tour import constructed_tour
from service.search.three_opt.choice import LocalSearch
from service.search.working_tour import enqueue_cities

Cities = NDArray[np.int32]

OFFERS = 50  # of a large tour on the way of a descent, in each sweep along it
DESCENT_BLOCK = 2_000  # cities from the queue between two checks of the deadline
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
        self.n = len(state.costs.cities)
        self.large = self.n >= LARGE

    def scalarization(self, k: int) -> Scalarization:
        """Return the weighted sum of weight k, and the candidates under it."""
        weights, candidates, candidate_costs = self.state.weighted_candidates
        w0, w1 = weights[k].tolist()
        return Scalarization(self.state.costs, candidates[k], candidate_costs[k], w0, w1)

    def load_start(
        self, local_search: LocalSearch, scalarization: Scalarization, construct: bool = False
    ) -> None:
        """Load the best tour known for a weighted sum, or a constructed one if that is better."""
        load, known = local_search.load, self._best_tour(scalarization)
        least = np.inf
        if known is not None:
            tour, first, second = known
            least = scalarization.w0 * first + scalarization.w1 * second
            load(tour, first, second)
        if construct or known is None:
            greedy = self.n >= GREEDY and scalarization.costs.symmetric
            tour = constructed_tour(self.instance, scalarization, greedy)
            first, second = lengths(scalarization.costs, tour)
            if scalarization.w0 * first + scalarization.w1 * second < least:
                load(tour, first, second)

    def construct(self, k: int) -> None:
        """Offer a tour that is constructed under weight k, whose candidates are ranked."""
        scalarization = self.scalarization(k)
        self.load_start(self.local_search, scalarization, construct=True)
        offer(self.local_search.working, scalarization, self.state.archive)

    def _best_tour(self, scalarization: Scalarization) -> tuple[Cities, float, float] | None:
        """Return the best tour known for a weighted sum and its lengths, if there is any."""
        archive = self.state.archive
        if archive.counts[0] == 0:
            return None
        k = best_point(archive, scalarization.w0, scalarization.w1)
        tour: Cities = archive.tours[archive.slots[k]]
        first, second = archive.points[k].tolist()
        if self.large:  # may have been offered on the way, with lengths as updated
            first, second = lengths(scalarization.costs, tour)
        return tour, first, second

    def descend(self, k: int, construct: bool) -> Iterator[int]:
        """Descend to a local optimum under weight k, whose candidates are ranked."""
        scalarization = self.scalarization(k)
        self.load_start(self.local_search, scalarization, construct)
        cities = self.local_search.working.tour if self.touched is None else self.touched
        yield from self._sweep(scalarization, cities, offering=self.large and not construct)
        yield 1

    def descend_from_neighbours(self, k: int, assembling: bool) -> Iterator[int]:
        """Descend under weight k from the best tours under the weights before and after it.

        With `assembling`, and symmetric costs, the best tour then takes the better parts of the
        tours found, and of the best one before.
        """
        scalarization = self.scalarization(k)
        assembling = assembling and scalarization.costs.symmetric
        tours = []
        if assembling and (known := self._best_tour(scalarization)) is not None:
            tours.append(known[0].copy())
        last = len(self.state.weighted_candidates.weights) - 1
        for neighbour in {max(k - 1, 0), min(k + 1, last)} - {k}:
            self.load_start(self.local_search, self.scalarization(neighbour))
            cities = self.local_search.working.tour
            yield from self._sweep(scalarization, cities, offering=True)
            if assembling:
                tours.append(cities.copy())
        if assembling:
            yield from self._assemble(scalarization, tours)

    def _assemble(self, scalarization: Scalarization, tours: Sequence[Cities]) -> Iterator[int]:
        """Put the better parts of these tours into the best one, and descend from there."""
        local_search, working = self.local_search, self.local_search.working
        self.load_start(local_search, scalarization)
        value = scalarization.w0 * working.length[0] + scalarization.w1 * working.length[1]
        gained, threshold = 0.0, least_gain(scalarization, value)
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
        working, archive = self.local_search.working, self.state.archive
        enqueue_cities(working, cities)
        block = 1 + self.n // OFFERS if offering else DESCENT_BLOCK
        while self.local_search.descend(scalarization, block) == 0:
            if offering:  # with lengths as updated: to sum them afresh takes as long as the rest
                insert(archive, (working.length[0], working.length[1]), working.tour)
            yield 0
        sum_afresh(working, scalarization)
        offer(working, scalarization, archive)
