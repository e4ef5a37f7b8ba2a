"""plan(...): from an instance to its front.

A constructor, which is a network, builds first tours; the search improves them; the best subset
of the size asked for is reported. The time limit is that of all three together. Nothing here knows
of HTTP, jobs or files.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from service.construction.first_tours import MIN_CONSTRUCTED, SHARE, Constructor, construct
from service.construction.repairs import TOURS_REPAIRED, repairs_worth
from service.errors import Cancelled, NoTour, Obstacle
from service.instance import Instance, tour_lengths
from service.pareto import best_subset, hypervolume, nondominated, selection_seconds
from service.preferences import angles
from service.search.bound.hypervolume import hypervolume_bound
from service.search.enumeration import MAX_ENUMERATED
from service.search.forbidden_legs import tightest
from service.search.improve import Progress, SearchResult, Termination, improve
from service.search.open_routes import oriented, plain_tours, rotated

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Indices = NDArray[np.intp]
BOUND_SECONDS = 5.0  # after these a bound, which is valid all along, is tight enough


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanOptions:
    """The options of plan(...).

    Args:
        angles: Of the preferences for which tours are constructed, in degrees, shape (k,).
        fewer: Whether fewer preferences will do within a time limit: up to k, evenly spread, as
            many as fit into the network's share of it.
        size: The greatest number of tours of the front.
        start: The city from which every closed tour is reported.
        reference_point: Of the hypervolume, shape (2,), in the instance's units; by default
            the instance's.
        time_limit: Seconds for construction, search and selection together, not for the bound;
            at 0 there is no search.
        initial_tours: Shape (m, n): tours that the front shall dominate or equal.
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

    @property
    def needs_compiled_code(self) -> bool:
        """Whether the plan runs compiled code: the search, the bound or the best subset."""
        constructed = len(self.angles) * (TOURS_REPAIRED if self.repairs > 0 else 1)
        return self.time_limit > 0 or self.bound or constructed > self.size


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
            that returns the best front so far of at most n tours.

    Raises:
        Cancelled: It was told to stop before it had a tour.
        NoTour: Every tour that was found has a forbidden leg.
    """
    clock = _Clock()
    deadline = time.monotonic() + options.time_limit
    reference_point = options.reference_point
    if reference_point is None:
        reference_point = instance.reference_point
    options = replace(options, reference_point=reference_point)
    constructed = _constructed(constructor, instance, options)
    first = _first_tours(instance, constructed, options)
    searched = options.time_limit > 0
    before = hypervolume(tour_lengths(instance, first), reference_point) if searched else None
    clock.ends("construction")
    report_front = partial(_report_front, instance, options, len(constructed), report)
    found = _improved(instance, first, options, deadline, stop, report_front)
    clock.ends("improvement")
    if not len(found.points):
        raise Cancelled if stop() else _no_tour(instance, options, found)
    gained = None if before is None else hypervolume(found.points, reference_point) - before
    chosen = best_subset(found.points, options.size, reference_point, stop)
    if options.choose_again is not None:
        chosen = options.choose_again(found, chosen)
    tours = found.tours_at(chosen).astype(np.int64)
    clock.ends("selection")
    bound = None
    if options.bound and not stop():
        until = time.monotonic() + BOUND_SECONDS
        bound = hypervolume_bound(instance, reference_point, until, stop)
    clock.ends("bound")
    return Front(
        tours=_as_reported(instance, options.start, tours),
        points=found.points[chosen],
        found=len(found.points),
        constructed=len(constructed),
        scale=instance.scale,
        reference_point=reference_point,
        terminated=found.terminated,
        timings=clock.phases,
        bound=bound,
        gained=gained,
        closed=instance.closed,
    )


def _constructed(constructor: Constructor, instance: Instance, options: PlanOptions) -> Tours:
    """Return the constructor's tours."""
    repairs = options.repairs
    if options.fewer_repairs:
        repairs = min(repairs, repairs_worth(constructor.estimate.inputs, instance.n))
    limit = options.time_limit if options.time_limit > 0 else None
    within = SHARE * limit if limit is not None and options.fewer else None
    return construct(constructor, instance, options.angles, repairs, within=within, limit=limit)


def _first_tours(instance: Instance, constructed: Tours, options: PlanOptions) -> Tours:
    """Return the constructed tours, then the caller's; for one or two cities all tours."""
    tours = [constructed]
    if instance.n < MIN_CONSTRUCTED:
        tours.append(plain_tours(instance).astype(np.int64))
    if options.initial_tours is not None:
        tours.append(options.initial_tours)
    return np.concatenate(tours)


def _improved(
    instance: Instance,
    tours: Tours,
    options: PlanOptions,
    deadline: float,
    stop: Callable[[], bool],
    report: Callable[[Progress, Callable[[int], SearchResult]], None],
) -> SearchResult:
    """Return the result of a search that leaves enough time to select from it."""
    if options.time_limit == 0:
        points = tour_lengths(instance, tours)
        front = nondominated(points)
        return SearchResult(points[front], tours[front].__getitem__, "converged")
    return improve(
        instance,
        tours,
        deadline=deadline,
        reserve=partial(selection_seconds, options.size),
        seed=options.seed,
        stop=stop,
        report=report,
        reference_point=options.reference_point,
        touched=options.touched,
    )


def _report_front(
    instance: Instance,
    options: PlanOptions,
    constructed: int,
    report: Report,
    progress: Progress,
    best: Callable[[int], SearchResult],
) -> None:
    """Report the progress of the search, with the best tours found so far on demand."""

    def best_front(size: int) -> Front:
        assert options.reference_point is not None
        found = best(min(size, options.size))
        return Front(
            tours=_as_reported(instance, options.start, found.tours),
            points=found.points,
            found=progress.points,
            constructed=constructed,
            scale=instance.scale,
            reference_point=options.reference_point,
            terminated=None,
            timings={},
            closed=instance.closed,
        )

    report(progress, best_front)


def _no_tour(instance: Instance, options: PlanOptions, result: SearchResult) -> NoTour:
    """Return the refusal of an instance for which no tour without a forbidden leg was found."""
    if options.time_limit == 0:
        found = "was built by the network: a time_limit above 0 has a search look for one"
    elif instance.n <= MAX_ENUMERATED and result.terminated == "converged":
        found = "exists: all were tried"
    else:
        found = f"was found in {options.time_limit:g} s"
    fewest = "the fewest ways lead to and from {cities}"
    sentence = f"no tour without a forbidden leg {found}; {fewest}"
    return NoTour([Obstacle(sentence, tightest(instance))])


def _as_reported(instance: Instance, start: int, tours: NDArray[np.integer]) -> NDArray[np.integer]:
    """Return closed tours rotated so that they begin at a city; open routes in their direction."""
    if not instance.closed:
        return oriented(instance, tours)
    return rotated(tours, (tours == start).argmax(axis=1))


class _Clock:
    """A stopwatch: the milliseconds that each phase took, by name."""

    def __init__(self) -> None:
        self.phases: dict[str, float] = {}
        self._since = time.perf_counter()

    def ends(self, phase: str) -> None:
        now = time.perf_counter()
        self.phases[phase] = 1000 * (now - self._since)
        self._since = now
