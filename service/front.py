"""Values of planning: its options, the progress of a search, and fronts of tours."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from service.pareto import hypervolume
from service.preferences import angles

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Indices = NDArray[np.intp]
Termination = Literal["converged", "time_limit", "cancelled"]


@dataclass(frozen=True, eq=False)
class SearchResult:
    """A front: points, shape (p, 2), by ascending first length, and their tours.

    Args:
        points: The points.
        tours_at: Returns the tours, shape (k, n), of the points at indices, shape (k,). To copy
            those of a few takes far less than all, which can be a quarter of a GB.
        terminated: How the search ended; None while it goes on.
    """

    points: Array
    tours_at: Callable[[NDArray[np.intp]], NDArray[np.integer]]
    terminated: Termination | None

    @property
    def tours(self) -> NDArray[np.integer]:
        """All tours, shape (p, n)."""
        return self.tours_at(np.arange(len(self.points)))


@dataclass(frozen=True)
class Progress:
    """The state of a search that goes on: seconds, hypervolume and nondominated points so far."""

    seconds: float
    hypervolume: float
    points: int


A = TypeVar("A")
B = TypeVar("B")
# Takes the progress of a search, and a function that returns its best front so far of n tours.
ReportOf = Callable[[Progress, Callable[[int], A]], None]


def reporting(report: ReportOf[B], converted: Callable[[A], B]) -> ReportOf[A]:
    """Return a function that reports fronts after their conversion."""
    return lambda progress, best: report(progress, lambda size: converted(best(size)))


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanOptions:
    """The options of plan(...).

    Args:
        angles: Of the preferences for which tours are constructed, in degrees, shape (k,).
        fewer: Whether within a time limit fewer preferences will do: at most k, evenly spread, as
            many as fit into the network's share of it.
        size: The greatest number of tours of the front.
        start: The city from which every closed tour is reported.
        reference_point: Of the hypervolume, shape (2,), in the instance's units; by default
            the instance's.
        time_limit: Seconds for construction, search and selection together, not for the bound;
            at 0 there is no search.
        initial_tours: Shape (m, n): tours that the front shall dominate or equal as well.
        bound: Whether to compute an upper bound on the hypervolume of any front.
        seed: Of the search's random choices.
        touched: Where the initial tours are of an earlier front: the cities at which they may have
            become worse. The search sets out from these tours alone then, and looks there first.
        repairs: How often the constructor repairs each of its tours, at most; with a time limit
            only as often as is estimated to fit.
        fewer_repairs: Whether as many repairs will do as are worth their time at this size.
        choose_again: Called with what was found and the indices of the best subset of the size:
            returns those of the tours to report. None reports the best subset.
    """

    angles: Array
    size: int
    fewer: bool = False
    start: int = 0
    reference_point: Array | None = None
    time_limit: float = 0.0
    initial_tours: Tours | None = None
    bound: bool = False
    seed: int = 0
    touched: NDArray[np.integer] | None = None
    repairs: int = 0
    fewer_repairs: bool = False
    choose_again: Callable[[SearchResult, Indices], Indices] | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated tours and their points, by ascending first length.

    Attributes:
        tours: One tour a row, shape (m, n).
        points: Their lengths, shape (m, 2).
        found: The number of nondominated tours found, of which m were kept.
        constructed: The number of tours that the network built.
        scale: Of the instance, shape (2,).
        reference_point: Of the hypervolumes, shape (2,).
        terminated: How the search ended; None while it goes on.
        timings: Milliseconds by phase.
        bound: A hypervolume that no front of the instance exceeds, where it was asked for.
        gained: The hypervolume that the search added to that of the tours it was given.
        closed: Whether the tours return to where they began.
        kept: The share of a driven tour's legs that each tour keeps, shape (m,), when replanned.
    """

    tours: NDArray[np.integer]
    points: Array
    found: int
    constructed: int
    scale: Array
    reference_point: Array
    terminated: Termination | None
    timings: dict[str, float]
    bound: float | None = None
    gained: float | None = None
    closed: bool = True
    kept: Array | None = None

    @property
    def n(self) -> int:
        """The number of cities."""
        return self.tours.shape[1]

    @cached_property
    def hypervolume(self) -> float:
        """The hypervolume of the tours kept, with respect to the reference point."""
        return hypervolume(self.points, self.reference_point)

    @cached_property
    def angles(self) -> Array:
        """The direction of each point in scaled objective space, in degrees, shape (m,)."""
        return angles(self.points, self.scale)
