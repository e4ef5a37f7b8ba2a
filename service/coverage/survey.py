"""survey(...): from a grid and places on it to an instance; Survey.paths: from tours to paths.

The first objective is the length in metres of the shortest path between two places that keeps
clear of obstacles. The second is the caller's: a matrix; distances between points in a plane; or a
cost layer on the grid. By a layer, a path costs the sum over its steps of the step's length in
metres times the mean of the layer at the step's two ends; of equally short paths the cheapest is
taken.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from service.coverage.coverage import Coverage
from service.coverage.frame import MapFrame
from service.coverage.grid import free_cells
from service.coverage.places import find_places
from service.coverage.shortest_paths import (
    Grid,
    cell_numbers,
    find_paths,
    make_grid,
    pairwise_paths,
    trace_path,
)
from service.errors import Cancelled, InvalidCoverage, Refusal
from service.instance import Instance, tour_lengths, tour_steps

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class CoveragePath:
    """The path of a tour: rows and columns, shape (m, 2); of a closed one, the first also last.

    The frame is that of the map, where it is known.
    """

    cells: Cells
    metres: float
    frame: MapFrame | None = None


@dataclass(frozen=True, eq=False)
class Survey:
    """Places, rows and columns, shape (n, 2), and the instance of the costs between them.

    Tours are reported from the place `start`. `steps`, shape (n, n), are the numbers of steps of
    the paths between places. The frame is that of the map, where it is known.
    """

    places: Cells
    start: int
    instance: Instance
    grid: Grid
    steps: NDArray[np.int32]
    frame: MapFrame | None

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
        origins, ends = tour_steps(self.instance, tours)
        cells = self.steps[origins, ends].sum(axis=1, dtype=np.int64) + 1
        if most_cells is not None and cells.sum() > most_cells:
            raise _paths_too_long(most_cells, cells)
        steps = np.unique(np.sort(np.stack((origins.ravel(), ends.ravel()), axis=1)), axis=0)
        paths = dict(self._paths_of_steps(steps.tolist(), stop))
        lengths = tour_lengths(self.instance, tours)[:, 0].tolist()
        each = zip(tours, origins.tolist(), ends.tolist(), lengths, strict=True)
        for tour, begins, stops, metres in each:
            _check(stop)
            legs = [paths[step][1:] for step in zip(begins, stops, strict=True)]
            cells = np.concatenate([self.places[tour[:1]], *legs])
            yield CoveragePath(cells, metres, self.frame)

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
        InvalidCoverage: No cell is free, a place or a pose is not free or cannot be reached, or the
            second objective is not of as many places.
        TooManyPlaces: The spacing gives more than `max_places`.
        InvalidInstance: The second objective's costs are not valid.
        Cancelled: `stop` returned True.
    """
    free = free_cells(coverage.blocked, coverage.cell_size, coverage.robot_radius)
    _check(stop)
    if not free.any():
        raise InvalidCoverage(
            ("grid", f"must have a free cell {coverage.far_enough}, and there is none")
        )
    places = find_places(coverage, free, max_places)
    cells = places.cells
    grid = make_grid(free, coverage.cost_layer)
    _check(stop)
    steps = np.zeros((len(cells), len(cells)), np.int32)
    lengths, costs = pairwise_paths(grid, cell_numbers(grid, cells), stop, steps)
    _check(stop)
    matrices = np.stack((coverage.cell_size * lengths, _second_objective(coverage, costs)))
    instance = Instance(matrices=matrices, **places.ends._asdict())
    return Survey(cells, places.start, instance, grid, steps, coverage.frame)


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
