"""A local search that pushes the whole front of an instance forward, for as long as it may.

Weighted sums are searched first, each from the best tour that the others have found; then the
front is filled between what they reach. Everything nondominated that is visited is kept.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.instance import MOST_ENUMERATED, Instance, all_tours, tour_lengths
from service.pareto import best_subset, nondominated
from service.search.bound import hypervolume_bound
from service.search.schedule import Search

Array = NDArray[np.float64]
Termination = Literal["converged", "time_limit", "cancelled"]

REPORT_EVERY = 0.1  # seconds


@dataclass(frozen=True, eq=False)
class Improved:
    """A front: tours, shape (p, n), and points, shape (p, 2), by ascending first length."""

    tours: NDArray[np.int32]
    points: Array
    terminated: Termination | None  # none while the search goes on


@dataclass(frozen=True)
class Progress:
    """How far a search has come.

    `best` copies the best so many tours found so far, and may be asked until the report returns.
    """

    seconds: float
    hypervolume: float
    points: int
    best: Callable[[int], Improved]


def improve(  # noqa: PLR0913  all but the first two are keyword-only and have a default
    instance: Instance,
    tours: NDArray[np.integer],
    *,
    deadline: float | None = None,
    iterations: int | None = None,
    seed: int = 0,
    stop: Callable[[], bool] | None = None,
    report: Callable[[Progress], None] | None = None,
    reference_point: Array | None = None,
) -> Improved:
    """The front that a search finds, each of the given tours dominated or equalled by it.

    Args:
        instance: What is planned.
        tours: Tours to set out from, shape (m, n); m may be 0.
        deadline: When to stop, as a moment of time.monotonic(); None sets no limit.
        iterations: How many local optima to visit; None sets no limit. Without a deadline, the
            same seed and the same iterations give the same front.
        seed: Of all random choices.
        stop: Asked every millisecond or two; True ends the search at once.
        report: Told now and then how far the search has come.
        reference_point: For the reported hypervolume, in the instance's units; (n, n) scaled
            unless given. The search puts its effort where this hypervolume grows.
    """
    if instance.n <= MOST_ENUMERATED:
        return _front(instance, all_tours(instance.n), "converged")
    if reference_point is None:
        reference_point = instance.n * instance.scale
    search = Search(instance, seed, reference_point)
    search.add(tours)
    terminated = _watch(search, deadline, iterations, stop, report)
    if not search.found:
        search.add(np.arange(instance.n)[None])
    lost = search.missing(tours)
    if len(lost):
        return _front(instance, np.concatenate((search.tours(), lost)), terminated)
    return Improved(search.tours(), search.points(), terminated)


def _watch(
    search: Search,
    deadline: float | None,
    iterations: int | None,
    stop: Callable[[], bool] | None,
    report: Callable[[Progress], None] | None,
) -> Termination:
    """Lets a search run until it has converged or is out of time, of iterations or of favour."""
    began = reported = time.monotonic()
    spent = 0
    for done in search.run():
        spent += done
        now = time.monotonic()
        if stop is not None and stop():
            return "cancelled"
        if (deadline is not None and now >= deadline) or (
            iterations is not None and spent >= iterations
        ):
            return "time_limit"
        if report is not None and now - reported >= REPORT_EVERY:
            reported = now
            report(Progress(now - began, search.share, search.found, partial(_best, search)))
    return "converged"


def _best(search: Search, size: int) -> Improved:
    """The best so many of what a search has found so far."""
    points = search.points()
    kept = best_subset(points, size, search.corner / search.units)
    return Improved(search.tours(kept), points[kept], None)


def _front(instance: Instance, tours: NDArray[np.integer], terminated: Termination) -> Improved:
    """The nondominated among tours."""
    points = tour_lengths(instance, tours)
    kept = nondominated(points)
    return Improved(tours[kept].astype(np.int32), points[kept], terminated)


def warm_up() -> None:
    """Compiles all that a request can need, or loads it from the cache of an earlier process."""
    cities = np.arange(12.0)
    coordinates = np.stack([cities, cities**2 % 11, cities**2 % 7, cities], axis=1)
    matrices = np.outer(cities, cities)[None] % np.array([7, 5]).reshape(2, 1, 1)
    none = np.empty((0, 12), np.int32)
    points = np.stack([cities, 12 - cities], axis=1)
    best_subset(points, 3, np.full(2, 13.0))
    for instance in (Instance(coordinates=coordinates), Instance(matrices=np.triu(matrices))):
        improve(instance, none, iterations=5_000)
        hypervolume_bound(instance, 12 * instance.scale)
