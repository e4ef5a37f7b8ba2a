"""The values of planning: options, the result of a search, and fronts of tours."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.preferences import angles
from service.watch import Watch

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Indices = NDArray[np.intp]
Termination = Literal["converged", "time_limit", "cancelled"]

BOUND_SECONDS = 5.0  # for tightening a bound; it is valid at any time


@dataclass(frozen=True, eq=False)
class SearchResult:
    """A front: points, shape (p, m), by ascending first length, and their tours.

    Args:
        points: The points.
        tours_at: Returns the tours, shape (k, n), of the points at indices, shape (k,). Copying a
            few tours is much faster than copying all: these may take a quarter of a GB.
        terminated: How the search ended; None while it runs.
    """

    points: Array
    tours_at: Callable[[NDArray[np.intp]], NDArray[np.integer]]
    terminated: Termination | None

    @property
    def tours(self) -> NDArray[np.integer]:
        """All tours, shape (p, n)."""
        return self.tours_at(np.arange(len(self.points)))


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanOptions:
    """The options of plan(...).

    Args:
        directions: The preferences for which tours are constructed, shape (k, m), as
            service.preferences has them.
        fewer: Whether a time limit may reduce the number of preferences to those that fit into the
            network's share of the time. These are evenly spread.
        size: The greatest number of tours of the front.
        start: The city at which every reported closed tour begins.
        reference_point: The reference point of the hypervolume, shape (m,), in the instance's
            units; by default the reference point of the instance.
        time_limit: The most seconds for construction, search and selection together, without the
            bound; with 0 only the network plans.
        initial_tours: Tours, shape (m, n). The front must dominate or equal each of them.
        bound: Whether to compute an upper bound on the hypervolume of any front.
        seed: The seed of the search's random choices.
        touched: Only with initial tours of an earlier front: the cities at which they may have
            become worse. The search then starts from these tours alone, and tries these cities
            first.
        repairs: The most repairs of each constructed tour; with a time limit, only as many as are
            estimated to fit.
        fewer_repairs: Whether the planner may make fewer repairs: as many as are worth their time
            at this size.
        choose_again: Called with the result of the search and the indices of its best subset.
            Returns the indices of the tours to report. None reports the best subset.
    """

    directions: Array
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


# Improves tours of an instance, as long as its watch says.
SearchFunction = Callable[
    [Instance, NDArray[np.integer], PlanOptions, Watch[SearchResult]], SearchResult
]


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated tours and their points, by ascending first length.

    Attributes:
        tours: One tour a row, shape (k, n).
        points: Their lengths, shape (k, m).
        found: The number of nondominated tours found; k of these were kept.
        constructed: The number of tours that the network built.
        scale: The scale of the instance, shape (m,).
        reference_point: The reference point of the hypervolumes, shape (m,).
        hypervolume: The hypervolume of the tours kept.
        terminated: How the search ended; None while it runs.
        timings: Milliseconds by phase.
        bound: A hypervolume that no front of the instance exceeds, if it was asked for.
        gained: The hypervolume that the search added to that of its initial tours.
        closed: Whether the tours return to where they began.
        kept: In a replanned front, the share of the driven tour's legs that each tour keeps, shape
            (k,).
        departures: Over a day, when each tour begins, in seconds of the day, shape (k,).
        reached: Over a day, all lengths of each tour up to each of its places, and to its end,
            shape (k, n + 1, m).
        clock: Over a day, the index of the objective that is seconds.
        means: Where costs spread, the mean lengths of each tour, shape (k, m).
        p90: Where costs spread, the lengths that nine days of ten do not exceed, shape (k, m).
        leg_paths: Over a map with detours, the number of the path that each leg of each tour takes,
            shape (k, legs).
    """

    tours: NDArray[np.integer]
    points: Array
    found: int
    constructed: int
    scale: Array
    reference_point: Array
    hypervolume: float
    terminated: Termination | None
    timings: dict[str, float]
    bound: float | None = None
    gained: float | None = None
    closed: bool = True
    kept: Array | None = None
    departures: Array | None = None
    reached: Array | None = None
    clock: int = 0
    means: Array | None = None
    p90: Array | None = None
    leg_paths: NDArray[np.int8] | None = None

    @property
    def times(self) -> Array | None:
        """Over a day, when each tour reaches each of its places and its end, shape (k, n + 1).

        In seconds of the day. An open route ends when its last visit has ended.
        """
        if self.departures is None or self.reached is None:
            return None
        return self.departures[:, np.newaxis] + self.reached[:, :, self.clock]

    @property
    def n(self) -> int:
        """The number of cities."""
        return self.tours.shape[1]

    @cached_property
    def angles(self) -> Array:
        """The direction of each point of two scaled objectives, in degrees, shape (k,)."""
        return angles(self.points, self.scale)
