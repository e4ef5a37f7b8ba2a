"""Instances: cities and the costs between them; the lengths of their tours."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import InvalidInstance
from service.objectives import MOST_OBJECTIVES, OBJECTIVES

Array = NDArray[np.float64]
Kind = Literal["coordinates", "matrices"]
PLANE = 2  # coordinates of a city in the plane of an objective
MOST_SPREAD = 2.0**-1000  # of a matrix's largest cost; below it a scaled cost would vanish
OUTLYING = 100.0  # times the typical cost: what is larger does not count for the scale
SAMPLED = 100  # cities whose costs between each other show what is typical
LARGEST_SCALED = 2.0**256  # of a cost, so that products of two lengths are finite


class RouteEnds(NamedTuple):
    """Whether the tours of an instance are closed, and the fixed ends of open ones."""

    closed: bool = True
    start: int | None = None
    end: int | None = None


CLOSED = RouteEnds()


@dataclass(frozen=True, eq=False)
class Instance:
    """Cities, and the cost of going from one to another under each of m objectives, two to four.

    Exactly one of coordinates and matrices is given. Both are copied and made read-only. Any unit
    will do, and the objectives need not share one.

    Args:
        coordinates: Shape (n, 2 m), plane 1 in columns 0-1, plane 2 in columns 2-3 and so on. The
            cost under an objective is the Euclidean distance in its plane.
        matrices: Shape (m, n, n). The cost under objective k of going from i to j is
            matrices[k, i, j]. The diagonal is ignored. An infinite cost forbids the leg from i
            to j: it becomes infinite under the other objectives too.
        closed: Whether tours return to where they began. If not, they are open routes.
        start: The city at which every open route starts; None leaves it free.
        end: The city at which every open route ends; None leaves it free.

    Raises:
        InvalidInstance: A shape is wrong, no city is given, a coordinate is not finite, a cost is
            not a number or negative, costs are so large that the length of a tour could overflow,
            a matrix has costs too far apart for doubles in one unit, an end is not a city or is
            given for closed tours, or a route of several cities starts where it ends.
    """

    coordinates: Array | None = None
    matrices: Array | None = None
    closed: bool = True
    start: int | None = None
    end: int | None = None

    def __post_init__(self) -> None:
        if (self.coordinates is None) == (self.matrices is None):
            raise InvalidInstance("either-coordinates-or-matrices")
        if self.coordinates is not None:
            object.__setattr__(self, "coordinates", _checked_coordinates(self.coordinates))
        else:
            object.__setattr__(self, "matrices", _checked_matrices(self.matrices))
        if not math.isfinite(2 * self.n * float(self.extents.max())):
            raise InvalidInstance("costs-too-large", came=float(self.extents.max()))
        _check_ends(self)

    @property
    def n(self) -> int:
        """The number of cities."""
        if self.coordinates is not None:
            return len(self.coordinates)
        assert self.matrices is not None
        return self.matrices.shape[1]

    @property
    def objectives(self) -> int:
        """The number of objectives, m."""
        if self.coordinates is not None:
            return self.coordinates.shape[1] // PLANE
        assert self.matrices is not None
        return len(self.matrices)

    @property
    def kind(self) -> Kind:
        """Whether the instance was made from coordinates or from matrices."""
        return "matrices" if self.coordinates is None else "coordinates"

    @cached_property
    def scale(self) -> Array:
        """The unit of each objective, shape (m,), in which the network and angles work.

        That is the longer side of the plane's bounding box, or the largest cost of the matrix; 1
        where this is 0. Outliers do not count: costs of more than 100 times the median positive
        cost, and cities that lie farther from the middle than 100 times the median distance.
        """
        if self.coordinates is not None:
            ordinary = np.stack([np.ptp(box, axis=0).max() for box in self._ordinary_boxes])
        else:
            assert self.matrices is not None
            step = -(-self.n // SAMPLED)
            triples = zip(
                self.matrices, self.matrices[:, ::step, ::step], self.extents, strict=True
            )
            ordinary = np.array(
                [ordinary_cost([costs], some, most) for costs, some, most in triples]
            )
        return np.where(ordinary > 0, ordinary, 1.0)

    @cached_property
    def reference_point(self) -> Array:
        """The default reference point of hypervolumes, shape (m,): n times the scale.

        What no tour can avoid of outliers is added, so that a city far from all others leaves room
        for trade-offs among these: once round the bounding box of a plane, or each outlier that is
        the least cost of leaving a city or of reaching it.
        """
        common = self.n * self.scale
        if (self.extents <= self.scale).all():
            return common
        if self.coordinates is not None:
            sides = np.ptp(self.coordinates, axis=0).reshape(-1, PLANE)
            return common + np.where(self.extents > self.scale, 2 * sides.sum(axis=1), 0.0)
        assert self.matrices is not None
        least = np.concatenate(least_steps(self.matrices), axis=1)
        outlying = np.isfinite(least) & (least > self.scale[:, np.newaxis])
        return common + least.sum(axis=1, where=outlying)

    @cached_property
    def shifts(self) -> NDArray[np.intp]:
        """The powers of two, shape (m,), by which costs are multiplied for the search.

        They bring scale into [1, 2), or where some cost is very much larger, that cost below 2^256.
        As a factor such a power may be infinite or 0 where the product is neither: use np.ldexp.
        """
        unit = np.maximum(self.scale, self.extents / LARGEST_SCALED)
        return 1 - np.frexp(unit)[1].astype(np.intp)

    @cached_property
    def penalised_matrices(self) -> Array:
        """Costs, shape (m, n, n), in which a forbidden leg costs more than a tour without one.

        Raises:
            InvalidInstance: The instance was made from coordinates.
        """
        if self.matrices is None:
            raise InvalidInstance("no-matrices")
        forbidden = np.isinf(self.matrices[0])
        if not forbidden.any():
            return self.matrices
        largest = np.where(self.extents > 0, self.extents, 1.0)
        penalties = np.minimum(2 * self.n * largest, np.finfo(np.float64).max / (8 * self.n))
        return np.where(forbidden, penalties[:, np.newaxis, np.newaxis], self.matrices)

    @cached_property
    def symmetric(self) -> bool:
        """Whether every cost is the same in both directions."""
        return self.matrices is None or np.array_equal(
            self.matrices, self.matrices.transpose(0, 2, 1)
        )

    @property
    def scaled_coordinates(self) -> Array:
        """Coordinates, shape (n, 2 m), with each plane moved and scaled into the unit square.

        Cities far from all others, which do not count for the scale, lie outside it.

        Raises:
            InvalidInstance: The instance was made from matrices.
        """
        if self.coordinates is None:
            raise InvalidInstance("no-coordinates")
        corner = np.concatenate([box[0] for box in self._ordinary_boxes])
        return (self.coordinates - corner) / self.scale.repeat(PLANE)

    @property
    def scaled_matrices(self) -> Array:
        """Costs, shape (m, n, n), each in units of its objective's scale; infinite ones stay so."""
        if self.matrices is not None:
            return self.matrices / self.scale[:, np.newaxis, np.newaxis]
        steps = self.scaled_coordinates[:, np.newaxis] - self.scaled_coordinates
        return np.hypot(steps[..., 0::PLANE], steps[..., 1::PLANE]).transpose(2, 0, 1)

    @cached_property
    def _ordinary_boxes(self) -> Array:
        """The least and greatest coordinates in each plane without outliers, shape (m, 2, 2)."""
        assert self.coordinates is not None
        planes = self.coordinates.reshape(self.n, -1, PLANE)
        boxes = np.stack([planes.min(axis=0), planes.max(axis=0)], axis=1)
        if self.n <= 2:
            return boxes
        for plane, box in enumerate(boxes):
            cities = planes[:, plane]
            with np.errstate(over="ignore"):
                distances = np.abs(cities - np.median(cities, axis=0)).max(axis=1)
            ordinary = distances <= OUTLYING * _median_positive(distances)
            if not ordinary.all():
                box[:] = cities[ordinary].min(axis=0), cities[ordinary].max(axis=0)
        return boxes

    @cached_property
    def extents(self) -> Array:
        """The longer side of each plane's bounding box, or each matrix's largest finite cost."""
        if self.coordinates is not None:
            with np.errstate(over="ignore"):
                return np.ptp(self.coordinates, axis=0).reshape(-1, PLANE).max(axis=1)
        assert self.matrices is not None
        return largest_costs(self.matrices)

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
    """Return the lengths, shape (k, m), of tours, shape (k, n), in the instance's units.

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
    """Return all costs of steps, in the instance's units, with one more axis of m at the end.

    A forbidden leg has its penalty as its cost, so that sums and differences stay finite.
    """
    if instance.matrices is not None:
        return np.moveaxis(instance.penalised_matrices[:, origins, destinations], 0, -1)
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
    """Return lengths, shape (m,), that no tour goes below, by what is cheap. O(n^2).

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
        sides = np.ptp(instance.coordinates, axis=0).reshape(-1, PLANE)
        return sides.max(axis=1) * (2 if instance.closed else 1)
    assert instance.matrices is not None
    if instance.n == 1:
        return np.zeros(instance.objectives)
    leaving, entering = least_steps(instance.matrices)
    if not instance.closed:
        leaving, entering = (np.sort(least)[:, :-1] for least in (leaving, entering))
    return np.maximum(leaving.sum(axis=1), entering.sum(axis=1))


def least_steps(matrices: Array) -> tuple[Array, Array]:
    """Return the least costs of leaving each city, and of reaching it, shape (m, n) each."""
    steps = np.where(np.eye(matrices.shape[1], dtype=bool), np.inf, matrices)
    return steps.min(axis=2), steps.min(axis=1)


def largest_costs(matrices: Array) -> Array:
    """Return the largest finite cost of each matrix, shape (m,); 0 where there is none."""
    largest: Array = matrices.max(axis=(1, 2))
    if np.isfinite(largest).all():
        return largest
    return matrices.max(axis=(1, 2), where=np.isfinite(matrices), initial=0.0)


def ordinary_cost(blocks: Iterable[Array], sample: Array, largest: float) -> float:
    """Return the largest of some costs that is not an outlier: over 100 times the median positive.

    Args:
        blocks: All costs.
        sample: Those among a hundred cities, whose median is taken.
        largest: The largest of all that are finite.
    """
    limit = OUTLYING * _median_positive(sample)
    if largest <= limit:
        return largest
    return max(float(block.max(where=block <= limit, initial=0.0)) for block in blocks)


def _median_positive(costs: Array) -> float:
    """Return the median of the finite positive costs; infinity where there is none."""
    positive = costs[(costs > 0) & (costs < np.inf)]
    return float(np.median(positive)) if len(positive) else np.inf


def _check_ends(instance: Instance) -> None:
    """Raise InvalidInstance where a fixed end of a route does not fit the instance."""
    for name, city in (("start", instance.start), ("end", instance.end)):
        if city is None:
            continue
        if instance.closed:
            raise InvalidInstance("end-of-closed-tour", end=name, came=city)
        if not 0 <= city < instance.n:
            raise InvalidInstance("end-no-city", end=name, last=instance.n - 1, came=city)
    if instance.n > 1 and instance.start == instance.end is not None:
        raise InvalidInstance("same-ends", came=instance.start)


def _checked_coordinates(coordinates: Array) -> Array:
    coordinates = np.array(coordinates, dtype=np.float64, order="C")
    shape = coordinates.shape
    columns = [PLANE * m for m in range(OBJECTIVES, MOST_OBJECTIVES + 1)]
    if coordinates.ndim != 2 or shape[1] not in columns or not shape[0]:
        raise InvalidInstance("wrong-coordinates", came=str(shape))
    if not np.isfinite(coordinates).all():
        raise InvalidInstance("coordinates-not-finite")
    coordinates.setflags(write=False)
    return coordinates


def _checked_matrices(matrices: Array | None) -> Array:
    matrices = np.array(matrices, dtype=np.float64)
    shape = matrices.shape
    enough = matrices.ndim == 3 and OBJECTIVES <= shape[0] <= MOST_OBJECTIVES
    if not enough or shape[1] != shape[2] or not shape[1]:
        bounds = {"least": OBJECTIVES, "most": MOST_OBJECTIVES}
        raise InvalidInstance("wrong-matrices", came=str(shape), **bounds)
    matrices[:, np.arange(shape[1]), np.arange(shape[1])] = 0.0
    if np.isnan(matrices).any():
        m, i, j = np.argwhere(np.isnan(matrices))[0].tolist()
        raise InvalidInstance("cost-missing", matrix=m, origin=i, destination=j)
    if (matrices < 0).any():
        raise InvalidInstance("costs-negative", came=float(matrices.min()))
    forbidden = np.isinf(matrices).any(axis=0)
    if forbidden.any():
        matrices[:, forbidden] = np.inf
    for matrix, largest in zip(matrices, largest_costs(matrices).tolist(), strict=True):
        least = matrix.min(where=matrix > 0, initial=np.inf)
        if least < largest * MOST_SPREAD:
            raise InvalidInstance("costs-too-far-apart", least=float(least), greatest=largest)
    matrices.setflags(write=False)
    return matrices
