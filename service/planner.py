"""plan(...): from an instance to its front.

A constructor, which is a network, builds first tours. The search improves them. The best subset of
the requested size is reported. The time limit holds for all three together. Nothing here knows of
HTTP, jobs or files.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from service.construction.first_tours import MIN_CONSTRUCTED, SHARE, Constructor, construct
from service.construction.repairs import repairs_worth
from service.errors import Cancelled, NoTour, Obstacle
from service.front import BOUND_SECONDS, Front, PlanOptions, SearchFunction, SearchResult
from service.instance import Instance, tour_lengths
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.bound.hypervolume import hypervolume_bound
from service.search.forbidden_legs import tightest
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.improve import improve
from service.search.nondominated import nondominated
from service.search.open_routes import oriented, plain_tours, rotated
from service.search.sizes import MAX_ENUMERATED
from service.watch import Progress, Watch

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Indices = NDArray[np.intp]
_PHASES = ("construction", "improvement", "selection", "bound")


def improved(
    instance: Instance,
    tours: NDArray[np.integer],
    options: PlanOptions,
    watch: Watch[SearchResult],
) -> SearchResult:
    """Return the result of a search that leaves enough time to select from it."""
    return improve(
        instance,
        tours,
        watch=watch,
        reserve=partial(
            selection_seconds,
            options.size,
            objectives=instance.objectives,
            seconds=selection_limit(options.time_limit),
        ),
        seed=options.seed,
        reference_point=options.reference_point,
        touched=options.touched,
    )


def plan(
    constructor: Constructor,
    instance: Instance,
    options: PlanOptions,
    watch: Watch[Front] | None = None,
    search: SearchFunction = improved,
) -> Front:
    """Return the best front found for an instance within the time limit.

    Args:
        constructor: Builds the tours that the search starts from.
        options: The options of the front and the search.
        watch: Asked every millisecond or two whether to stop; planning then ends with the best
            front so far. It also says when to report. The time limit is that of the options.
        search: Improves the first tours, where there is time.

    Raises:
        Cancelled: The watch said to stop before a tour was found.
        NoTour: Every tour that was found has a forbidden leg.
    """
    watch = (watch or Watch()).lasting(options.time_limit)
    times = [0.0]
    given = options.reference_point
    reference_point = instance.reference_point if given is None else given
    options = replace(options, reference_point=reference_point)
    constructed = _constructed(constructor, instance, options)
    first = _first_tours(instance, constructed, options)
    searched = options.time_limit > 0
    before = hypervolume(tour_lengths(instance, first), reference_point) if searched else None
    times.append(watch.spent)
    front_of = partial(
        Front,
        constructed=len(constructed),
        scale=instance.scale,
        reference_point=reference_point,
        closed=instance.closed,
    )

    def report_front(progress: Progress, best: Callable[[int], SearchResult]) -> None:
        def best_front(size: int) -> Front:
            found = best(min(size, options.size))
            tours = _as_reported(instance, options.start, found.tours)
            return front_of(
                tours=tours,
                points=found.points,
                hypervolume=hypervolume(found.points, reference_point),
                found=progress.points,
                terminated=None,
                timings={},
            )

        watch.report(progress, best_front)

    find = search if searched else _unsearched
    found = find(instance, first, options, watch.reporting(report_front))
    times.append(watch.spent)
    if not len(found.points):
        raise Cancelled if watch.stopped() else _no_tour(instance, options, found)
    front = FrontPoints(found.points, reference_point)
    gained = None if before is None else max(0.0, front.quick_hypervolume - before)
    chosen = _selected(found, front, options, watch)
    best, tours = front.at(chosen), found.tours_at(chosen).astype(np.int64)
    times.append(watch.spent)
    bound = _bound(instance, reference_point, watch) if options.bound else None
    times.append(watch.spent)
    return front_of(
        tours=_as_reported(instance, options.start, tours),
        points=best.points,
        hypervolume=best.hypervolume,
        found=len(front),
        terminated=found.terminated,
        timings=dict(zip(_PHASES, (1000 * np.diff(times)).tolist(), strict=True)),
        bound=bound,
        gained=gained,
    )


def _constructed(constructor: Constructor, instance: Instance, options: PlanOptions) -> Tours:
    """Return the constructor's tours."""
    repairs = options.repairs
    if options.fewer_repairs:
        inputs = constructor.estimate.inputs
        repairs = min(repairs, repairs_worth(inputs, instance.n, instance.objectives))
    limit = options.time_limit if options.time_limit > 0 else None
    within = SHARE * limit if limit is not None and options.fewer else None
    return construct(constructor, instance, options.directions, repairs, within=within, limit=limit)


def _first_tours(instance: Instance, constructed: Tours, options: PlanOptions) -> Tours:
    """Return the constructed tours, then the caller's; for one or two cities all tours."""
    plain = plain_tours(instance) if instance.n < MIN_CONSTRUCTED else constructed[:0]
    initial = constructed[:0] if options.initial_tours is None else options.initial_tours
    return np.concatenate((constructed, plain.astype(np.int64), initial))


def _unsearched(instance: Instance, tours: NDArray[np.integer], *_: object) -> SearchResult:
    """Return the nondominated among tours."""
    points = tour_lengths(instance, tours)
    front = nondominated(points)
    return SearchResult(points[front], tours[front].__getitem__, "converged")


def _selected(
    found: SearchResult, front: FrontPoints, options: PlanOptions, watch: Watch[Front]
) -> Indices:
    """Return the indices of the tours to report."""
    chosen = best_subset(front, options.size, selection_limit(options.time_limit), watch.stopped)
    if options.choose_again is None:
        return chosen
    return options.choose_again(found, chosen)


def _bound(instance: Instance, reference_point: Array, watch: Watch[Front]) -> float | None:
    """Return a bound on the hypervolume; None if the work is to stop."""
    if watch.stopped():
        return None
    return hypervolume_bound(instance, reference_point, watch.lasting(BOUND_SECONDS))


def _no_tour(instance: Instance, options: PlanOptions, result: SearchResult) -> NoTour:
    """Return the refusal of an instance for which no tour without a forbidden leg was found."""
    if options.time_limit == 0:
        why = "network-found-none"
    elif instance.n <= MAX_ENUMERATED and result.terminated == "converged":
        why = "none-exists"
    else:
        why = "none-in-time"
    return NoTour([Obstacle(why, tightest(instance), values={"seconds": options.time_limit})])


def _as_reported(instance: Instance, start: int, tours: NDArray[np.integer]) -> NDArray[np.integer]:
    """Return closed tours rotated so that they begin at a city; open routes in their direction."""
    if not instance.closed:
        return oriented(instance, tours)
    return rotated(tours, (tours == start).argmax(axis=1))
