"""survey(...): from a grid and places on it to an instance; Survey.paths: from tours to paths.

The first objective is the length in metres of the shortest path between two places that keeps
clear of obstacles. The others come from the caller: a matrix, distances between points in a plane,
or one to three cost layers on the grid. In a cost layer, a step costs its length in metres times
the mean of the layer at both its ends. Of equally short paths the cheapest by the first layer is
taken. With detours, legs may take other paths, which give up metres for cost.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, groupby, islice

import numpy as np
from paretour.values import Uncovered

from service.coverage.coverage import Coverage
from service.coverage.detours import find_detours, most_searches
from service.coverage.frame import Array, Cells, CoveragePath, MapFrame
from service.coverage.grid import free_cells, uncovered
from service.coverage.leg_paths import Indices, LegPaths, Legs, Numbers
from service.coverage.pace import Pace
from service.coverage.places import find_places
from service.coverage.shortest_paths import cell_numbers, framed_layer, make_grid, pairwise_paths
from service.errors import Cancelled, Refusal, uncoverable
from service.instance import Instance, RouteEnds
from service.objectives import Objective


@dataclass(frozen=True, eq=False)
class Survey:
    """Places on a map, and the instance of the costs between them.

    Attributes:
        places: Rows and columns, shape (n, 2).
        start: The place at which reported tours begin.
        legs: The paths between places.
        frame: The frame of the map, if it is known.
        to_visit: The number of places that the caller gave or that cover a region, as in Places.
        uncovered: The cells to which no path leads.
        robots: The places at which each robot starts and ends, as in Places.
        objectives: The names of all objectives, as in Coverage.names.
    """

    places: Cells
    start: int
    legs: LegPaths
    frame: MapFrame | None
    to_visit: int
    uncovered: Uncovered
    robots: tuple[RouteEnds, ...] = ()
    objectives: tuple[Objective, ...] = ()

    @property
    def instance(self) -> Instance:
        """The costs between places, by the shortest paths."""
        return self.legs.instance

    def paths(
        self,
        tours: Indices,
        most_cells: int | None = None,
        stop: Callable[[], bool] = lambda: False,
        leg_paths: Numbers | None = None,
    ) -> Iterator[CoveragePath]:
        """Yield the path of each tour, shape (k, n). See `paths_of_plans`.

        `leg_paths` are the numbers of the paths that the legs of each tour take, as in Front.
        """
        returns = tours[:, :1] if self.instance.closed else tours[:, :0]
        ways = np.hstack((tours, returns))
        taken = None if leg_paths is None else list(leg_paths)
        return self.paths_of_plans([[way] for way in ways], most_cells, stop, taken)

    def paths_of_plans(
        self,
        plans: Sequence[Sequence[Indices]],
        most_cells: int | None = None,
        stop: Callable[[], bool] = lambda: False,
        taken: Sequence[Numbers] | None = None,
    ) -> Iterator[CoveragePath]:
        """Yield the path of each way of each plan.

        Args:
            plans: The ways of each plan. A way is places in order, shape (m,), m at least 1.
            most_cells: The most cells of all paths together; None sets no limit. It is checked
                before any path is made.
            stop: Called for each leg and each path; True ends the tracing.
            taken: For each way, plan after plan, the numbers of the paths that its legs take,
                shape (m - 1,). By default all take the shortest.

        Raises:
            Refusal: The paths have more cells than that.
            Cancelled: `stop` returned True.
        """
        ways = list(chain.from_iterable(plans))
        if taken is None:
            taken = [np.zeros(len(way) - 1, np.int8) for way in ways]
        legs_of = [(way[:-1], way[1:]) for way in ways]
        steps = map(self.legs.count_steps, legs_of, taken)
        cells = [sum(1 + int(each.sum()) for each in islice(steps, len(plan))) for plan in plans]
        if most_cells is not None and sum(cells) > most_cells:
            fitting = most_cells // max(cells)
            advice = f"ask for a size of {fitting}" if fitting else "ask without paths"
            raise Refusal(
                "paths-too-long",
                pointer="/paths",
                limit=most_cells,
                actual=sum(cells),
                advice=advice,
            )
        paths = dict(self._paths_of_legs(zip(legs_of, taken, strict=True), stop))
        for (begin, end), numbers, way in zip(legs_of, taken, ways, strict=True):
            _check(stop)
            legs = zip(numbers.tolist(), begin.tolist(), end.tolist(), strict=True)
            parts = [paths[leg][1:] for leg in legs]
            metres = float(self.legs.lengths((begin, end), numbers)[:, 0].sum())
            along = np.concatenate([self.places[way[:1]], *parts])
            visits = np.stack((np.cumsum([0, *map(len, parts)]), way), axis=1)
            yield CoveragePath(along, metres, visits, self.frame)

    def _paths_of_legs(
        self, legs: Iterable[tuple[Legs, Numbers]], stop: Callable[[], bool]
    ) -> Iterator[tuple[tuple[int, int, int], Cells]]:
        """Yield each leg with its cells, in both directions: the path's number and two places.

        Legs are sorted, so that those from one place by one path need one search.
        """
        rows = [np.column_stack((numbers, np.sort(each, axis=0).T)) for each, numbers in legs]
        different = np.unique(np.concatenate([np.empty((0, 3), np.int64), *rows]), axis=0)
        for (number, origin), group in groupby(different.tolist(), key=lambda leg: leg[:2]):
            ends = [end for *_, end in group]
            traced = self.legs.trace(number, origin, ends)
            for end, path in zip(ends, traced, strict=True):
                _check(stop)
                yield (number, origin, end), path
                yield (number, end, origin), path[::-1]


def survey(
    coverage: Coverage,
    max_places: int,
    stop: Callable[[], bool],
    seconds: float = math.inf,
) -> Survey:
    """Return the places of a coverage task and the instance of the costs between them.

    Args:
        max_places: The greatest number of places that a spacing may give.
        stop: Called once for each place, and before and after; True ends the survey.
        seconds: The most processor time that the searches for paths may take.

    Raises:
        InvalidCoverage: No cell is free, a place or a pose is not free or cannot be reached, or the
            second objective has another number of places.
        TooManyPlaces: The spacing gives more than `max_places`.
        InvalidInstance: The second objective's costs are not valid.
        Refusal: The searches take longer than `seconds`, or clearly will.
        Cancelled: `stop` returned True.
    """
    free = free_cells(coverage.blocked, coverage.cell_size, coverage.robot_radius)
    _check(stop)
    if not free.any():
        raise uncoverable("grid", "no-free-cell", far_enough=coverage.far_enough)
    places = find_places(coverage, free, max_places)
    cells = places.cells
    layers = [] if coverage.cost_layers is None else list(coverage.cost_layers)
    grid = make_grid(free, layers[0] if layers else None)
    _check(stop)
    steps = np.zeros((len(cells), len(cells)), np.int32)
    further = [framed_layer(layer) for layer in layers[1:]]
    numbers = cell_numbers(grid, cells)
    pace = Pace(seconds, stop, cells=int(free.sum()), places=len(cells))
    lengths, costs = pairwise_paths(grid, numbers, pace.of(len(cells) - 1), steps, further)
    _check(stop)
    metres = coverage.cell_size * lengths
    matrices = np.concatenate((metres[np.newaxis], _other_objectives(coverage, metres, costs)))
    instance = Instance(matrices=matrices, **places.ends._asdict())
    legs = LegPaths(grid=grid, cells=numbers, instance=instance, steps=steps)
    if coverage.detours:
        of_metres = np.ones(len(grid.free))
        by_objective = coverage.cell_size * np.stack((of_metres, grid.layer, *further))
        legs = replace(
            legs,
            further=find_detours(
                legs, by_objective, pace.of(most_searches(len(cells), len(matrices)))
            ),
        )
        _check(stop)
    return Survey(
        cells,
        places.start,
        legs,
        coverage.frame,
        places.to_visit,
        uncovered(free, cells[0], coverage.cell_size),
        places.robots,
        coverage.names,
    )


def _other_objectives(coverage: Coverage, metres: Array, costs: Array) -> Array:
    """Return the costs of the objectives after metres, shape (m - 1, n, n).

    `costs` are those by the layers, shape (layers, n, n), for each cell and not yet for each metre.
    """
    if coverage.second_matrix is not None:
        return coverage.second_matrix[np.newaxis]
    if coverage.second_coordinates is not None:
        steps = coverage.second_coordinates[:, np.newaxis] - coverage.second_coordinates
        return np.hypot(steps[..., 0], steps[..., 1])[np.newaxis]
    return metres[np.newaxis] if coverage.cost_layers is None else coverage.cell_size * costs


def _check(stop: Callable[[], bool]) -> None:
    if stop():
        raise Cancelled
