"""survey(...): from a grid and places on it to an instance; Survey.paths: from tours to paths.

The first objective is the length in metres of the shortest path between two places that keeps
clear of obstacles. The second is the caller's: a matrix; distances between points in a plane; or a
cost layer on the grid. By a layer, a path costs the sum over its steps of the step's length in
metres times the mean of the layer at the step's two ends; of equally short paths the cheapest is
taken.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

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
from service.coverage.uncovered import Uncovered, uncovered
from service.errors import Cancelled, InvalidCoverage, Refusal
from service.instance import Instance, RouteEnds

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]
Indices = NDArray[np.integer]


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
    the paths between places. The frame is that of the map, where it is known. `to_visit` and
    `robots` are as of Places. No path leads to the cells that are uncovered.
    """

    places: Cells
    start: int
    instance: Instance
    grid: Grid
    steps: NDArray[np.int32]
    frame: MapFrame | None
    to_visit: int
    uncovered: Uncovered
    robots: tuple[RouteEnds, ...] = ()

    def paths(
        self,
        tours: Indices,
        most_cells: int | None = None,
        stop: Callable[[], bool] = lambda: False,
    ) -> Iterator[CoveragePath]:
        """Yield the path of each of the tours, shape (k, n); else as `paths_of_plans`."""
        returns = tours[:, :1] if self.instance.closed else tours[:, :0]
        ways = np.hstack((tours, returns))
        return self.paths_of_plans([[way] for way in ways], most_cells, stop)

    def paths_of_plans(
        self,
        plans: Sequence[Sequence[Indices]],
        most_cells: int | None = None,
        stop: Callable[[], bool] = lambda: False,
    ) -> Iterator[CoveragePath]:
        """Yield the path of each way of each plan.

        Args:
            plans: The ways of each, which are places in order, shape (m,), one at least.
            most_cells: Of all paths together; None sets no limit. It is checked before any is made.
            stop: Called for each leg and each path; True ends the tracing.

        Raises:
            Refusal: The paths have more cells than that.
            Cancelled: `stop` returned True.
        """
        cells = [sum(self._cells_of(way) for way in plan) for plan in plans]
        if most_cells is not None and sum(cells) > most_cells:
            raise _paths_too_long(most_cells, cells)
        ways = [way for plan in plans for way in plan]
        legs = [np.sort(np.stack((way[:-1], way[1:]), axis=1)) for way in ways]
        steps = np.unique(np.concatenate([np.empty((0, 2), np.int64), *legs]), axis=0)
        paths = dict(self._paths_of_steps(steps.tolist(), stop))
        for way in ways:
            _check(stop)
            parts = [paths[step][1:] for step in pairwise(way.tolist())]
            cells_of_way = np.concatenate([self.places[way[:1]], *parts])
            yield CoveragePath(cells_of_way, self._metres_of(way), self.frame)

    def _cells_of(self, way: Indices) -> int:
        """Return the number of cells of the path of a way."""
        return int(self.steps[way[:-1], way[1:]].sum(dtype=np.int64)) + 1

    def _metres_of(self, way: Indices) -> float:
        assert self.instance.matrices is not None
        return float(self.instance.matrices[0, way[:-1], way[1:]].sum())

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
    metres = coverage.cell_size * lengths
    matrices = np.stack((metres, _second_objective(coverage, metres, costs)))
    instance = Instance(matrices=matrices, **places.ends._asdict())
    return Survey(
        cells,
        places.start,
        instance,
        grid,
        steps,
        coverage.frame,
        places.to_visit,
        uncovered(free, cells[0], coverage.cell_size),
        places.robots,
    )


def _second_objective(coverage: Coverage, metres: Array, costs: Array) -> Array:
    """Return the costs of the second objective, shape (n, n); `costs` are those by the layer."""
    if coverage.second_matrix is not None:
        return coverage.second_matrix
    if coverage.second_coordinates is not None:
        steps = coverage.second_coordinates[:, np.newaxis] - coverage.second_coordinates
        return np.hypot(steps[..., 0], steps[..., 1])
    return metres if coverage.cost_layer is None else coverage.cell_size * costs


def _check(stop: Callable[[], bool]) -> None:
    if stop():
        raise Cancelled


def _paths_too_long(most: int, cells: Sequence[int]) -> Refusal:
    """Return the refusal of paths, given the cells of each tour or plan; advise how many fit."""
    fitting = most // max(cells)
    advice = f"ask for a size of {fitting}" if fitting else "ask without paths"
    actual = sum(cells)
    return Refusal("paths-too-long", pointer="/paths", limit=most, actual=actual, advice=advice)
