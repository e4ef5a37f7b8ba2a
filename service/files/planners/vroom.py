"""Read problems of VROOM, in the JSON of its API: jobs, shipments and vehicles."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

from paretour.member_parts import BreakRequest

from service.files.cells.ids import each_once
from service.files.fleets import (
    ENDS,
    Shipment,
    Stop,
    Vehicle,
    add_windows,
    fleet_request,
    have_times,
    without,
    without_empty,
)
from service.files.json_files.records import is_number
from service.files.places import check_range
from service.files.planners.vroom_costs import objectives_of
from service.files.planners.vroom_members import note_others
from service.files.planners.vroom_times import VroomTask, add_services, load_of_jobs
from service.files.reading import Reading, Source, quoted

_NO_BREAKS = "breaks of vehicles without exactly one time window were left out."
_ROLES: tuple[Literal["pickup", "delivery"], ...] = ("pickup", "delivery")
_LONGEST_DETAIL = 200  # characters


@dataclass
class _Problem:
    """Collects the stops of a problem, with their places and their indexes in matrices."""

    source: Source
    stops: list[Stop] = field(default_factory=list)
    indexes: list[Any] = field(default_factory=list)
    tasks: list[VroomTask] = field(default_factory=list)
    depots: dict[str, str] = field(default_factory=dict)  # the ids of stops, by their places

    def add(self, stop: Stop, place: Any, index: Any, where: str) -> Stop:
        """Add a stop at a place, and return it without members that are empty."""
        found: Stop = {"id": stop["id"]}
        if place is not None:
            if not _are_numbers(place, 2):
                raise self.source.refusal("no-pair-of-degrees", where, came=place)
            check_range(self.source, place, where)
            found["location"] = list(place)
        found |= without_empty(stop)
        self.stops.append(found)
        self.indexes.append(index)
        return found

    def add_task(self, task: dict[str, Any], of: str, where: str, stop: Stop) -> str:
        """Add the stop of a job, a pick-up or a delivery, and return its id."""
        place, index = task.get("location"), task.get("location_index")
        found = self.add(stop, place, index, where)
        self.tasks.append(VroomTask(task, of, where, found, f"{place} {index}"))
        return found["id"]

    def depot(self, place: Any, index: Any, where: str) -> str:
        """Return the id of the stop where a vehicle starts or ends, one for each place."""
        key = f"{place} {index}"
        if key not in self.depots:
            name = f"depot {len(self.depots) + 1}"
            self.depots[key] = self.add({"id": name}, place, index, where)["id"]
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
        UnreadableFile: A member has a wrong type, or a shipment several windows.
    """
    problem = _Problem(source)
    note_others(source, [value], "the problem")
    vehicles = _vehicles(problem, value)
    load = load_of_jobs(value)
    for job, where in _items(source, value, "jobs"):
        name = str(job.get("id", len(problem.stops)))
        stop: Stop = {"id": name, "skills": _skills(source, job, where)}
        stop["demand"] = job.get(load, job.get("amount", 0))
        stop["pickup"] = job.get("pickup", 0) if load == "delivery" else 0
        add_windows(stop, _windows(source, job, where))
        problem.add_task(job, "jobs", where, stop)
    shipments = [
        _shipment(problem, each, where) for each, where in _items(source, value, "shipments")
    ]
    source.check_count("stops", source.bounds.cities, len(problem.stops))
    types = [str(each.get("type", "")) for each in value["vehicles"]]
    named = list(zip((each["id"] for each in vehicles), types, strict=True))
    add_services(source, named, problem.tasks, set(problem.depots))
    _add_descriptions(problem)
    timed = have_times(problem.stops, vehicles)
    stops, indexes = problem.stops, problem.indexes
    objectives = objectives_of(source, value, (stops, indexes), vehicles, timed)
    request = fleet_request(stops, vehicles, objectives, shipments or None)
    return source.reading("fleet", request)


def _add_descriptions(problem: _Problem) -> None:
    """Add the descriptions of tasks, which tell drivers something."""
    texts = {
        each.stop["id"]: str(each.task["description"])[:_LONGEST_DETAIL]
        for each in problem.tasks
        if each.task.get("description")
    }
    if texts:
        problem.source.details.append(("description", texts))


def _items(
    source: Source, value: dict[str, Any], name: str
) -> Iterator[tuple[dict[str, Any], str]]:
    """Yield the objects in a member, and the position of each for sentences."""
    items = value.get(name) or []
    if not isinstance(items, list) or not all(isinstance(each, dict) for each in items):
        raise source.refusal("no-list-of", name, items="objects")
    note_others(source, items, name)
    for at, each in enumerate(items):
        yield each, f"{name}/{at}"


def _vehicles(problem: _Problem, value: dict[str, Any]) -> list[Vehicle]:
    """Return all vehicles, and note what is left out of them."""
    source = problem.source
    items = list(_items(source, value, "vehicles"))
    if not items:
        raise source.refusal("no-list-of", "vehicles", items="one or more")
    vehicles = [_vehicle(problem, each, where) for each, where in items]
    _number_same(source, vehicles)
    if value.get("shipments") and any("max_stops" in each for each in vehicles):
        source.note(
            "left-out", "max_tasks of vehicles was left out: it is not supported beside shipments."
        )
        vehicles = [without(each, ["max_stops"]) for each in vehicles]
    return vehicles


def _number_same(source: Source, vehicles: list[Vehicle]) -> None:
    """Number vehicles that share an id, as VROOM allows for the shifts of one vehicle."""
    given = [each["id"] for each in vehicles]
    for vehicle, name in zip(vehicles, each_once(given), strict=True):
        vehicle["id"] = name
    if shared := [name for name, count in Counter(given).items() if count > 1]:
        named = ", ".join(map(quoted, shared[:3]))
        source.note("ids", f"Vehicles that share an id were numbered, as {named}.")


def _vehicle(problem: _Problem, vehicle: dict[str, Any], where: str) -> Vehicle:
    made: Vehicle = {"id": str(vehicle.get("id", where))}
    for end in ENDS:
        place, index = vehicle.get(end), vehicle.get(f"{end}_index")
        if place is not None or index is not None:
            made[end] = problem.depot(place, index, f"{where}/{end}")
    window = vehicle.get("time_window")
    fixed = vehicle["costs"].get("fixed") if isinstance(vehicle.get("costs"), dict) else 0
    made |= {
        "capacity": vehicle.get("capacity", 0),
        "shift": _window(problem.source, window, f"{where}/time_window") if window else None,
        "skills": _skills(problem.source, vehicle, where),
        "breaks": _breaks(problem.source, vehicle, where),
        "fixed": fixed,
    }
    made = without_empty(made)
    if (most := vehicle.get("max_tasks")) is not None:
        made["max_stops"] = most
    return made


def _breaks(source: Source, vehicle: dict[str, Any], where: str) -> list[BreakRequest]:
    """Return the breaks of a vehicle that have one time window, by ascending time."""
    breaks = vehicle.get("breaks") or []
    if not isinstance(breaks, list) or not all(isinstance(each, dict) for each in breaks):
        raise source.refusal("not-a-list-of", f"{where}/breaks", items="objects", came=breaks)
    note_others(source, breaks, "breaks of vehicles")
    found: list[tuple[list[float], Any]] = []
    for index, each in enumerate(breaks):
        windows, length = each.get("time_windows"), each.get("service", 0)
        if not isinstance(windows, list) or len(windows) != 1:
            source.note("left-out", _NO_BREAKS)
            continue
        part = f"{where}/breaks/{index}"
        if not is_number(length):
            raise source.refusal("no-seconds", f"{part}/service", came=length)
        window = _window(source, windows[0], f"{part}/time_windows/0")
        found.append((window, length))
    found.sort(key=lambda each: each[0][0])
    return [{"window": window, "length": length} for window, length in found]


def _shipment(problem: _Problem, shipment: dict[str, Any], where: str) -> Shipment:
    """Add both stops of a shipment, and return their ids."""
    source = problem.source
    pair: Shipment = {"pickup": "", "delivery": ""}
    skills = _skills(source, shipment, where)
    for role in _ROLES:
        task = shipment.get(role)
        if not isinstance(task, dict):
            raise source.refusal("no-step", where, role=role)
        note_others(source, [task], "steps of shipments")
        load = shipment.get("amount", 0) if role == "pickup" else 0
        name = f"{role} {task.get('id', len(problem.stops))}"
        stop: Stop = {"id": name, "demand": load, "skills": skills}
        add_windows(stop, _windows(source, task, f"{where}/{role}"))
        if "windows" in stop:
            part = f"{where}/{role}/time_windows"
            raise source.refusal("several-windows", part, came=task["time_windows"])
        pair[role] = problem.add_task(task, "steps of shipments", f"{where}/{role}", stop)
    return pair


def _skills(source: Source, task: dict[str, Any], where: str) -> list[str]:
    """Return the skills of a task or a vehicle, which are numbers, as texts."""
    skills = task.get("skills") or []
    if not isinstance(skills, list) or not all(_is_skill(each) for each in skills):
        raise source.refusal("not-a-list-of", f"{where}/skills", items="numbers", came=skills)
    return [str(each) for each in skills]


def _is_skill(value: Any) -> bool:
    return isinstance(value, int | str) and not isinstance(value, bool)


def _windows(source: Source, task: dict[str, Any], where: str) -> list[list[float]]:
    """Return the windows of a task."""
    windows = task.get("time_windows") or []
    if not isinstance(windows, list):
        part = f"{where}/time_windows"
        raise source.refusal("not-a-list-of", part, items="windows", came=windows)
    return [_window(source, each, f"{where}/time_windows/{at}") for at, each in enumerate(windows)]


def _window(source: Source, window: Any, where: str) -> list[float]:
    """Return a window, which must be two times."""
    if not _are_numbers(window, 2):
        raise source.refusal("no-two-times", where, came=window)
    return list(window)


def _are_numbers(value: Any, count: int) -> bool:
    return isinstance(value, list) and len(value) == count and all(map(is_number, value))
