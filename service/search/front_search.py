"""The base of the searches for two and for more objectives: the front found so far."""

from abc import ABC, abstractmethod
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from service.front import SearchResult
from service.instance import Instance, tour_lengths
from service.search.archive import Archive
from service.search.best_subset import SHORTLY, best_subset
from service.search.candidates import Scalarization
from service.search.closing import closed_tours, opened_tours
from service.search.front_points import FrontPoints
from service.search.several.archive import BlockArchive
from service.search.starts.constructed_tour import constructed_tour

Array = NDArray[np.float64]
Cities = NDArray[np.int32]


class FrontSearch(ABC):
    """A search for the front of one instance of at least eight cities.

    It depends on the seed and on what it has found, never on the clock: stopped after the same
    number of iterations, it has found the same.

    Searches are made of an instance, the seed of all random choices, a reference point, the most
    tours that are kept, and the cities that are touched.

    Args:
        instance: The instance.
        reference_point: Shape (m,), positive, in the instance's units.
        archive: The tours found so far.
        touched: If the tours that are added are those of an earlier front: the cities of the
            instance at which they may have become worse. Then no tour is constructed.
    """

    def __init__(
        self,
        instance: Instance,
        reference_point: Array,
        archive: Archive | BlockArchive,
        touched: NDArray[np.integer] | None,
    ) -> None:
        self.instance = instance
        self.reference_point = reference_point
        self.touched = None if touched is None else closed_tours(instance, touched[np.newaxis])[0]
        self._found = archive

    @abstractmethod
    def run(self) -> Iterator[int]:
        """Search, and yield about every millisecond the number of iterations done since.

        Ends when the search has converged.
        """

    @abstractmethod
    def _front(self) -> tuple[Cities, Array]:
        """Return the rows and the points of the archive in the order of the front."""

    @abstractmethod
    def _insert(self, tour: Cities) -> None:
        """Insert a closed tour unless it is dominated or equalled."""

    @abstractmethod
    def _accepts(self, tour: Cities) -> bool:
        """Return whether no tour of the front dominates or equals a closed tour."""

    @abstractmethod
    def _middle(self) -> Scalarization:
        """Return a weighted sum in which each objective counts."""

    @property
    def size(self) -> int:
        """The number of points of the front found so far."""
        return int(self._found.counts[0])

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
        return np.ldexp(self._front()[1], -self.instance.shifts)

    def tours(self, indices: NDArray[np.intp] | None = None) -> Cities:
        """Return the tours of the front, or those at indices, by ascending first length."""
        rows, _ = self._front()
        tours = self._found.tours[rows if indices is None else rows[indices]]
        return opened_tours(self.instance, tours)

    def add(self, tours: NDArray[np.integer]) -> None:
        """Add tours, shape (k, n), to the front."""
        for tour in closed_tours(self.instance, tours):
            self._insert(tour)

    def not_covered(self, tours: NDArray[np.integer]) -> NDArray[np.integer]:
        """Return the tours that the front neither dominates nor equals.

        Of tours that were added there are some only where a full archive had to drop them.
        """
        closed = closed_tours(self.instance, tours)
        return tours[[k for k in range(len(tours)) if self._accepts(closed[k])]]

    def construct(self) -> None:
        """Add a nearest-neighbour tour, at most O(n^2)."""
        self._insert(constructed_tour(self.instance, self._middle()))
