"""plan(...): from an instance to its front.

A constructor, which is a network, builds first tours; the search improves them; the best subset
of the size asked for is reported. Nothing here knows of HTTP, jobs or files.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.errors import Cancelled
from service.instance import Instance, symmetries, tour_lengths
from service.pareto import best_subset, hypervolume, nondominated
from service.preferences import angles, from_angles
from service.search.bound import hypervolume_bound
from service.search.improve import Progress, SearchResult, Termination, improve
from service.search.open_routes import built_tours, oriented, plain_tours

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
BOUND_SECONDS = 5.0  # after these a bound, which is valid all along, is tight enough
MIN_CONSTRUCTED = 3  # cities: no network was trained on fewer


class Constructor(Protocol):
    """A builder of tours from nothing but an instance and preferences."""

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """Return closed tours, shape (k, n), one a preference (k, 2), or raise Cancelled."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanOptions:
    """The options of plan(...).

    Args:
        angles: Of the preferences for which tours are constructed, in degrees, shape (k,).
        size: The greatest number of tours of the front.
        start: The city from which every closed tour is reported.
        reference_point: Of the hypervolume, shape (2,), in the instance's units; by default n
            times the scale.
        time_limit: Seconds for the search; at 0 there is no search.
        initial_tours: Shape (m, n): tours that the front shall dominate or equal as well.
        bound: Whether to compute an upper bound on the hypervolume of any front.
        seed: Of the search's random choices.
        augment: How often the constructor is called, each time with another symmetry of the
            coordinates and with angles between those of the other calls.
    """

    angles: Array
    size: int
    start: int = 0
    reference_point: Array | None = None
    time_limit: float = 0.0
    initial_tours: Tours | None = None
    bound: bool = False
    seed: int = 0
    augment: int = 1

    @property
    def needs_compiled_code(self) -> bool:
        """Whether the plan runs compiled code: the search, the bound or the best subset."""
        constructed = len(self.angles) * self.augment
        return self.time_limit > 0 or self.bound or constructed > self.size


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated tours and their points, by ascending first length.

    Attributes:
        tours: One tour a row, shape (m, n).
        points: Their lengths, shape (m, 2).
        found: The number of nondominated tours found, of which m were kept.
        scale: Of the instance, shape (2,).
        reference_point: Of the hypervolumes, shape (2,).
        terminated: How the search ended; None while it goes on.
        timings: Milliseconds by phase.
        bound: A hypervolume that no front of the instance exceeds, where it was asked for.
        gained: The hypervolume that the search added to that of the tours it was given.
    """

    tours: NDArray[np.integer]
    points: Array
    found: int
    scale: Array
    reference_point: Array
    terminated: Termination | None
    timings: dict[str, float]
    bound: float | None = None
    gained: float | None = None

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
        return angles(self.points / self.scale)

    def nearest(self, angle: float) -> int:
        """Return the index of the tour whose direction is nearest to the angle in degrees."""
        return int(np.abs(self.angles - angle).argmin())


Report = Callable[[Progress, Callable[[int], Front]], None]


def plan(
    constructor: Constructor,
    instance: Instance,
    options: PlanOptions,
    stop: Callable[[], bool] = lambda: False,
    report: Report = lambda *_: None,
) -> Front:
    """Return the best front found for an instance within the time limit.

    Args:
        constructor: Builds the tours that the search starts from.
        instance: The instance.
        options: What front is wanted, and how much may be spent on it.
        stop: Called every millisecond or two; True ends the planning with what was found so far.
        report: Called about ten times a second with the progress of the search, and with a function
            that gives the best front so far of at most so many tours.

    Raises:
        Cancelled: The constructor was told to stop before it had a tour.
    """
    clock = _Clock()
    reference_point = _reference_point(instance, options)
    options = replace(options, reference_point=reference_point)
    first = _first_tours(constructor, instance, options, stop)
    clock.ends("construction")
    tours, points, terminated = _improved(instance, first, options, stop, report)
    clock.ends("improvement")
    searched = options.time_limit > 0
    gained = _gained(instance, first, points, reference_point) if searched else None
    chosen = best_subset(points, options.size, reference_point, stop)
    clock.ends("selection")
    bound = None
    if options.bound and not stop():
        deadline = time.monotonic() + BOUND_SECONDS
        bound = hypervolume_bound(instance, reference_point, deadline, stop)
    clock.ends("bound")
    return Front(
        tours=_as_reported(instance, options.start, tours[chosen]),
        points=points[chosen],
        found=len(points),
        scale=instance.scale,
        reference_point=reference_point,
        terminated=terminated,
        timings=clock.phases,
        bound=bound,
        gained=gained,
    )


def _reference_point(instance: Instance, options: PlanOptions) -> Array:
    if options.reference_point is not None:
        return options.reference_point
    return instance.n * instance.scale


def _first_tours(
    constructor: Constructor, instance: Instance, options: PlanOptions, stop: Callable[[], bool]
) -> Tours:
    """Return the constructor's tours, then the caller's."""
    tours = _constructed(constructor, instance, options, stop)
    if options.initial_tours is None:
        return tours
    return np.concatenate((tours, options.initial_tours))


def _constructed(
    constructor: Constructor, instance: Instance, options: PlanOptions, stop: Callable[[], bool]
) -> Tours:
    """Return a tour for each angle and each of the symmetries, until told to stop."""
    if instance.n < MIN_CONSTRUCTED:
        return plain_tours(instance).astype(np.int64)
    tours = []
    for call, image in enumerate(symmetries(instance, options.augment)):
        angles = _shifted(options.angles, call / options.augment)
        try:
            tours.append(built_tours(constructor.tours, image, from_angles(angles)))
        except Cancelled:
            if not tours:
                raise
            break
        if stop():
            break
    return np.concatenate(tours)


def _shifted(angles: Array, share: float) -> Array:
    """Return the angles, each shifted by a share of the way to the next; the last stays."""
    index = np.arange(len(angles))
    return np.interp(index + share, index, angles)


def _improved(
    instance: Instance,
    tours: Tours,
    options: PlanOptions,
    stop: Callable[[], bool],
    report: Report,
) -> tuple[Tours, Array, Termination | None]:
    """Return nondominated tours, their points, and why the search for them ended."""
    if options.time_limit == 0:
        points = tour_lengths(instance, tours)
        front = nondominated(points)
        return tours[front], points[front], "converged"
    found = improve(
        instance,
        tours,
        deadline=time.monotonic() + options.time_limit,
        seed=options.seed,
        stop=stop,
        report=lambda progress, best: report(
            progress, partial(_best_front, instance, options, progress, best)
        ),
        reference_point=options.reference_point,
    )
    return found.tours.astype(np.int64), found.points, found.terminated


def _best_front(
    instance: Instance,
    options: PlanOptions,
    progress: Progress,
    best: Callable[[int], SearchResult],
    size: int,
) -> Front:
    """Return the best tours found so far, at most `size` of them."""
    found = best(min(size, options.size))
    return Front(
        tours=_as_reported(instance, options.start, found.tours),
        points=found.points,
        found=progress.points,
        scale=instance.scale,
        reference_point=_reference_point(instance, options),
        terminated=None,
        timings={},
    )


def _gained(instance: Instance, first: Tours, points: Array, reference_point: Array) -> float:
    """Return the hypervolume that the search added to that of the first tours."""
    before = hypervolume(tour_lengths(instance, first), reference_point)
    return hypervolume(points, reference_point) - before


def _as_reported(instance: Instance, start: int, tours: NDArray[np.integer]) -> NDArray[np.integer]:
    """Return closed tours rotated so that they begin at a city; open routes in their direction."""
    if not instance.closed:
        return oriented(instance, tours)
    n = tours.shape[1]
    first = (tours == start).argmax(axis=1)
    return np.take_along_axis(tours, (first[:, np.newaxis] + np.arange(n)) % n, axis=1)


class _Clock:
    """A stopwatch: the milliseconds that each phase took, by name."""

    def __init__(self) -> None:
        self.phases: dict[str, float] = {}
        self._since = time.perf_counter()

    def ends(self, phase: str) -> None:
        now = time.perf_counter()
        self.phases[phase] = 1000 * (now - self._since)
        self._since = now
