"""The rest of a way over a map: from the task of an earlier front and what has changed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from service.actor_info import ActorInfo
from service.coverage.coverage import Coverage, check_layer, size_of
from service.errors import Fault, InvalidCoverage, invalid
from service.requests.arrays import Array, check_grid
from service.requests.limits import Limits, within_limits
from service.requests.maps.day import hours_from
from service.requests.parser import coverage_task
from service.requests.replan.fields import ReplanRequest, check_fields
from service.requests.replan.way import (
    ReplanSource,
    RestOfWay,
    earlier_front_of_map,
    not_replannable,
    rest_of_way,
)
from service.requests.task import SharedCoverage, Task
from service.requests.validation import parse_json, too_many_cities

Cells = NDArray[np.int64]


def rest_of_map(
    coverage: Coverage,
    _: Task,
    source: ReplanSource,
    limits: Limits,
    actors: Mapping[str, ActorInfo],
) -> Task:
    """Return the rest of the way over a map.

    Raises:
        Refusal: The request has what only a front of stops has, its map does not fit, no actor
            serves it, or the way cannot be that of the front. A worker surveys the map, and
            refuses places that are not free or cannot be reached any more.
    """
    request = parse_json(ReplanRequest, source.body)
    check_fields(request, on_map=True)
    front = earlier_front_of_map(source.front, coverage)
    changes = _changes(coverage, request)
    known = np.array(source.front.found.places, np.int64).reshape(-1, 2)
    anywhere = "cost_layers" in changes or coverage.cost_layers is not None
    cells, request = _all_places(known, coverage, request, anywhere)
    rest = rest_of_way(front, request)
    n, most = len(rest.stops), limits.most_places(shared=False)
    if n > most:
        raise too_many_cities("add", most, n)
    request = within_limits(request, n, limits)
    matrix, points = coverage.second_matrix, coverage.second_coordinates
    if "cost_layers" in changes:  # they replace both
        matrix = points = None
    members = {
        "places": cells[rest.stops],
        "second_matrix": None if matrix is None else matrix[np.ix_(rest.stops, rest.stops)],
        "second_coordinates": None if points is None else points[rest.stops],
        "start": rest.begin or 0,
        "ends": rest.ends_in_rest,
        "hours": hours_from(coverage.hours, request.now),
        **dict.fromkeys(("spacing", "start_pose", "end_pose")),
        **changes,
    }
    changed = None if changes else np.empty(0, np.int64)
    task = coverage_task(
        request,
        replace(coverage, **members),
        actors,
        earlier=rest.earlier_tours(front, request, changed),
    )
    return replace(task, parts=tuple(_parts(request, rest, len(known))))


def rest_of_robots(
    _: SharedCoverage, __: Task, source: ReplanSource, ___: Limits, ____: Mapping[str, ActorInfo]
) -> NoReturn:
    """Refuse to replan several robots.

    Raises:
        Refusal: Always.
    """
    parse_json(ReplanRequest, source.body)
    raise not_replannable(source.front.id, "it is of plans for several robots")


def _changes(coverage: Coverage, request: ReplanRequest) -> dict[str, Any]:
    """Return the members of the task that are about the map, as far as they have changed."""
    changes: dict[str, Any] = {}
    if request.grid.size or request.blocked or request.freed:
        changes["blocked"] = _blocked(coverage, request)
    if request.cost_layer.size or request.cost_layers:
        changes["cost_layers"] = _layers(coverage, request)
    return changes


def _layers(coverage: Coverage, request: ReplanRequest) -> Array:
    """Return the cost layers of the map as they are now, shape (layers, rows, columns)."""
    names = [layer.name for layer in coverage.layers]
    if request.cost_layer.size:
        if names:
            raise invalid("cost_layer", "layers-have-names")
        return request.cost_layer[np.newaxis]
    if coverage.cost_layers is None or not names:
        raise invalid("cost_layers", "no-layer-names")
    layers = coverage.cost_layers.copy()
    for index, item in enumerate(request.cost_layers):
        part = f"cost_layers/{index}"
        if item.name not in names:
            known = ", ".join(names)
            raise invalid(f"{part}/name", "not-a-layer", names=known, came=item.name)
        layer = item.array(index)
        check_layer(layer, f"{part}/layer", coverage.blocked)
        layers[names.index(item.name)] = layer
    return layers


def _blocked(coverage: Coverage, request: ReplanRequest) -> NDArray[np.bool_]:
    """Return the obstacles of the map as it is now."""
    blocked = coverage.blocked.copy()
    if request.grid.size:
        if request.grid.shape != blocked.shape:
            sizes = {"size": coverage.size, "given": size_of(request.grid)}
            raise invalid("grid", "other-size", like="that of the front", **sizes)
        check_grid(request.grid)
        blocked = request.grid > 0
    for name, cells, now in (("blocked", request.blocked, True), ("freed", request.freed, False)):
        for index, (row, column) in enumerate(cells):
            if row >= blocked.shape[0] or column >= blocked.shape[1]:
                values = {"size": coverage.size, "given": f"[{row}, {column}]"}
                raise invalid(f"{name}/{index}", "outside-grid", **values)
            blocked[row, column] = now
    return blocked


def _all_places(
    known: Cells, coverage: Coverage, request: ReplanRequest, anywhere: bool
) -> tuple[Cells, ReplanRequest]:
    """Return the known places, those added, and maybe one where the way goes on, in this order.

    In the request that is returned, the position is a known place or the last of all.

    Args:
        known: The places of the front, shape (n, 2).
        anywhere: Whether there are costs from and to any cell, not only those of known places.
    """
    new = []
    for index, item in enumerate(request.add):
        if not isinstance(item, list):
            raise invalid(f"add/{index}", "stop-for-a-cell")
        _check_costs(anywhere, f"add/{index}")
        new.append(item)
    name, cell = _position_cell(coverage, request)
    if cell is not None:
        position: list[int] | int = cell
        there = np.flatnonzero((known == cell).all(axis=1))
        if not anywhere and len(there):
            position = int(there[0])
        else:
            _check_costs(anywhere, name)
            new.append(cell)
        request = request.model_copy(update={"position": position})
    return np.concatenate((known, np.array(new, np.int64).reshape(-1, 2))), request


def _position_cell(coverage: Coverage, request: ReplanRequest) -> tuple[str, list[int] | None]:
    """Return the field that says where the way goes on, and the cell; None if it names a place."""
    if not request.pose:
        if isinstance(request.position, list):
            return "position", request.position
        if request.position is None or isinstance(request.position, int | str):
            return "position", None
        raise invalid("position", "not-a-place")
    if request.position is not None:
        raise invalid("pose", "or-left-out", member="position")
    if coverage.frame is None:
        raise invalid("pose", "no-origin")
    row, column = coverage.frame.cell(*request.pose[:2])
    rows, columns = coverage.blocked.shape
    if not (0 <= row < rows and 0 <= column < columns):
        raise invalid("pose", "pose-outside-grid", size=coverage.size)
    return "pose", [row, column]


def _check_costs(anywhere: bool, part: str) -> None:
    if not anywhere:
        raise invalid(part, "no-costs-there")


def _parts(request: ReplanRequest, rest: RestOfWay, n: int) -> Iterator[str]:
    """Yield the part of a request that names each place of the rest; n places are the front's."""
    for stop in rest.stops.tolist():
        if stop == rest.start:
            yield "pose" if request.pose else "position"
        else:
            yield f"places/{stop}" if stop < n else f"add/{stop - n}"


def about_request(refusal: InvalidCoverage, parts: Sequence[str]) -> InvalidCoverage:
    """Return the refusal of places of the rest as one of the parts that name them.

    Args:
        refusal: The refusal, about the places in the order of the rest.
        parts: The part for each place; places/2 is a place of the front, not in the request.
    """
    return InvalidCoverage(*(_about_part(fault, parts) for fault in refusal.faults))


def _about_part(fault: Fault, parts: Sequence[str]) -> Fault:
    if fault.part is None or not fault.part.startswith("places/"):
        return fault
    # The request does not name places of the rest.
    code = "unreachable-from-here" if fault.code == "unreachable" else fault.code
    values = {name: value for name, value in fault.values.items() if name != "other"}
    part = parts[int(fault.part.removeprefix("places/"))]
    if not part.startswith("places/"):
        return Fault.of(part, code, **values)
    place = int(part.removeprefix("places/"))
    return Fault.of("remove", "place-lost", place=place, because=code, **values)
