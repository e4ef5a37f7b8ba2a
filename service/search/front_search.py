"""The base of the searches for two and for more objectives: the front found so far."""

from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.front import SearchResult
from service.instance import Instance, tour_lengths
from service.search.archive.insertion import accepts, insert
from service.search.archive.layout import MAX_POINTS, make_archive, rows_of
from service.search.best_subset import SHORTLY, best_subset
from service.search.candidates import CANDIDATES_PER_CITY, Scalarization
from service.search.closing import closed_tours, opened_tours
from service.search.costs import make_costs, sum_lengths
from service.search.descents import Descents
from service.search.front_points import FrontPoints
from service.search.starts.constructed_tour import constructed_tour
from service.search.state import SearchState, WeightedCandidates
from service.search.three_opt.choice import choose_local_searches
from service.search.weights import search_weights
from service.search.working_tour import make_working_tour

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

CONSTRUCTIONS = 17  # weights for which a tour is constructed as well
BLOCK = 300  # iterations between two checks of the deadline, some milliseconds
PATIENCE = 1_000  # iterations per city without a new tour, after which the search has converged


class FrontSearch(ABC):
    """A search for the front of one instance of at least eight cities.

    It depends on the seed and on what it has found, never on the clock: stopped after the same
    number of iterations, it has found the same.

    Args:
        instance: The instance.
        seed: The seed of all random choices.
        reference_point: Shape (m,), positive, in the instance's units.
        capacity: The most tours that are kept.
        touched: If the tours that are added are those of an earlier front: the cities of the
            instance at which they may have become worse. Then no tour is constructed.
    """

    def __init__(
        self,
        instance: Instance,
        seed: int,
        reference_point: Array,
        capacity: int = MAX_POINTS,
        touched: NDArray[np.integer] | None = None,
    ) -> None:
        self.instance = instance
        self.reference_point = reference_point
        self.touched = None if touched is None else closed_tours(instance, touched[np.newaxis])[0]
        mending = touched is not None
        costs = make_costs(instance)
        self.n = len(costs.cities)
        self.weights = search_weights(instance, self.n, mending)
        candidates = np.zeros(
            (len(self.weights), self.n, min(CANDIDATES_PER_CITY, self.n - 1)), np.int32
        )
        self.state = SearchState(
            costs,
            WeightedCandidates(self.weights, candidates, np.zeros(candidates.shape)),
            make_archive(self.n, instance.objectives, capacity),
            make_working_tour(self.n),
            np.random.default_rng(seed).integers(1, 2**63 - 1, 1),
        )
        descent, self.local_search = choose_local_searches(self.state, mending)
        self.descents = Descents(instance, self.state, descent, self.touched)
        self._sorted = 0, np.empty(0, np.int32)  # tours ever inserted, and the rows then

    @abstractmethod
    def run(self) -> Iterator[int]:
        """Search, and yield about every millisecond the number of iterations done since.

        Ends when the search has converged.
        """

    @property
    @abstractmethod
    def middle(self) -> int:
        """The number of a weight under which each objective counts."""

    def iterate(
        self, k: int, scalarization: Scalarization, steps: int, block: int
    ) -> Iterator[int]:
        """Run iterated local search from the best tour known under weight k, block by block."""
        local_search = self.local_search
        self.descents.load_best(k, scalarization, local_search)
        for done in range(0, steps, block):
            now = min(steps - done, block)
            local_search.iterate(scalarization, now)
            yield now * local_search.effort

    @property
    def size(self) -> int:
        """The number of points of the front found so far."""
        return int(self.state.archive.counts[0])

    @property
    def allowed(self) -> bool:
        """Whether the tours found so far have no forbidden leg: either none of them has, or all."""
        first = self.tours(np.arange(min(1, self.size)))
        return len(first) > 0 and bool(np.isfinite(tour_lengths(self.instance, first)).all())

    def progress(self) -> tuple[float, int] | None:
        """Return the hypervolume and the number of points; None if no tour is allowed.

        The hypervolume of four objectives is that of a part of the front.
        """
        if not self.allowed:
            return None
        return FrontPoints(self.points(), self.reference_point).quick_hypervolume, self.size

    def best(self, size: int) -> SearchResult:
        """Return the best subset of a size of the front found so far."""
        points = self.points()
        indices = best_subset(FrontPoints(points, self.reference_point), size, SHORTLY)
        return SearchResult(points[indices], self.tours(indices).__getitem__, None)

    def points(self) -> Array:
        """Return the points of the front, shape (p, m), in the instance's units."""
        return np.ldexp(self.state.archive.points[self._rows()], -self.instance.shifts)

    def tours(self, indices: NDArray[np.intp] | None = None) -> Cities:
        """Return the tours of the front, or those at indices, by ascending first length."""
        rows = self._rows()
        tours = self.state.archive.tours[rows if indices is None else rows[indices]]
        return opened_tours(self.instance, tours)

    def _rows(self) -> Cities:
        """Return the rows of the archive in the order of the front."""
        inserted = int(self.state.archive.counts[2])
        if inserted != self._sorted[0]:  # else they are known already
            self._sorted = inserted, rows_of(self.state.archive)
        return self._sorted[1]

    def add(self, tours: NDArray[np.integer]) -> None:
        """Add tours, shape (k, n), to the front."""
        for tour in closed_tours(self.instance, tours):
            self._insert(tour)

    def not_covered(self, tours: NDArray[np.integer]) -> NDArray[np.integer]:
        """Return the tours that the front neither dominates nor equals.

        Of tours that were added there are some only where a full archive had to drop them.
        """
        closed = closed_tours(self.instance, tours)
        accepted = [k for k in range(len(tours)) if self._accepts(closed[k])]
        return tours[accepted]

    def construct(self) -> None:
        """Add a nearest-neighbour tour, at most O(n^2)."""
        self._insert(constructed_tour(self.instance, self.descents.scalarization(self.middle)))

    def _insert(self, tour: Cities) -> None:
        """Insert a closed tour unless it is dominated or equalled."""
        insert(self.state.archive, self._lengths(tour), tour)

    def _accepts(self, tour: Cities) -> bool:
        """Return whether no tour of the front dominates or equals a closed tour."""
        return accepts(self.state.archive, self._lengths(tour))

    def _lengths(self, tour: Cities) -> Array:
        """Return the scaled lengths of a closed tour, until the next are summed."""
        lengths = self.state.archive.lengths
        sum_lengths(self.state.costs, tour, lengths)
        return lengths
