"""survey(...): from a grid and places on it to an instance; Survey.paths: from tours to paths.

The first objective is the length in metres of the shortest path between two places that keeps
clear of obstacles. The second is the caller's: a matrix; distances between points in a plane; or a
cost layer on the grid. By a layer, a path costs the sum over its steps of the step's length in
metres times the mean of the layer at the step's two ends; of equally short paths the cheapest is
taken.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from service.coverage.grid import covering_places, free_cells, largest_region, regions
from service.coverage.shortest_paths import (
    Grid,
    cell_numbers,
    find_paths,
    make_grid,
    pairwise_paths,
    trace_path,
)
from service.errors import Cancelled, InvalidCoverage, Refusal, TooManyPlaces
from service.instance import Instance

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class Coverage:
    """A coverage task: a grid, a robot, places to visit, and a second objective.

    Exactly one of `places` and `spacing` is given, and exactly one of the last three.

    Args:
        blocked: Obstacles, shape (rows, columns).
        cell_size: The side of a cell, in metres.
        robot_radius: In metres.
        places: Rows and columns of the places, shape (n, 2).
        spacing: In metres. The places cover the largest free region, one in each square of this
            side.
        start: The place from which all tours are reported.
        second_matrix: Costs between places, shape (n, n).
        cost_layer: Costs on the grid, shape (rows, columns).
        second_coordinates: Coordinates of the places in a plane, shape (n, 2).

    Raises:
        InvalidCoverage: A size is not positive, a cost layer does not fit the grid or has an
            invalid cost, or both or neither of two alternatives are given.
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
        if sum(source is not None for source in second) != 1:
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
class CoveragePath:
    """The closed path of a tour: rows and columns, shape (m, 2), the first also last."""

    cells: Cells
    metres: float


@dataclass(frozen=True, eq=False)
class Survey:
    """Places, rows and columns, shape (n, 2), and the instance of the costs between them.

    `steps`, shape (n, n), are the numbers of steps of the paths between places.
    """

    places: Cells
    instance: Instance
    grid: Grid
    steps: NDArray[np.int32]

    def paths(
        self,
        tours: NDArray[np.integer],
        most_cells: int | None = None,
        stop: Callable[[], bool] = lambda: False,
    ) -> Iterator[CoveragePath]:
        """Yield the path of each of the tours, shape (k, n).

        Args:
            tours: One tour a row.
            most_cells: Of all paths together; None sets no limit. It is checked before any is made.
            stop: Called for each leg and each path; True ends the tracing.

        Raises:
            Refusal: The paths have more cells than that.
            Cancelled: `stop` returned True.
        """
        following = np.roll(tours, -1, axis=1)
        cells = self.steps[tours, following].sum(axis=1, dtype=np.int64) + 1
        if most_cells is not None and cells.sum() > most_cells:
            raise _paths_too_long(most_cells, cells)
        steps = np.unique(np.sort(np.stack((tours.ravel(), following.ravel()), axis=1)), axis=0)
        paths = dict(self._paths_of_steps(steps.tolist(), stop))
        assert self.instance.matrices is not None
        for tour, successors in zip(tours.tolist(), following.tolist(), strict=True):
            _check(stop)
            legs = [paths[step] for step in zip(tour, successors, strict=True)]
            cells = np.concatenate([legs[0], *(leg[1:] for leg in legs[1:])])
            yield CoveragePath(cells, float(self.instance.matrices[0, tour, successors].sum()))

    def _paths_of_steps(
        self, steps: list[tuple[int, int]], stop: Callable[[], bool]
    ) -> Iterator[tuple[tuple[int, int], Cells]]:
        """Yield each step between two places with its cells, in both directions.

        Steps are sorted, so that those from one place need one search.
        """
        numbers = cell_numbers(self.grid, self.places)
        for origin, group in groupby(steps, key=lambda step: step[0]):
            ends = [end for _, end in group]
            tree = find_paths(self.grid, numbers[origin], numbers[ends])
            for end in ends:
                _check(stop)
                path = trace_path(self.grid, tree, numbers[end])
                yield (origin, end), path
                yield (end, origin), path[::-1]


def survey(coverage: Coverage, max_places: int, stop: Callable[[], bool]) -> Survey:
    """Return the places of a coverage task and the instance of the costs between them.

    Args:
        coverage: The task.
        max_places: The greatest number of places that a spacing may give.
        stop: Called once for each place, and before and after; True ends the survey.

    Raises:
        InvalidCoverage: No cell is free, a place is not free or cannot be reached, or the second
            objective is not of as many places.
        TooManyPlaces: The spacing gives more than `max_places`.
        InvalidInstance: The second objective's costs are not valid.
        Cancelled: `stop` returned True.
    """
    free = free_cells(coverage.blocked, coverage.cell_size, coverage.robot_radius)
    _check(stop)
    if not free.any():
        raise InvalidCoverage(
            ("grid", f"must have a free cell {_far_enough(coverage)}, and there is none")
        )
    places = _places(coverage, free, max_places)
    grid = make_grid(free, coverage.cost_layer)
    _check(stop)
    steps = np.zeros((len(places), len(places)), np.int32)
    lengths, costs = pairwise_paths(grid, cell_numbers(grid, places), stop, steps)
    _check(stop)
    matrices = np.stack((coverage.cell_size * lengths, _second_objective(coverage, costs)))
    return Survey(places, Instance(matrices=matrices), grid, steps)


def _places(coverage: Coverage, free: Mask, max_places: int) -> Cells:
    """Return the caller's places, or those that cover the largest region, checked."""
    if coverage.places is None:
        assert coverage.spacing is not None
        places = covering_places(largest_region(free), coverage.spacing / coverage.cell_size)
        if len(places) > max_places:
            raise TooManyPlaces(max_places, len(places))
    else:
        places = coverage.places
        _raise_any(_misplaced(coverage, places, free))
    _raise_any(_miscounted(coverage, len(places)))
    _raise_any(_unreachable(places, coverage.start, free))
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
        rows = getattr(coverage, name)
        if rows is not None and len(rows) != n:
            yield name, f"must have a row for each of {n} places, got {len(rows)}"


def _unreachable(places: Cells, start: int, free: Mask) -> Iterator[tuple[str, str]]:
    region = regions(free)[tuple(places.T)]
    for i in np.flatnonzero(region != region[start]):
        yield f"places/{i}", f"must be reachable from places/{start}, and no path leads there"


def _raise_any(faults: Iterable[tuple[str, str]]) -> None:
    if faults := tuple(faults):
        raise InvalidCoverage(*faults)


def _second_objective(coverage: Coverage, costs: Array) -> Array:
    """Return the costs of the second objective, shape (n, n); `costs` are those by the layer."""
    if coverage.second_matrix is not None:
        return coverage.second_matrix
    if coverage.second_coordinates is not None:
        steps = coverage.second_coordinates[:, np.newaxis] - coverage.second_coordinates
        return np.hypot(steps[..., 0], steps[..., 1])
    return coverage.cell_size * costs


def _check(stop: Callable[[], bool]) -> None:
    if stop():
        raise Cancelled


def _paths_too_long(most: int, cells: Cells) -> Refusal:
    """Return the refusal of paths of so many cells, shape (k,), with how many tours would fit."""
    fitting = most // int(cells.max())
    advice = f"ask for a size of {fitting}" if fitting else "ask without paths"
    actual = int(cells.sum())
    return Refusal("paths-too-long", pointer="/paths", limit=most, actual=actual, advice=advice)


def _far_enough(coverage: Coverage) -> str:
    return f"farther than {coverage.robot_radius:g} m from every obstacle"


def _size(cells: NDArray[np.generic]) -> str:
    return f"{cells.shape[0]} x {cells.shape[1]} cells"
