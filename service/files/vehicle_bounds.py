"""Read the columns of a table of vehicles that bound routes: skills, stops, trips and overtime."""

from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from service.files.cells.times import seconds_in
from service.files.columns import Columns
from service.files.fleets import Stop, Vehicle, in_shifts
from service.files.reading import UnreadableFile, quoted
from service.files.visits import texts_in

_PER_UNIT = 8  # vehicles whose skills are compared for one unit of work


def add_skills(columns: Columns, vehicles: list[Vehicle]) -> None:
    """Add what vehicles are able to do."""
    if (at := columns.find("skills")) is not None:
        for row in columns.filled(at):
            vehicles[row]["skills"] = texts_in(columns, row, at)


def check_servers(
    visits: Columns, stops: list[Stop], columns: Columns, vehicles: list[Vehicle]
) -> None:
    """Check that a vehicle may visit each stop; leave out skills if vehicles have none.

    Fields that name a vehicle that does not exist, or skills that none has, are kept as wrong.
    """
    if "skills" not in columns.fields:
        visits.leave_out("skills", " without skills of vehicles")
        for stop in stops:
            stop.pop("skills", None)
    by_id = {vehicle["id"]: vehicle for vehicle in vehicles}
    _check_pinned(visits, stops, by_id, columns.source.name)
    if (at := visits.find("skills")) is not None:
        for row in visits.filled(at):
            visits.source.spend(len(vehicles) // _PER_UNIT)
            name = stops[row].get("vehicle")
            able = [each for each in vehicles if name in (None, each["id"])]
            if able and not _any_has(able, stops[row]["skills"]):
                whose = "one vehicle" if name is None else f"vehicle {quoted(name)}"
                visits.refuse(row, at, "no-such-skills", whose=whose, came=visits.text(row, at))


def _check_pinned(
    visits: Columns, stops: list[Stop], by_id: Mapping[str, Vehicle], file: str
) -> None:
    """Check that the vehicles that stops name are those of the other file."""
    if (at := visits.find("vehicle")) is not None:
        for row in visits.filled(at):
            if stops[row]["vehicle"] not in by_id:
                visits.refuse(row, at, "no-such-vehicle", table=file, came=stops[row]["vehicle"])


def _any_has(vehicles: Iterable[Vehicle], skills: Sequence[str]) -> bool:
    """Return whether a vehicle has all skills."""
    return any(set(skills) <= set(vehicle.get("skills", ())) for vehicle in vehicles)


def add_bounds(columns: Columns, vehicles: list[Vehicle]) -> None:
    """Add the bounds on the routes of vehicles, whose places and shifts are known.

    Fields that are not numbers, or need a shift or a stop for loading again, are kept as wrong.
    """
    for name, add in (
        ("max_stops", _add_max_stops),
        ("min_stops", _add_min_stops),
        ("max_trips", _add_max_trips),
        ("max_overtime", _add_max_overtime),
        ("speed_factor", _add_speed),
    ):
        if (at := columns.find(name)) is not None:
            for row in columns.filled(at):
                columns.tried(None, add, columns, row, at, vehicles[row])


def _add_max_stops(columns: Columns, row: int, at: int, vehicle: Vehicle) -> None:
    for name in ("reload", "max_trips"):
        other = columns.find(name)
        if other is not None and columns.text(row, other):
            raise _beside(columns, row, at, other)
    vehicle["max_stops"] = columns.whole(row, at)


def _add_min_stops(columns: Columns, row: int, at: int, vehicle: Vehicle) -> None:
    vehicle["min_stops"] = columns.whole(row, at)


def _beside(columns: Columns, row: int, at: int, other: int) -> UnreadableFile:
    beside, came = columns.names[other], columns.text(row, at)
    return columns.refuse(row, at, "empty-beside", beside=beside, came=came)


def _add_max_trips(columns: Columns, row: int, at: int, vehicle: Vehicle) -> None:
    """Add the most trips of a route; by default vehicles load again where they start."""
    if "reload" not in vehicle:
        if "start" not in vehicle:
            raise columns.refuse(row, at, "no-column-reload")
        vehicle["reload"] = [vehicle["start"]]
    vehicle["max_trips"] = columns.whole(row, at)


def _add_speed(columns: Columns, row: int, at: int, vehicle: Vehicle) -> None:
    factor = columns.amount(row, at)
    if factor == 0:
        raise columns.refuse(row, at, "no-speed", came=columns.text(row, at))
    vehicle["speed_factor"] = factor


def add_times(columns: Columns, vehicles: list[Vehicle], clock: bool) -> None:
    """Add the least time of routes, and how fast vehicles serve; neither without a clock."""
    for name, member in (("shortest_time", "shortest"), ("service_factor", "service_factor")):
        if not clock:
            columns.leave_out(name, " without times")
        if (at := columns.find(name)) is not None:
            read = partial(seconds_in, columns) if member == "shortest" else columns.amount
            for row in columns.filled(at):
                vehicles[row][member] = columns.tried(0.0, read, row, at)


def _add_max_overtime(columns: Columns, row: int, at: int, vehicle: Vehicle) -> None:
    if overtime := seconds_in(columns, row, at):
        if not in_shifts([vehicle]):
            raise columns.refuse(row, at, "no-shift", came=columns.text(row, at))
        vehicle["max_overtime"] = overtime
