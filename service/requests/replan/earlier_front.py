"""The front that is replanned: its stops or places, costs, ends and tours, from what is stored."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import Coverage
from service.errors import Refusal
from service.instance import CLOSED, RouteEnds
from service.pareto import balances, knee
from service.requests.stops import Labels, Objective, Source, Stop, Stops
from service.requests.task import Task, TaskSource
from service.search.open_routes import rotated

Array = NDArray[np.float64]
_NAMES = ("first", "second")  # of objectives that the front's request did not name


class FoundTours(Protocol):
    """The tours of a front, as they are stored."""

    @property
    def orders(self) -> NDArray[np.int64]:
        """The stops or places of each tour in order, shape (m, n)."""

    @property
    def lengths(self) -> Array:
        """The lengths of each tour, shape (m, 2)."""

    @property
    def places(self) -> Sequence[Sequence[int]] | None:
        """Of a front of a map, row and column of each place."""


@dataclass(frozen=True, eq=False)
class StoredFront:
    """A front as it is stored: its id, what it was planned from, and its tours."""

    id: str
    source: TaskSource
    found: FoundTours


@dataclass(frozen=True, eq=False)
class EarlierFront:
    """A front that is replanned.

    Args:
        labels: The names of its stops and objectives; their numbers, if it has no names.
        sources: The source of the costs of each objective; none of a front of a map.
        ends: Whether its tours are closed, and the ends of open routes.
        start: The stop that closed tours are reported from.
        tours: The stops of each tour in order, shape (m, n).
        lengths: The lengths of each tour, shape (m, 2).
    """

    labels: Labels
    sources: Sequence[Source]
    ends: RouteEnds
    start: int
    tours: NDArray[np.int64]
    lengths: Array

    @property
    def knee(self) -> NDArray[np.int64]:
        """The tour with the least sum of lengths, each in the front's own box, shape (n,)."""
        return self.tours[knee(self.lengths)]

    @property
    def n(self) -> int:
        """The number of stops."""
        return len(self.labels.stops)

    def balance_of(self, tour: NDArray[np.int64]) -> float | None:
        """Return the balance of a tour in the front; None if the front does not have it."""
        same = (self.from_start(self.tours) == self.from_start(tour[np.newaxis])).all(axis=1)
        return float(balances(self.lengths)[same.argmax()]) if same.any() else None

    def from_start(self, tours: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return tours of the front's stops, shape (m, n); closed ones begin at their start."""
        if not self.ends.closed:
            return tours
        return rotated(tours, (tours == self.start).argmax(axis=1))


def earlier_front(stored: StoredFront, task: Task, stops: Stops) -> EarlierFront:
    """Return the front of a task of stops.

    Raises:
        Refusal: It has no tours, or its tours are not of its stops.
    """
    tours, lengths = _tours(stored, stops.n), stored.found.lengths
    labels = task.labels or _numbered(stops.n)
    return EarlierFront(labels, stops.sources, stops.ends, task.options.start, tours, lengths)


def earlier_front_of_map(stored: StoredFront, coverage: Coverage) -> EarlierFront:
    """Return the front of a coverage task, whose places are named by their indexes.

    Raises:
        Refusal: It has no tours, or its tours are not of its places.
    """
    n = len(stored.found.places or ())
    tours = _tours(stored, n)
    ends, start = CLOSED, int(tours[0, 0])
    if not coverage.ends.closed:
        starts = coverage.start_pose is not None or coverage.ends.start is not None
        ends_there = coverage.end_pose is not None or coverage.ends.end is not None
        last = int(tours[0, -1])
        ends = RouteEnds(False, start if starts else None, last if ends_there else None)
    return EarlierFront(_numbered(n), (), ends, start, tours, stored.found.lengths)


def not_replannable(front: str, reason: str) -> Refusal:
    """Return the refusal of a front that cannot be replanned."""
    return Refusal("not-replannable", front=front, reason=reason)


def _tours(stored: StoredFront, n: int) -> NDArray[np.int64]:
    """Return the tours of a front of n stops, shape (m, n)."""
    tours = stored.found.orders
    if not len(tours):
        raise not_replannable(stored.id, "it has no tour")
    if tours.shape[1] != n:
        raise not_replannable(stored.id, "its tours are not of its stops")
    return tours


def _numbered(n: int) -> Labels:
    """Return labels for stops and objectives without names."""
    stops = tuple(Stop(str(index)) for index in range(n))
    return Labels(stops, tuple(Objective(name) for name in _NAMES))
