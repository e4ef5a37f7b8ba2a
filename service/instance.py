"""An instance: cities and two costs between them, checked where it is made."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import permutations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.errors import InvalidInstance

Array = NDArray[np.float64]
Kind = Literal["coordinates", "matrices"]


@dataclass(frozen=True, eq=False)
class Instance:
    """Cities and what it costs, under each of two objectives, to go from one to another.

    Either from coordinates, shape (n, 4), plane 1 in columns 0-1 and plane 2 in columns 2-3,
    where cost m is the Euclidean distance in plane m; or from matrices, shape (2, n, n), where
    cost m of going from i to j is matrices[m, i, j] and the diagonal is disregarded. Exactly
    one of the two is given. Any unit will do, and the two objectives need not share one.

    Raises:
        InvalidInstance: wrong shape, no city, not finite, a negative cost, or costs so large
            that the length of a tour could overflow.
    """

    coordinates: Array | None = None
    matrices: Array | None = None

    def __post_init__(self) -> None:
        if (self.coordinates is None) == (self.matrices is None):
            raise InvalidInstance("an instance needs either coordinates or matrices, and not both")
        if self.coordinates is not None:
            object.__setattr__(self, "coordinates", _checked_coordinates(self.coordinates))
        else:
            object.__setattr__(self, "matrices", _checked_matrices(self.matrices))
        if not math.isfinite(2 * self.n * float(self._extents.max())):
            raise InvalidInstance(
                f"costs must leave a tour's length finite, got costs up to {self._extents.max():g}"
            )

    @property
    def n(self) -> int:
        """The number of cities."""
        if self.coordinates is not None:
            return len(self.coordinates)
        assert self.matrices is not None
        return self.matrices.shape[1]

    @property
    def kind(self) -> Kind:
        """What the instance was made from."""
        return "matrices" if self.coordinates is None else "coordinates"

    @cached_property
    def scale(self) -> Array:
        """The unit of each objective, shape (2,), in which network, search and angles work.

        The longer side of the plane's bounding box, or the largest entry of the matrix; 1 where
        that is 0.
        """
        return np.where(self._extents > 0, self._extents, 1.0)

    @property
    def symmetric(self) -> bool:
        """Whether every cost is the same in both directions."""
        return self.matrices is None or np.array_equal(
            self.matrices, self.matrices.transpose(0, 2, 1)
        )

    @property
    def scaled_coordinates(self) -> Array:
        """Coordinates, shape (n, 4), with each plane moved and scaled into the unit square.

        Raises:
            InvalidInstance: the instance was made from matrices.
        """
        if self.coordinates is None:
            raise InvalidInstance("an instance made from matrices has no coordinates")
        return (self.coordinates - self.coordinates.min(axis=0)) / self.scale.repeat(2)

    @property
    def scaled_matrices(self) -> Array:
        """Costs, shape (2, n, n), each objective's in units of its scale."""
        if self.matrices is not None:
            return self.matrices / self.scale[:, np.newaxis, np.newaxis]
        steps = self.scaled_coordinates[:, np.newaxis] - self.scaled_coordinates
        return np.hypot(steps[..., 0::2], steps[..., 1::2]).transpose(2, 0, 1)

    @cached_property
    def _extents(self) -> Array:
        if self.coordinates is not None:
            with np.errstate(over="ignore"):
                return np.ptp(self.coordinates, axis=0).reshape(2, 2).max(axis=1)
        assert self.matrices is not None
        return self.matrices.max(axis=(1, 2))


def tour_lengths(instance: Instance, tours: NDArray[np.integer]) -> Array:
    """Both lengths, shape (k, 2), of closed tours, shape (k, n), in the instance's own units."""
    if instance.coordinates is not None:
        # As complex numbers, (x, y) are looked up together, and numpy's abs() is a faster hypot().
        visited = instance.coordinates.view(np.complex128)[tours]
        return np.abs(np.diff(visited, axis=1, append=visited[:, :1])).sum(axis=1)
    assert instance.matrices is not None
    following = np.roll(tours, -1, axis=1)
    return instance.matrices[:, tours, following].sum(axis=2).T


def _checked_coordinates(given: Array) -> Array:
    coordinates = np.array(given, dtype=np.float64, order="C")
    if coordinates.ndim != 2 or coordinates.shape[1] != 4 or not len(coordinates):
        raise InvalidInstance(
            f"coordinates must have shape (n, 4) with n at least 1, got {coordinates.shape}"
        )
    if not np.isfinite(coordinates).all():
        raise InvalidInstance("coordinates must be finite")
    coordinates.setflags(write=False)
    return coordinates


def _checked_matrices(given: Array | None) -> Array:
    matrices = np.array(given, dtype=np.float64)
    shape = matrices.shape
    if matrices.ndim != 3 or shape[0] != 2 or shape[1] != shape[2] or not shape[1]:
        raise InvalidInstance(f"matrices must have shape (2, n, n) with n at least 1, got {shape}")
    matrices[:, np.arange(shape[1]), np.arange(shape[1])] = 0.0
    if not np.isfinite(matrices).all():
        raise InvalidInstance("costs must be finite")
    if (matrices < 0).any():
        raise InvalidInstance(f"costs must not be negative, got {matrices.min():g}")
    matrices.setflags(write=False)
    return matrices


MOST = 8  # of a square


def symmetries(instance: Instance, count: int) -> Iterator[Instance]:
    """The instance itself, and then as it looks under others of the eight symmetries of a square.

    All have the same tours and the same lengths. Both planes are mirrored alike. Of matrices there
    is one view.
    """
    yield instance
    if instance.coordinates is None:
        return
    for number in range(1, count):
        planes = instance.coordinates.reshape(-1, 2, 2)
        mirrored = planes * np.where([number & 1, number & 2], -1.0, 1.0)
        turned = mirrored[..., ::-1] if number & 4 else mirrored
        yield Instance(coordinates=turned.reshape(-1, 4))


MAX_ENUMERATED = 7  # cities, and 720 tours


def all_tours(n: int) -> NDArray[np.int32]:
    """Every tour of n cities that sets out from city 0."""
    return np.array([(0, *rest) for rest in permutations(range(1, n))], np.int32)
