"""The middle of the program: from an instance to its front, with no HTTP in it."""

import time
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from service.front import hypervolume, nondominated
from service.improve import best_subset
from service.instance import Instance, tour_lengths
from service.preferences import angles, from_angles

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
Termination = Literal["converged", "time_limit", "cancelled"]


class Constructor(Protocol):
    """Builds tours from nothing."""

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """One tour, a row of shape (n,), for each preference, a row of shape (k, 2)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Demand:
    """What is asked of a front: angles in degrees, shape (k,), and how it is to be reported.

    Without a reference point it is n times the scale: where every step costs a whole unit.
    """

    angles: Array
    size: int
    start: int = 0
    reference_point: Array | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class Front:
    """Nondominated tours, shape (m, n), and their points, shape (m, 2), by ascending first length.

    Of `found` nondominated tours these are the ones that were kept. Times are in milliseconds, by
    phase of the work.
    """

    tours: NDArray[np.integer]
    points: Array
    found: int
    scale: Array
    reference_point: Array
    terminated: Termination
    timings: dict[str, float]

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


def plan(constructor: Constructor, instance: Instance, demand: Demand) -> Front:
    """The best front found for the instance."""
    clock = _Clock()
    tours = _constructed(constructor, instance, demand.angles)
    clock.ends("construction")
    points = tour_lengths(instance, tours)
    front = nondominated(points)
    reference_point = _reference_point(instance, demand)
    kept = front[best_subset(points[front], demand.size, reference_point)]
    clock.ends("selection")
    return Front(
        tours=_starting_at(demand.start, tours[kept]),
        points=points[kept],
        found=len(front),
        scale=instance.scale,
        reference_point=reference_point,
        terminated="converged",
        timings=clock.phases,
    )


def _constructed(constructor: Constructor, instance: Instance, degrees: Array) -> Tours:
    # Of one or two cities there is one tour, and no network was trained on them.
    if instance.n <= 2:
        return np.arange(instance.n, dtype=np.int64)[np.newaxis]
    return constructor.tours(instance, from_angles(degrees))


def _reference_point(instance: Instance, demand: Demand) -> Array:
    if demand.reference_point is not None:
        return demand.reference_point
    return instance.n * instance.scale


def _starting_at(start: int, tours: Tours) -> Tours:
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
