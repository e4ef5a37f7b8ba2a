"""Read the columns of a table of vehicles that bound routes: skills, stops, trips and overtime."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, Literal

from service.errors.faults import show
from service.files.cells.times import seconds_in
from service.files.columns import Columns
from service.files.fleets import Stop, Vehicle, in_shifts
from service.files.reading import quoted
from service.files.visits import texts_in

_Bound = Literal["max_stops", "min_stops", "max_trips", "max_overtime", "speed_factor"]
_PER_UNIT = 8  # vehicles whose skills are compared for one unit of work


def add_skills(columns: Columns, vehicles: list[Vehicle]) -> None:
    """Add what vehicles are able to do."""
    for row, skills in columns.values("skills", partial(texts_in, columns)):
        vehicles[row]["skills"] = skills


def add_profiles(columns: Columns, vehicles: list[Vehicle], *, located: bool) -> None:
    """Add the profiles by which vehicles drive by road; leave them out where nothing knows them.

    A field that is no profile of the routing engine is kept as wrong.
    """
    known = columns.source.bounds.profiles
    if not known or not located:
        columns.leave_out("profile", " without profiles of a routing engine")
    for row, profile in columns.values("profile", partial(_profile, columns)):
        vehicles[row]["profile"] = profile


def _profile(columns: Columns, row: int, at: int) -> str:
    profile, known = " ".join(columns.text(row, at).split()), columns.source.bounds.profiles
    if profile not in known:
        names = " or ".join(map(show, known))
        raise columns.refuse(row, at, "not-a-road-profile", names=names, came=profile)
    return profile


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
    readers: Mapping[_Bound, Callable[[int, int], Any]] = {
        "max_stops": partial(_max_stops, columns),
        "min_stops": columns.whole,
        "max_trips": partial(_max_trips, columns, vehicles),
        "max_overtime": partial(_max_overtime, columns, vehicles),
        "speed_factor": partial(_speed_factor, columns),
    }
    for name, read in readers.items():
        for row, value in columns.values(name, read):
            vehicles[row][name] = value


def _max_stops(columns: Columns, row: int, at: int) -> int:
    for name in ("reload", "max_trips"):
        other = columns.find(name)
        if other is not None and columns.text(row, other):
            beside, came = columns.names[other], columns.text(row, at)
            raise columns.refuse(row, at, "empty-beside", beside=beside, came=came)
    return columns.whole(row, at)


def _max_trips(columns: Columns, vehicles: Sequence[Vehicle], row: int, at: int) -> int:
    """Return the most trips of a route; by default its vehicle loads again where it starts."""
    vehicle = vehicles[row]
    if "reload" not in vehicle:
        if (start := vehicle.get("start")) is None:
            raise columns.refuse(row, at, "no-column-reload")
        vehicle["reload"] = [start]
    return columns.whole(row, at)


def _speed_factor(columns: Columns, row: int, at: int) -> float:
    factor = columns.amount(row, at)
    if factor == 0:
        raise columns.refuse(row, at, "no-speed", came=columns.text(row, at))
    return factor


def _max_overtime(columns: Columns, vehicles: Sequence[Vehicle], row: int, at: int) -> float | None:
    overtime = seconds_in(columns, row, at)
    if overtime and not in_shifts([vehicles[row]]):
        raise columns.refuse(row, at, "no-shift", came=columns.text(row, at))
    return overtime or None


def add_times(columns: Columns, vehicles: list[Vehicle], clock: bool) -> None:
    """Add the least time of routes, and how fast vehicles serve; neither without a clock."""
    if not clock:
        columns.leave_out("shortest_time", " without times")
        columns.leave_out("service_factor", " without times")
    for row, time in columns.values("shortest_time", partial(seconds_in, columns), 0.0):
        vehicles[row]["shortest"] = time
    for row, factor in columns.values("service_factor", columns.amount, 0.0):
        vehicles[row]["service_factor"] = factor
