"""Instances: cities and the costs between them; the lengths of their tours."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import InvalidInstance

Array = NDArray[np.float64]
Kind = Literal["coordinates", "matrices"]
OBJECTIVES = 2  # lengths of a tour
PLANE = 2  # coordinates of a city in the plane of an objective
MOST_SPREAD = 2.0**-1000  # of a matrix's largest cost; below it a scaled cost would vanish


class RouteEnds(NamedTuple):
    """Whether the tours of an instance are closed, and the fixed ends of open ones."""

    closed: bool = True
    start: int | None = None
    end: int | None = None


CLOSED = RouteEnds()


@dataclass(frozen=True, eq=False)
class Instance:
    """Cities, and the cost under each of two objectives of going from one to another.

    Exactly one of coordinates and matrices is given. Both are copied and made read-only. Any unit
    will do, and the two objectives need not share one.

    Args:
        coordinates: Shape (n, 4), plane 1 in columns 0-1 and plane 2 in columns 2-3. Cost m is the
            Euclidean distance in plane m.
        matrices: Shape (2, n, n). Cost m of going from i to j is matrices[m, i, j]. The diagonal
            is ignored. Infinity means that there is no way from i to j: such a leg is forbidden,
            and is made infinite under the other objective too.
        closed: Whether tours return to where they began. If not, they are open routes.
        start: The city at which every open route starts; None leaves it free.
        end: The city at which every open route ends; None leaves it free.

    Raises:
        InvalidInstance: A shape is wrong, there is no city, a coordinate is not finite, a cost is
            no number or negative, costs are so large that the length of a tour could overflow, a
            matrix has costs so far apart that no double holds both in one unit, an end is no city
            or that of closed tours, or a route of several cities starts where it ends.
    """

    coordinates: Array | None = None
    matrices: Array | None = None
    closed: bool = True
    start: int | None = None
    end: int | None = None

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
        _check_ends(self)

    @property
    def n(self) -> int:
        """The number of cities."""
        if self.coordinates is not None:
            return len(self.coordinates)
        assert self.matrices is not None
        return self.matrices.shape[1]

    @property
    def kind(self) -> Kind:
        """Whether the instance was made from coordinates or from matrices."""
        return "matrices" if self.coordinates is None else "coordinates"

    @cached_property
    def scale(self) -> Array:
        """The unit of each objective, shape (2,), in which the network and angles work.

        That is the longer side of the plane's bounding box, or the largest finite entry of the
        matrix; 1 where this is 0.
        """
        return np.where(self._extents > 0, self._extents, 1.0)

    @cached_property
    def shifts(self) -> NDArray[np.intp]:
        """The powers of two, shape (2,), by which costs are multiplied to bring scale into [1, 2).

        As a factor such a power may be infinite or 0 where the product is neither: use np.ldexp.
        """
        return 1 - np.frexp(self.scale)[1].astype(np.intp)

    @cached_property
    def symmetric(self) -> bool:
        """Whether every cost is the same in both directions."""
        return self.matrices is None or np.array_equal(
            self.matrices, self.matrices.transpose(0, 2, 1)
        )

    @property
    def scaled_coordinates(self) -> Array:
        """Coordinates, shape (n, 4), with each plane moved and scaled into the unit square.

        Raises:
            InvalidInstance: The instance was made from matrices.
        """
        if self.coordinates is None:
            raise InvalidInstance("an instance made from matrices has no coordinates")
        return (self.coordinates - self.coordinates.min(axis=0)) / self.scale.repeat(PLANE)

    @property
    def scaled_matrices(self) -> Array:
        """Costs, shape (2, n, n), each in units of its objective's scale; infinite ones stay so."""
        if self.matrices is not None:
            return self.matrices / self.scale[:, np.newaxis, np.newaxis]
        steps = self.scaled_coordinates[:, np.newaxis] - self.scaled_coordinates
        return np.hypot(steps[..., 0::PLANE], steps[..., 1::PLANE]).transpose(2, 0, 1)

    @cached_property
    def _extents(self) -> Array:
        if self.coordinates is not None:
            with np.errstate(over="ignore"):
                return np.ptp(self.coordinates, axis=0).reshape(OBJECTIVES, PLANE).max(axis=1)
        assert self.matrices is not None
        return self.matrices.max(axis=(1, 2), where=np.isfinite(self.matrices), initial=0.0)

    @property
    def ends(self) -> RouteEnds:
        """Whether tours are closed, and the fixed ends of open routes."""
        return RouteEnds(self.closed, self.start, self.end)

    @property
    def fixed_ends(self) -> tuple[int, ...]:
        """The cities at which an open route has to start or end."""
        ends = (self.start, self.end) if self.start != self.end else (self.start,)
        return tuple(city for city in ends if city is not None)


def tour_lengths(instance: Instance, tours: NDArray[np.integer]) -> Array:
    """Return the lengths, shape (k, 2), of tours, shape (k, n), in the instance's units.

    Of closed tours the step from the last city back to the first is included. Tours with a
    forbidden leg are infinitely long. O(k n).

    >>> corners = np.array([[0, 0, 0, 0], [3, 0, 0, 1], [3, 4, 2, 1], [0, 4, 2, 0]])
    >>> square = Instance(coordinates=corners)
    >>> tour_lengths(square, np.array([[0, 1, 2, 3], [3, 2, 1, 0]]))
    array([[14.,  6.],
           [14.,  6.]])
    """
    if instance.coordinates is not None:
        # As complex numbers, (x, y) are looked up together, and numpy's abs() is a faster hypot().
        # All tours' first cities come first, then their second: so long rows are added fastest.
        visited = instance.coordinates.view(np.complex128).take(tours.T, axis=0)
        lengths: Array = np.abs(visited[1:] - visited[:-1]).sum(axis=0)
        return lengths + np.abs(visited[0] - visited[-1]) if instance.closed else lengths
    assert instance.matrices is not None
    origins, destinations = tour_steps(instance, tours)
    return instance.matrices[:, origins, destinations].sum(axis=2).T


def step_lengths(
    instance: Instance, origins: NDArray[np.integer], destinations: NDArray[np.integer]
) -> Array:
    """Return both costs of steps, in the instance's units, with one more axis of 2 at the end."""
    if instance.matrices is not None:
        return np.moveaxis(instance.matrices[:, origins, destinations], 0, -1)
    assert instance.coordinates is not None
    cities = instance.coordinates.view(np.complex128)
    return np.abs(cities[destinations] - cities[origins])


def tour_steps(
    instance: Instance, tours: NDArray[np.integer]
) -> tuple[NDArray[np.integer], NDArray[np.integer]]:
    """Return where the steps of tours, shape (k, n), begin and end.

    Either has shape (k, n), or (k, n - 1) for open routes, which have no step back.
    """
    if instance.closed:
        return tours, np.roll(tours, -1, axis=1)
    return tours[:, :-1], tours[:, 1:]


def least_lengths(instance: Instance) -> Array:
    """Return lengths, shape (2,), that no tour goes below, by what is cheap. O(n^2).

    In a plane a tour goes from one side of the bounding box to the other, and back where it is
    closed. Of a matrix it has an entry in each row and in each column, none of them on the
    diagonal; an open route has none in one row and in one column. The lengths are infinite where
    these conditions already leave no tour without a forbidden leg.

    >>> corners = np.array([[0, 0, 0, 0], [3, 0, 0, 1], [3, 4, 2, 1], [0, 4, 2, 0]])
    >>> least_lengths(Instance(coordinates=corners))
    array([8., 4.])
    >>> costs = np.array([[0, 2, 3], [4, 0, 1], [5, 2, 0]])
    >>> least_lengths(Instance(matrices=np.stack([costs, costs.T])))
    array([7., 7.])
    >>> least_lengths(Instance(matrices=np.stack([costs, costs.T]), closed=False))
    array([3., 3.])
    """
    if instance.coordinates is not None:
        sides = np.ptp(instance.coordinates, axis=0).reshape(OBJECTIVES, PLANE)
        return sides.max(axis=1) * (2 if instance.closed else 1)
    assert instance.matrices is not None
    if instance.n == 1:
        return np.zeros(OBJECTIVES)
    steps = np.where(np.eye(instance.n, dtype=bool), np.inf, instance.matrices)
    leaving, entering = steps.min(axis=2), steps.min(axis=1)
    if not instance.closed:
        leaving, entering = (np.sort(least)[:, :-1] for least in (leaving, entering))
    return np.maximum(leaving.sum(axis=1), entering.sum(axis=1))


def cumulated_lengths(instance: Instance, tours: NDArray[np.integer]) -> Array:
    """Return both lengths of tours, shape (k, n), from their first city up to each.

    Shape (k, n + 1, 2) for closed tours, with the return, and (k, n, 2) for open routes. O(k n).
    """
    steps = step_lengths(instance, *tour_steps(instance, tours))
    return np.pad(steps.cumsum(axis=1), ((0, 0), (1, 0), (0, 0)))


def _check_ends(instance: Instance) -> None:
    """Raise InvalidInstance where a fixed end of a route does not fit the instance."""
    for name, city in (("start", instance.start), ("end", instance.end)):
        if city is None:
            continue
        if instance.closed:
            raise InvalidInstance(f"a closed tour has no {name}, got {city}")
        if not 0 <= city < instance.n:
            raise InvalidInstance(f"{name} must be a city, 0 to {instance.n - 1}, got {city}")
    if instance.n > 1 and instance.start == instance.end is not None:
        raise InvalidInstance(f"an open route cannot end where it starts, got {instance.start}")


def _checked_coordinates(coordinates: Array) -> Array:
    coordinates = np.array(coordinates, dtype=np.float64, order="C")
    shape = coordinates.shape
    if coordinates.ndim != 2 or shape[1] != OBJECTIVES * PLANE or not shape[0]:
        columns = OBJECTIVES * PLANE
        raise InvalidInstance(
            f"coordinates must have shape (n, {columns}) with n at least 1, got {shape}"
        )
    if not np.isfinite(coordinates).all():
        raise InvalidInstance("coordinates must be finite")
    coordinates.setflags(write=False)
    return coordinates


def _checked_matrices(matrices: Array | None) -> Array:
    matrices = np.array(matrices, dtype=np.float64)
    shape = matrices.shape
    if matrices.ndim != 3 or shape[0] != OBJECTIVES or shape[1] != shape[2] or not shape[1]:
        raise InvalidInstance(
            f"matrices must have shape ({OBJECTIVES}, n, n) with n at least 1, got {shape}"
        )
    matrices[:, np.arange(shape[1]), np.arange(shape[1])] = 0.0
    if np.isnan(matrices).any():
        m, i, j = np.argwhere(np.isnan(matrices))[0]
        raise InvalidInstance(
            f"costs must be numbers, got NaN from city {i} to {j} in matrix {m}; where there is no "
            "way, write null in JSON and infinity in an array"
        )
    if (matrices < 0).any():
        raise InvalidInstance(f"costs must not be negative, got {matrices.min():g}")
    matrices[:, np.isinf(matrices).any(axis=0)] = np.inf
    for matrix in matrices:
        least = matrix.min(where=matrix > 0, initial=np.inf)
        largest = matrix.max(where=np.isfinite(matrix), initial=0.0)
        if least < largest * MOST_SPREAD:
            raise InvalidInstance(
                "positive costs of an objective must lie within a factor of 1e301 of each other, "
                f"got {least:g} and {largest:g}"
            )
    matrices.setflags(write=False)
    return matrices
