"""Coverage planning: from places on an occupancy grid to an instance, and from tours to paths.

The first objective is the length in metres of the shortest path between two places on which the
robot keeps off obstacles: over the eight cells around each, no corner cut. The second is what the
caller gives: a matrix; the distances between points in a plane; or a layer of costs on the grid,
where going from a place to another costs the sum over the steps of the path of the step's length
in metres times the mean of the layer at its two ends. Of the shortest paths, the cheapest by the
layer is meant; without a layer, any.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from service.coverage.grid import inflated, laid_out, largest_region, regions
from service.coverage.shortest_paths import Grid, between, flat, make_grid, search, traced
from service.errors import Cancelled, InvalidCoverage, TooManyPlaces
from service.instance import Instance

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Coverage:
    """What is to be covered: a grid, shape (rows, columns), and the places, or how far apart.

    Places are rows and columns, shape (n, 2). Without them they are laid out over the largest
    free region, one in each square with sides of `spacing`. Cell size, radius and spacing are in
    metres. Exactly one of the last three is given: a matrix of shape (n, n), a layer of the
    grid's shape, or coordinates of shape (n, 2). All tours are reported from place `start`.

    Raises:
        InvalidCoverage: a size is not positive, or both or neither of two alternatives are given.
    """

    blocked: Mask
    cell_size: float
    robot_radius: float = 0.0
    places: Cells | None = None
    spacing: float | None = None
    start: int = 0
    second_matrix: Array | None = None
    cost_layer: Array | None = None
    second_coordinates: Array | None = None

    def __post_init__(self) -> None:
        if not 0 < self.cell_size < np.inf:
            raise InvalidCoverage(("cell_size", f"must be positive, got {self.cell_size:g}"))
        if not 0 <= self.robot_radius < np.inf:
            demand = f"must not be negative, got {self.robot_radius:g}"
            raise InvalidCoverage(("robot_radius", demand))
        if (self.places is None) == (self.spacing is None):
            raise InvalidCoverage(("places", "or spacing is required, and not both"))
        if self.spacing is not None and not 0 < self.spacing < np.inf:
            raise InvalidCoverage(("spacing", f"must be positive, got {self.spacing:g}"))
        second = (self.second_matrix, self.cost_layer, self.second_coordinates)
        if sum(each is not None for each in second) != 1:
            demand = "or cost_layer or second_coordinates is required, and only one of them"
            raise InvalidCoverage(("second_matrix", demand))
        self._check_layer()

    def _check_layer(self) -> None:
        layer = self.cost_layer
        if layer is None:
            return
        if layer.shape != self.blocked.shape:
            demand = f"must be as large as grid, {_size(self.blocked)}, got {_size(layer)}"
            raise InvalidCoverage(("cost_layer", demand))
        costs = (layer >= 0) & (layer < np.inf)
        if not costs.all():
            row, column = np.unravel_index(costs.argmin(), costs.shape)
            demand = f"must be finite and not negative, got {layer[row, column]:g}"
            raise InvalidCoverage((f"cost_layer/{row}/{column}", demand))


@dataclass(frozen=True, eq=False)
class Path:
    """The cells of a closed way through all places, shape (m, 2), the first also last."""

    cells: Cells
    metres: float


@dataclass(frozen=True, eq=False)
class Survey:
    """Places, rows and columns, shape (n, 2), and what it costs to go between them."""

    places: Cells
    instance: Instance
    grid: Grid

    def paths(self, tours: NDArray[np.integer]) -> Iterator[Path]:
        """The path of each tour, a row of shape (n,)."""
        ahead = np.roll(tours, -1, axis=1)
        steps = np.unique(np.sort(np.stack((tours.ravel(), ahead.ravel()), axis=1)), axis=0)
        ways = dict(self._ways(steps.tolist()))
        assert self.instance.matrices is not None
        for tour, following in zip(tours.tolist(), ahead.tolist(), strict=True):
            legs = [ways[step] for step in zip(tour, following, strict=True)]
            cells = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
            yield Path(cells, float(self.instance.matrices[0, tour, following].sum()))

    def _ways(self, steps: list[tuple[int, int]]) -> Iterator[tuple[tuple[int, int], Cells]]:
        """The cells of each step from a place to a later one, and those of the way back."""
        numbers = flat(self.grid, self.places)
        for origin, group in groupby(steps, key=lambda step: step[0]):
            ends = [end for _, end in group]
            reached = search(self.grid, numbers[origin], numbers[ends])
            for end in ends:
                way = traced(self.grid, reached, numbers[end])
                yield (origin, end), way
                yield (end, origin), way[::-1]


def survey(coverage: Coverage, most: int, stop: Callable[[], bool]) -> Survey:
    """The places, no more than `most` of them, and what it costs to go between them.

    Raises:
        InvalidCoverage: nothing is free, a place is not, or no path leads there; the second
            objective is not about as many places or not of costs.
        Cancelled: it was told to stop.
    """
    free = inflated(coverage.blocked, coverage.cell_size, coverage.robot_radius)
    if not free.any():
        raise InvalidCoverage(
            ("grid", f"must have a free cell {_far_enough(coverage)}, and there is none")
        )
    places = _places(coverage, free, most)
    grid = make_grid(free, coverage.cost_layer)
    lengths, costs = between(grid, flat(grid, places), stop)
    if stop():
        raise Cancelled
    second = _second(coverage, costs)
    return Survey(places, Instance(matrices=np.stack((coverage.cell_size * lengths, second))), grid)


def _places(coverage: Coverage, free: Mask, most: int) -> Cells:
    if coverage.places is None:
        assert coverage.spacing is not None
        places = laid_out(largest_region(free), coverage.spacing / coverage.cell_size)
        if len(places) > most:
            raise TooManyPlaces(most, len(places))
    else:
        places = coverage.places
        _check_all(_misplaced(coverage, places, free))
    _check_all(_miscounted(coverage, len(places)))
    _check_all(_unreachable(places, coverage.start, free))
    return places


def _misplaced(coverage: Coverage, places: Cells, free: Mask) -> Iterator[tuple[str, str]]:
    for i, (row, column) in enumerate(places.tolist()):
        if not (0 <= row < free.shape[0] and 0 <= column < free.shape[1]):
            demand = f"must be a cell of the grid of {_size(free)}, got [{row}, {column}]"
        elif coverage.blocked[row, column]:
            demand = f"must be a free cell, and [{row}, {column}] is an obstacle"
        elif not free[row, column]:
            demand = f"must be a cell {_far_enough(coverage)}, and [{row}, {column}] is not"
        else:
            continue
        yield f"places/{i}", demand


def _miscounted(coverage: Coverage, n: int) -> Iterator[tuple[str, str]]:
    if coverage.start >= n:
        yield "start", f"must be a place, 0 to {n - 1}, got {coverage.start}"
    for name in ("second_matrix", "second_coordinates"):
        given = getattr(coverage, name)
        if given is not None and len(given) != n:
            yield name, f"must have a row for each of {n} places, got {len(given)}"


def _unreachable(places: Cells, start: int, free: Mask) -> Iterator[tuple[str, str]]:
    region = regions(free)[tuple(places.T)]
    for i in np.flatnonzero(region != region[start]):
        yield f"places/{i}", f"must be reachable from places/{start}, and no path leads there"


def _check_all(faults: Iterable[tuple[str, str]]) -> None:
    if found := tuple(faults):
        raise InvalidCoverage(*found)


def _second(coverage: Coverage, costs: Array) -> Array:
    if coverage.second_matrix is not None:
        return coverage.second_matrix
    if coverage.second_coordinates is not None:
        steps = coverage.second_coordinates[:, np.newaxis] - coverage.second_coordinates
        return np.hypot(steps[..., 0], steps[..., 1])
    return coverage.cell_size * costs


def _far_enough(coverage: Coverage) -> str:
    return f"farther than {coverage.robot_radius:g} m from every obstacle"


def _size(cells: NDArray[np.generic]) -> str:
    return f"{cells.shape[0]} x {cells.shape[1]} cells"
