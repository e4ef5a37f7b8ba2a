"""FrontPoints: the points of a front, and what is known of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service import pareto
from service.objectives import OBJECTIVES
from service.search.nondominated import nondominated
from service.search.several.volume import volume
from service.search.thinning import divided

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

# Of four objectives, the points whose hypervolume is computed while a search runs: some 10 ms.
_MOST_MEASURED = 1_000


@dataclass(frozen=True, eq=False)
class FrontPoints:
    """Nondominated points by ascending first length, then second, and their reference point.

    Nobody who is given them needs to find out again which are nondominated, their order, their
    shares of the reference point, or which of them lie below it.

    Args:
        points: Shape (k, m), as nondominated() orders them; k may be 0.
        reference_point: Shape (m,), in the unit of the points.

    Raises:
        ValueError: A component of the reference point is not positive.
    """

    points: Array
    reference_point: Array

    def __post_init__(self) -> None:
        if not (self.reference_point > 0).all():
            given = self.reference_point.tolist()
            raise ValueError(f"the reference point must be positive, got {given}")

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self.points)

    @classmethod
    def among(cls, points: Array, reference_point: Array) -> tuple[Indices, "FrontPoints"]:
        """Return the indices of the nondominated among any points, shape (k, m), and their front.

        >>> indices, front = FrontPoints.among(np.array([[4.0, 1.0], [3.0, 3.0], [9.0, 2.0]]), ...
        """
        indices = nondominated(points)
        return indices, cls(points[indices], reference_point)

    def at(self, indices: Indices) -> "FrontPoints":
        """Return some of the points, by ascending indices."""
        return FrontPoints(self.points[indices], self.reference_point)

    @cached_property
    def shares(self) -> Array:
        """The points in units of the reference point, shape (k, m); infinite if it is too small."""
        return np.ascontiguousarray(pareto.shares_of(self.points, self.reference_point))

    @cached_property
    def inside(self) -> Indices:
        """The ascending indices of the points that lie below the reference point."""
        return np.flatnonzero((self.shares < 1).all(axis=1))

    @cached_property
    def hypervolume(self) -> float:
        """The share of the box that the points dominate, exact, from 0 to 1.

        O(k) of two objectives, O(k log k) of three, O(k^2 log k) of four.
        """
        return _hypervolume(self.shares[self.inside])

    @cached_property
    def quick_hypervolume(self) -> float:
        """The same, but of four objectives that of some 1,000 points spread over the front."""
        inside = self.shares[self.inside]
        if inside.shape[1] > OBJECTIVES + 1 and len(inside) > _MOST_MEASURED:
            inside = inside[divided(inside, _MOST_MEASURED).firsts]
        return _hypervolume(inside)


def _hypervolume(inside: Array) -> float:
    """Return the hypervolume of nondominated shares below 1."""
    return pareto.area(inside) if inside.shape[1] == OBJECTIVES else volume(inside)
