"""Make the source of a task for the rest of a way over a map, from an earlier front and changes."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from service.coverage.coverage import Coverage, size_of
from service.coverage.grid import free_cells
from service.coverage.places import find_places
from service.errors import InvalidCoverage
from service.replanning.earlier_tours import EarlierTours
from service.requests.limits import Limits, check_amounts
from service.requests.replan.costs import AllStops
from service.requests.replan.earlier_front import StoredFront
from service.requests.replan.earlier_map import read_earlier_map
from service.requests.replan.fields import ReplanRequest
from service.requests.replan.map_fields import check_of_map
from service.requests.replan.new_places import all_places
from service.requests.replan.rest_members import EarlierMembers
from service.requests.replan.way import (
    RestOfWay,
    driven_tour,
    indexes_in_rest,
    left_of_tours,
    rest_of_way,
)
from service.requests.stops import Stop
from service.requests.task import TaskSource
from service.requests.validation import invalid, too_many_cities

Array = NDArray[np.float64]
Cells = NDArray[np.int64]
_FREE, _BLOCKED = 255, 0  # shades of a PGM file


def rest_of_map(request: ReplanRequest, stored: StoredFront, limits: Limits) -> TaskSource:
    """Return the rest of the way over a map as the source of a task, complete by itself.

    Raises:
        Refusal: The request has what only a front of stops has, its map does not fit, a place is
            no longer free or reachable, or the rest of the way does not fit the front.
    """
    check_of_map(request)
    earlier = read_earlier_map(stored, limits)
    coverage = _changed_map(earlier.coverage, request)
    places = all_places(earlier, coverage, request)
    request = places.request
    named = tuple(Stop(str(index)) for index in range(len(places.cells)))
    stops = AllStops(named, earlier.front.n, {})
    rest = rest_of_way(earlier.front, request, stops)
    most = limits.most_places(shared=False)
    if len(rest.stops) > most:
        raise too_many_cities("add", most, len(rest.stops))
    check_amounts(request, len(rest.stops), limits)
    place = np.full(len(places.cells), -1)
    place[rest.stops] = np.arange(len(rest.stops))
    driven = driven_tour(earlier.front, request)
    left, moved = left_of_tours(earlier.front, driven, rest)
    task = _task_of_rest(coverage, places.cells, rest, place)
    _check_places(task, rest, earlier.front.n, request, limits)
    members = {
        **_members(task),
        **rest.end_members(place),
        **EarlierMembers.members(
            EarlierTours(
                tours=place[left],
                min_kept=request.min_kept,
                touched=None if request.map_changed else indexes_in_rest(place, moved),
                balance=earlier.front.balance_of(driven),
            )
        ),
        **request.model_dump(include={*request.options_given, "paths"}),
    }
    body = to_json(members, inf_nan_mode="null")
    return TaskSource("replan-coverage", body, _picture(task.blocked))


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


def _task_of_rest(
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


def _members(task: Coverage) -> dict[str, Any]:
    """Return the members of a request that describe a task, without its map and ends."""
    assert task.places is not None
    second = {
        "second_matrix": task.second_matrix,
        "cost_layer": task.cost_layer,
        "second_coordinates": task.second_coordinates,
    }
    given: Mapping[str, Array] = {k: v for k, v in second.items() if v is not None}
    origin = {} if task.origin is None else {"origin": list(task.origin)}
    return {
        "cell_size": task.cell_size,
        "robot_radius": task.robot_radius,
        **origin,
        "places": task.places.tolist(),
        **{name: array.tolist() for name, array in given.items()},
    }


def _picture(blocked: NDArray[np.bool_]) -> bytes:
    """Return a map as a PGM file, with one byte for each cell."""
    rows, columns = blocked.shape
    shades = np.where(blocked, _BLOCKED, _FREE).astype(np.uint8)
    return b"P5 %d %d %d\n" % (columns, rows, _FREE) + shades.tobytes()
