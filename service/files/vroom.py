"""Read problems of VROOM, in the JSON of its API: jobs, shipments and vehicles."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from service.files.fleets import Stop, fleet_request, measured, timed
from service.files.places import check_range, note_places
from service.files.reading import Reading, Source, quoted

_LEFT_OUT = {
    "jobs": ("skills", "priority", "setup", "pickup"),
    "shipments": ("skills", "priority"),
    "vehicles": ("skills", "breaks", "speed_factor", "max_tasks", "max_travel_time", "max_distance",
                 "steps", "type"),
}  # fmt: skip


@dataclass
class _Problem:
    """Collects the stops of a problem, with their places and their indexes in matrices."""

    source: Source
    stops: list[Stop] = field(default_factory=list)
    indexes: list[Any] = field(default_factory=list)
    depots: dict[str, str] = field(default_factory=dict)  # the ids of stops, by their places

    def add(self, name: str, place: Any, index: Any, where: str, **members: Any) -> str:
        """Add a stop, and return its id."""
        stop: Stop = {"id": name}
        if place is not None:
            if not _are_numbers(place, 2):
                raise self.source.refusal(f"{where} must be longitude and latitude", place)
            check_range(self.source, place, where)
            stop["location"] = list(place)
        self.stops.append({**stop, **{k: v for k, v in members.items() if v}})
        self.indexes.append(index)
        return name

    def depot(self, place: Any, index: Any, where: str) -> str:
        """Return the id of the stop where a vehicle starts or ends, one for each place."""
        key = f"{place} {index}"
        if key not in self.depots:
            name = f"depot {len(self.depots) + 1}"
            self.depots[key] = self.add(name, place, index, where)
        return self.depots[key]


def is_vroom(value: dict[str, Any]) -> bool:
    """Return whether a JSON object is a problem of VROOM."""
    shipments = value.get("shipments")
    of_tasks = isinstance(shipments, list) and any(
        isinstance(each, dict) and isinstance(each.get("pickup"), dict) for each in shipments
    )
    return "vehicles" in value and "stops" not in value and ("jobs" in value or of_tasks)


def read_vroom(source: Source, value: dict[str, Any]) -> Reading:
    """Return a problem as the request for a fleet.

    Raises:
        UnreadableFile: A member has a wrong type, or several windows.
    """
    problem = _Problem(source)
    vehicles = [_vehicle(problem, each, where) for each, where in _items(source, value, "vehicles")]
    for job, where in _items(source, value, "jobs"):
        _add_task(
            problem,
            job,
            where,
            str(job.get("id", len(problem.stops))),
            job.get("delivery", job.get("amount")),
        )
    shipments = []
    for shipment, where in _items(source, value, "shipments"):
        pair = {}
        for role in ("pickup", "delivery"):
            task = shipment.get(role)
            if not isinstance(task, dict):
                raise source.refusal(f"{where} must have a {role}, an object")
            load = shipment.get("amount") if role == "pickup" else None
            name = f"{role} {task.get('id', len(problem.stops))}"
            pair[role] = _add_task(problem, task, f"{where}/{role}", name, load)
        shipments.append(pair)
    source.check_count("stops", source.bounds.cities, len(problem.stops))
    clock = timed(problem.stops) or any("shift" in vehicle for vehicle in vehicles)
    objectives = _objectives(problem, value, clock)
    request = fleet_request(problem.stops, vehicles, objectives)
    if shipments:
        request["shipments"] = shipments
    return source.reading("fleet", request)


def _items(
    source: Source, value: dict[str, Any], name: str
) -> Iterator[tuple[dict[str, Any], str]]:
    """Yield the objects in a member, and the position of each for sentences."""
    items = value.get(name) or []
    if not isinstance(items, list) or not all(isinstance(each, dict) for each in items):
        raise source.refusal(f"{name} must be a list of objects")
    for member in _LEFT_OUT[name]:
        if any(each.get(member) for each in items):
            source.note_left_out(f"{member} of {name}")
    for at, each in enumerate(items):
        yield each, f"{name}/{at}"


def _vehicle(problem: _Problem, vehicle: dict[str, Any], where: str) -> dict[str, Any]:
    made: dict[str, Any] = {"id": str(vehicle.get("id", where))}
    for end in ("start", "end"):
        place, index = vehicle.get(end), vehicle.get(f"{end}_index")
        if place is not None or index is not None:
            made[end] = problem.depot(place, index, f"{where}/{end}")
    if vehicle.get("capacity"):
        made["capacity"] = vehicle["capacity"]
    if shift := _window(problem.source, [vehicle.get("time_window")], f"{where}/time_window"):
        made["shift"] = shift
    fixed = vehicle["costs"].get("fixed") if isinstance(vehicle.get("costs"), dict) else None
    return {**made, "fixed": fixed} if fixed else made


def _add_task(problem: _Problem, task: dict[str, Any], where: str, name: str, load: Any) -> str:
    windows = task.get("time_windows") or []
    window = _window(problem.source, windows, f"{where}/time_windows")
    place, index = task.get("location"), task.get("location_index")
    service = task.get("service")
    return problem.add(name, place, index, where, service=service, demand=load, window=window)


def _window(source: Source, windows: Any, where: str) -> list[float] | None:
    """Return the only window of a list, or None if it is empty."""
    if not windows or windows == [None]:
        return None
    if not isinstance(windows, list) or len(windows) > 1:
        raise source.refusal(f"{where} must be one window", windows)
    if not _are_numbers(windows[0], 2):
        raise source.refusal(f"{where} must be two times in seconds", windows[0])
    return list(windows[0])


def _are_numbers(value: Any, count: int) -> bool:
    return (
        isinstance(value, list)
        and len(value) == count
        and all(isinstance(each, int | float) and not isinstance(each, bool) for each in value)
    )


def _objectives(problem: _Problem, value: dict[str, Any], clock: bool) -> list[dict[str, Any]]:
    """Return both objectives: from the matrices of the first profile, or from the stops' places."""
    source = problem.source
    matrices = value.get("matrices")
    if not isinstance(matrices, dict) or not matrices:
        if any("location" not in stop for stop in problem.stops):
            raise source.refusal("each task must have a location, as there are no matrices")
        note_places(source, problem.stops)
        return measured(source, clock)
    profile, costs = next(iter(matrices.items()))
    if len(matrices) > 1:
        source.note_left_out(f"all profiles but {quoted(profile)}")
    given = costs if isinstance(costs, dict) else {}
    durations = _submatrix(problem, given.get("durations"), f"matrices/{profile}/durations")
    other = given.get("distances") or given.get("costs")
    first = {"name": "total time", "unit": "s", "matrix": durations}
    if other:
        matrix = _submatrix(problem, other, f"matrices/{profile}/distances")
        first = {"name": "distance", "matrix": matrix}
    second = {"name": "longest route", "unit": "s", "matrix": durations}
    return [{**first, "over": "sum"}, {**second, "over": "max"}]


def _submatrix(problem: _Problem, matrix: Any, where: str) -> list[list[Any]]:
    """Return the costs between the stops, by their indexes in a matrix."""
    source, indexes = problem.source, problem.indexes
    source.check_count("stops with a matrix", source.bounds.matrix_cities, len(indexes))
    for at, index in enumerate(indexes):
        if not isinstance(index, int) or index < 0:
            name = quoted(problem.stops[at]["id"])
            raise source.refusal(f"{name} must have a location_index, as there are matrices")
    try:
        return [[matrix[row][column] for column in indexes] for row in indexes]
    except (TypeError, IndexError, KeyError):
        demand = f"{where} must have a row and a column for each location_index"
        raise source.refusal(f"{demand}, up to {max(indexes)}") from None
