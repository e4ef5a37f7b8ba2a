"""The middle of the program: from an instance to its front, with no HTTP in it."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, symmetries, tour_lengths
from service.pareto import best_subset, hypervolume, nondominated
from service.preferences import angles, from_angles
from service.search.bound import hypervolume_bound
from service.search.improve import SearchProgress, improve

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
BOUND_SECONDS = 5.0  # after which a bound, valid all along, is tight enough
Termination = Literal["converged", "time_limit", "cancelled"]


class Constructor(Protocol):
    """Builds tours from nothing."""

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """One tour, a row of shape (n,), for each preference, a row of shape (k, 2)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PlanOptions:
    """What is asked of a front: angles in degrees, shape (k,), and how it is to be reported.

    The search that improves it has `time_limit` seconds; at 0 there is none. The caller may bring
    tours, shape (m, n), that the front shall dominate or equal. Without a reference point it is
    n times the scale: where every step costs a whole unit. The network is called so many
    times, each under another symmetry of the cities' coordinates and for angles in between.
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
        """Whether more than the network is asked for."""
        built = len(self.angles) * self.augment
        return self.time_limit > 0 or self.bound or built > self.size


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated tours, shape (m, n), and their points, shape (m, 2), by ascending first length.

    Of `found` nondominated tours these are the ones that were kept. No front of the instance has
    a hypervolume above `bound`, where that was asked for. A search added `gained` to the
    hypervolume of the tours that it set out from. Times are in milliseconds, by phase.
    """

    tours: NDArray[np.integer]
    points: Array
    found: int
    scale: Array
    reference_point: Array
    terminated: Termination | None  # none while the search goes on
    timings: dict[str, float]
    bound: float | None = None
    gained: float | None = None

    @property
    def n(self) -> int:
        """The number of cities."""
        return self.tours.shape[1]

    @cached_property
    def hypervolume(self) -> float:
        """Of the tours kept, in respect of the reference point."""
        return hypervolume(self.points, self.reference_point)

    @cached_property
    def angles(self) -> Array:
        """The direction of each point in scaled objective space, in degrees, shape (m,)."""
        return angles(self.points / self.scale)

    def nearest(self, angle: float) -> int:
        """The index of the tour whose direction is nearest to the angle in degrees."""
        return int(np.abs(self.angles - angle).argmin())


@dataclass(frozen=True, eq=False)
class Interim:
    """How far the improvement has come. `front` gives the best so many tours found so far."""

    seconds: float
    hypervolume: float
    points: int
    front: Callable[[int], Front]


Report = Callable[[Interim], None]


def plan(
    constructor: Constructor,
    instance: Instance,
    demand: PlanOptions,
    stop: Callable[[], bool] = lambda: False,
    report: Report = lambda _: None,
) -> Front:
    """The best front found for the instance, within the time limit and until told to stop.

    Meanwhile the report is told, ten times a second, how far it has come.
    """
    clock = _Clock()
    first = _constructed(constructor, instance, demand, stop)
    if demand.initial_tours is not None:
        first = np.concatenate((first, demand.initial_tours))
    clock.ends("construction")
    reference_point = _reference_point(instance, demand)
    demand = replace(demand, reference_point=reference_point)
    tours, points, terminated = _improved(instance, first, demand, stop, report)
    clock.ends("improvement")
    searched = demand.time_limit > 0
    gained = _gained(instance, first, points, reference_point) if searched else None
    kept = best_subset(points, demand.size, reference_point)
    clock.ends("selection")
    bound = _bound(instance, reference_point) if demand.bound and not stop() else None
    clock.ends("bound")
    return Front(
        tours=_starting_at(demand.start, tours[kept]),
        points=points[kept],
        found=len(points),
        scale=instance.scale,
        reference_point=reference_point,
        terminated=terminated,
        timings=clock.phases,
        bound=bound,
        gained=gained,
    )


def _gained(instance: Instance, first: Tours, points: Array, reference_point: Array) -> float:
    before = hypervolume(tour_lengths(instance, first), reference_point)
    return hypervolume(points, reference_point) - before


def _bound(instance: Instance, reference_point: Array) -> float:
    return hypervolume_bound(instance, reference_point, time.monotonic() + BOUND_SECONDS)


def _improved(
    instance: Instance,
    tours: Tours,
    demand: PlanOptions,
    stop: Callable[[], bool],
    report: Report,
) -> tuple[Tours, Array, Termination | None]:
    """The nondominated tours, their points, and how the search for more of them ended."""
    if demand.time_limit == 0:
        points = tour_lengths(instance, tours)
        front = nondominated(points)
        return tours[front], points[front], "converged"
    found = improve(
        instance,
        tours,
        deadline=time.monotonic() + demand.time_limit,
        seed=demand.seed,
        stop=stop,
        report=lambda progress: report(_interim(instance, demand, progress)),
        reference_point=demand.reference_point,
    )
    return found.tours.astype(np.int64), found.points, found.terminated


def _interim(instance: Instance, demand: PlanOptions, progress: SearchProgress) -> Interim:
    def front(size: int) -> Front:
        best = progress.best(min(size, demand.size))
        return Front(
            tours=_starting_at(demand.start, best.tours),
            points=best.points,
            found=progress.points,
            scale=instance.scale,
            reference_point=_reference_point(instance, demand),
            terminated=None,
            timings={},
        )

    return Interim(progress.seconds, progress.hypervolume, progress.points, front)


def _constructed(
    constructor: Constructor, instance: Instance, demand: PlanOptions, stop: Callable[[], bool]
) -> Tours:
    # Of one or two cities there is one tour, and no network was trained on them.
    if instance.n <= 2:
        return np.arange(instance.n, dtype=np.int64)[np.newaxis]
    tours = []
    for call, seen in enumerate(symmetries(instance, demand.augment)):
        angles = _moved(demand.angles, call / demand.augment)
        tours.append(constructor.tours(seen, from_angles(angles)))
        if stop():
            break
    return np.concatenate(tours)


def _moved(angles: Array, share: float) -> Array:
    """The angles, each moved by a share of the way to the next; the last stays."""
    each = np.arange(len(angles))
    return np.interp(each + share, each, angles)


def _reference_point(instance: Instance, demand: PlanOptions) -> Array:
    if demand.reference_point is not None:
        return demand.reference_point
    return instance.n * instance.scale


def _starting_at(start: int, tours: NDArray[np.integer]) -> NDArray[np.integer]:
    n = tours.shape[1]
    first = (tours == start).argmax(axis=1)
    return np.take_along_axis(tours, (first[:, np.newaxis] + np.arange(n)) % n, axis=1)


class _Clock:
    """Milliseconds since the last phase ended."""

    def __init__(self) -> None:
        self.phases: dict[str, float] = {}
        self._since = time.perf_counter()

    def ends(self, phase: str) -> None:
        now = time.perf_counter()
        self.phases[phase] = 1000 * (now - self._since)
        self._since = now
