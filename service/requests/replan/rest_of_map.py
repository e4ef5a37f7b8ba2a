"""The rest of a way over a map: from the task of an earlier front and what has changed."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage, size_of
from service.coverage.grid import free_cells
from service.coverage.places import find_places
from service.errors import InvalidCoverage, invalid
from service.replanning.earlier_tours import EarlierTours
from service.requests.limits import Limits, check_amounts, lower_defaults
from service.requests.parser import coverage_task
from service.requests.replan.costs import AllStops
from service.requests.replan.earlier_front import StoredFront, earlier_front_of_map
from service.requests.replan.fields import ReplanRequest, check_of_map
from service.requests.replan.way import (
    RestOfWay,
    driven_tour,
    indexes_in_rest,
    left_of_tours,
    rest_of_way,
)
from service.requests.stops import Stop
from service.requests.task import Task
from service.requests.validation import too_many_cities

Array = NDArray[np.float64]
Cells = NDArray[np.int64]


def rest_of_map(
    request: ReplanRequest,
    stored: StoredFront,
    coverage: Coverage,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
) -> Task:
    """Return the rest of the way over a map.

    Raises:
        Refusal: The request has what only a front of stops has, its map does not fit, a place is
            not free or cannot be reached any more, no actor serves it, or the way cannot be that
            of the front.
    """
    check_of_map(request)
    front = earlier_front_of_map(stored, coverage)
    coverage = _changed_map(coverage, request)
    known = np.array(stored.found.places, np.int64).reshape(-1, 2)
    cells, request = _all_places(known, coverage, request)
    stops = AllStops(tuple(Stop(str(index)) for index in range(len(cells))), front.n, {})
    rest = rest_of_way(front, request, stops)
    n, most = len(rest.stops), limits.most_places(shared=False)
    if n > most:
        raise too_many_cities("add", most, n)
    check_amounts(request, n, limits)
    place = np.full(len(cells), -1)
    place[rest.stops] = np.arange(n)
    driven = driven_tour(front, request)
    left, moved = left_of_tours(front, driven, rest)
    of_rest = _of_rest(coverage, cells, rest, place)
    _check_places(of_rest, rest, front.n, request, limits)
    earlier = EarlierTours(
        tours=place[left],
        min_kept=request.min_kept,
        touched=None if request.map_changed else indexes_in_rest(place, moved),
        balance=front.balance_of(driven),
    )
    return coverage_task(lower_defaults(request, n, limits), of_rest, actors, earlier)


def _all_places(
    known: Cells, coverage: Coverage, request: ReplanRequest
) -> tuple[Cells, ReplanRequest]:
    """Return the known places, those added, and maybe one where the way goes on, in this order.

    In the request that is returned, the position is a known place or the last of all.

    Raises:
        Refusal: A new one is no cell of the grid, or has no costs.
    """
    new = []
    for index, item in enumerate(request.add):
        if not isinstance(item, list):
            raise invalid(f"add/{index}", "must be row and column of a place on the map")
        _check_costs(coverage, f"add/{index}")
        new.append(item)
    name, cell = _position_cell(coverage, request)
    if cell is None:
        return (np.concatenate((known, _cells(new))), request)
    there = np.flatnonzero((known == cell).all(axis=1))
    if coverage.cost_layer is None and len(there):
        request = request.model_copy(update={"position": int(there[0])})
        return (np.concatenate((known, _cells(new))), request)
    _check_costs(coverage, name)
    request = request.model_copy(update={"position": cell})
    return (np.concatenate((known, _cells([*new, cell]))), request)


def _cells(cells: list[list[int]]) -> Cells:
    return np.array(cells, np.int64).reshape(-1, 2)


def _position_cell(coverage: Coverage, request: ReplanRequest) -> tuple[str, list[int] | None]:
    """Return the cell where the way goes on, None if that is a place, and the field that says it.

    Raises:
        Refusal: It is said twice, is no cell of the grid, or is in a frame that nobody knows.
    """
    if not request.pose:
        if isinstance(request.position, list):
            return "position", request.position
        if request.position is None or isinstance(request.position, int | str):
            return "position", None
        raise invalid("position", "must be a place of the front, or row and column of one")
    if request.position is not None:
        raise invalid("pose", "or position must be left out")
    if coverage.frame is None:
        raise invalid("pose", "must be in the frame of a map with an origin")
    row, column = coverage.frame.cell(*request.pose[:2])
    rows, columns = coverage.blocked.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise invalid("pose", f"must be in a cell of the grid of {coverage.size}")
    return "pose", [row, column]


def _check_costs(coverage: Coverage, part: str) -> None:
    if coverage.cost_layer is None:
        demand = "must be in the cell of a place, as only a cost_layer has costs of other cells"
        raise invalid(part, demand)


def _changed_map(coverage: Coverage, request: ReplanRequest) -> Coverage:
    """Return the task on the map as it is now, with its second objective as it is now."""
    blocked = coverage.blocked.copy()
    if request.grid.size:
        blocked = _whole_map(request.grid, coverage)
    for name, cells, now in (("blocked", request.blocked, True), ("freed", request.freed, False)):
        for index, (row, column) in enumerate(cells):
            if row >= blocked.shape[0] or column >= blocked.shape[1]:
                demand = f"must be a cell of the grid of {coverage.size}, got [{row}, {column}]"
                raise invalid(f"{name}/{index}", demand)
            blocked[row, column] = now
    if not request.cost_layer.size:
        return replace(coverage, blocked=blocked)
    return replace(
        coverage,
        blocked=blocked,
        cost_layer=request.cost_layer,
        second_matrix=None,
        second_coordinates=None,
    )


def _whole_map(grid: Array, coverage: Coverage) -> NDArray[np.bool_]:
    if grid.shape != coverage.blocked.shape:
        demand = f"must be as large as that of the front, {coverage.size}, got {size_of(grid)}"
        raise invalid("grid", demand)
    binary = (grid == 0) | (grid == 1)
    if not binary.all():
        row, column = np.unravel_index(binary.argmin(), binary.shape)
        raise invalid(f"grid/{row}/{column}", f"must be 0 or 1, got {grid[row, column]:g}")
    return grid > 0


def _of_rest(
    coverage: Coverage, cells: Cells, rest: RestOfWay, place: NDArray[np.int64]
) -> Coverage:
    """Return the task of the rest: its places, and the second objective between them."""
    matrix, points = coverage.second_matrix, coverage.second_coordinates
    ends = rest.end_members(place)
    return replace(
        coverage,
        places=cells[rest.stops],
        spacing=None,
        start_pose=None,
        end_pose=None,
        start=ends["start"] or 0,
        ends=rest.ends_at(place),
        second_matrix=None if matrix is None else matrix[np.ix_(rest.stops, rest.stops)],
        second_coordinates=None if points is None else points[rest.stops],
    )


def _check_places(
    task: Coverage, rest: RestOfWay, n: int, request: ReplanRequest, limits: Limits
) -> None:
    """Raise a refusal, about the parts of the request, where a place cannot be visited."""
    free = free_cells(task.blocked, task.cell_size, task.robot_radius)
    try:
        find_places(task, free, limits.most_places(shared=False))
    except InvalidCoverage as refusal:
        position = "pose" if request.pose else "position"
        raise InvalidCoverage(*_about_request(refusal.faults, rest, n, position)) from None


def _about_request(
    faults: tuple[tuple[str, str], ...], rest: RestOfWay, n: int, position: str
) -> Iterator[tuple[str, str]]:
    """Yield the faults of places of the rest as faults of parts of the request."""
    for part, demand in faults:
        name, _, index = part.partition("/")
        if name != "places":
            yield part, demand
            continue
        stop = int(rest.stops[int(index)])
        # The request does not name places of the rest.
        demand = re.sub(r"from places/\d+", "from where the way goes on", demand)
        if stop == rest.start:
            yield position, demand
        elif stop < n:
            yield "remove", f"must have place {stop}, as it {demand}"
        else:
            yield f"add/{stop - n}", demand
