"""Read a table of stops and a table of vehicles as the request for a fleet."""

import re
from collections.abc import Mapping
from functools import partial

from paretour.members import FleetRequest

from service.files.cells.durations import read_units
from service.files.cells.times import is_time, read_calendar, recognise_hours, seconds_in, spans_in
from service.files.column_names import fields_of, is_about_vehicles, plain_name
from service.files.columns import Columns, columns_of, columns_of_vehicles
from service.files.depots import with_depots
from service.files.fleets import ENDS, End, Stop, Vehicle, add_shifts, fleet_of_tables, have_times
from service.files.groups import groups_of, have_waits
from service.files.reading import Reading, Source, quoted, reading_of_several
from service.files.stop_tables import check_degrees, visits_of
from service.files.tables import Table
from service.files.vehicle_bounds import (
    add_bounds,
    add_profiles,
    add_skills,
    add_times,
    check_servers,
)
from service.files.vehicle_loads import add_loads
from service.files.visits import add_visits, texts_in

# Members by column.
_ENDS: Mapping[str, tuple[End, ...]] = {"depot": ENDS, "start": ENDS[:1], "end": ENDS[1:]}
_KILOMETRE, _HOUR = 1000.0, 3600.0
_IN_KILOMETRES = re.compile(r"km\b", re.IGNORECASE)


def has_vehicles(table: Table) -> bool:
    """Return whether a table is about vehicles, by its heading."""
    return table.heading is not None and is_about_vehicles(table.heading)


def has_places(table: Table) -> bool:
    """Return whether a table says where its rows are, as one of stops does, by its heading."""
    return bool({"latitude", "x", "place"} & set(fields_of(table.heading or [])))


def read_fleet(of_stops: tuple[Source, Table], of_vehicles: tuple[Source, Table]) -> Reading:
    """Return the request for the stops of one table and the vehicles of the other.

    Raises:
        UnreadableFile: A field does not fit its column, or columns are missing.
    """
    source, other = of_stops[0], of_vehicles[0]
    visits = columns_of(*of_stops)
    stops, plane = visits_of(visits)
    columns = _columns_of_vehicles(other, of_vehicles[1], stops)
    read_calendar([visits, columns])
    units = add_visits(visits, stops)
    groups = groups_of(visits, stops)
    waits = have_waits(groups)
    if plane is None:
        recognise_hours(columns)
        read_units(columns)
    read = _Vehicles(columns, stops, located=plane is None)
    vehicles = read.read()
    _name_servers(stops, read.names)
    add_loads(columns, vehicles, visits, stops, units)
    add_skills(columns, vehicles)
    check_servers(visits, stops, columns, vehicles)
    visits.report()
    stops = with_depots(visits, stops, vehicles, plane)
    add_bounds(columns, vehicles)
    paid = plane is None and columns.find("per_hour") is not None
    clock = waits or have_times(stops, vehicles) or paid
    add_profiles(columns, vehicles, located=plane is None)
    _add_limits(columns, vehicles, clock=clock, located=plane is None)
    add_times(columns, vehicles, clock)
    _add_costs(columns, vehicles, located=plane is None)
    columns.report()
    tables = fleet_of_tables(source, stops, vehicles, plane, waits=waits)
    request: FleetRequest = {**tables, **groups}
    return reading_of_several("fleet", request, (source, other))


def _columns_of_vehicles(source: Source, table: Table, stops: list[Stop]) -> Columns:
    """Return the columns of vehicles. The contents of start and end decide: times, or stops."""
    of_stops = {"latitude", "x", "place", "demand"} & set(fields_of(table.heading or []))
    if table.heading is None or (of_stops and not is_about_vehicles(table.heading)):
        raise source.refusal("no-columns-of-vehicles")
    columns = columns_of_vehicles(source, table)
    ids = {stop["id"] for stop in stops}
    for end, bound in (("start", "shift_from"), ("end", "shift_to")):
        at = columns.find(end)
        if at is None or bound in columns.fields or columns.is_chosen(at):
            continue
        texts = {text for text in columns.table.texts(at) if text}
        if not texts & ids and all(map(is_time, texts)):
            columns.fields[at] = bound
    return columns


class _Vehicles:
    """Reads the rows of a table of vehicles; a place that is not a stop yet becomes one."""

    def __init__(self, columns: Columns, stops: list[Stop], *, located: bool) -> None:
        self._columns = columns
        self._source = columns.source
        self._stops = stops
        self._located = located
        self._ids = {stop["id"] for stop in stops}
        self._places: dict[tuple[float, ...], str] = {}
        self.names: dict[str, str] = {}  # of drivers and plates, with the vehicle of each

    def read(self) -> list[Vehicle]:
        """Return the vehicles with their ids, counts, places and shifts."""
        columns = self._columns
        rows = range(len(columns.table.rows))
        plate = self._id_beside_names() if columns.find("plate") is None else columns.find("plate")
        if plate is not None and "id" not in columns.fields:
            columns.fields[plate] = "id"
            plate = None
        if plate is not None:
            ids = self._with_plates(columns.ids(), plate)
        elif "id" in columns.fields:
            ids = columns.ids()
        else:
            ids = [f"vehicle {row + 1}" for row in rows]
            self._source.note("ids", "No column has names of vehicles: they are numbered from 1.")
        return [self._vehicle(row, id_) for row, id_ in zip(rows, ids, strict=True)]

    def _id_beside_names(self) -> int | None:
        """Take a column `id` beside one of drivers, which names the vehicles, for their plates."""
        columns = self._columns
        plain = [plain_name(name) for name in columns.names]
        if "id" not in columns.fields or "id" not in plain:
            return None
        at = plain.index("id")
        if columns.fields[at] is not None or columns.is_chosen(at):
            return None
        columns.fields[at] = "plate"
        return at

    def _with_plates(self, names: list[str], plate: int) -> list[str]:
        """Return ids of vehicles that say their names or drivers, and their plates."""
        plates = [" ".join(self._columns.text(row, plate).split()) for row in range(len(names))]
        pairs = list(zip(names, plates, strict=True))
        ids = [f"{name}, {each}" if each else name for name, each in pairs]
        for known in (plates, names):
            self.names |= dict(zip(known, ids, strict=True))
        return ids

    def _vehicle(self, row: int, id_: str) -> Vehicle:
        columns = self._columns
        vehicle: Vehicle = {"id": id_}
        if (at := columns.find("count")) is not None and columns.text(row, at):
            vehicle["count"] = columns.tried(1, columns.whole, row, at)
        for place, ends in _ENDS.items():
            if name := columns.tried(self._stops[0]["id"], self._place, row, place, id_):
                for end in ends:
                    vehicle[end] = name
        if (at := columns.find("reload")) is not None and columns.text(row, at):
            vehicle["reload"] = columns.tried(None, self._reload, row, at) or []
        add_shifts(vehicle, spans_in(columns, row, ["shift"]))
        return vehicle

    def _reload(self, row: int, at: int) -> list[str]:
        """Return the ids of the stops at which a vehicle may load again."""
        text = " ".join(self._columns.text(row, at).split())
        ids = [text] if text in self._ids else texts_in(self._columns, row, at)
        for each in ids:
            if each not in self._ids:
                raise self._columns.refuse(row, at, "no-such-stops", came=each)
        return ids

    def _place(self, row: int, place: str, vehicle: str) -> str:
        """Return the id of the stop where a vehicle starts or ends, given as an id or a place.

        "" if it is not given.
        """
        columns = self._columns
        at = columns.find(place)
        if at is not None and (text := " ".join(columns.text(row, at).split())):
            if text not in self._ids:
                raise columns.refuse(row, at, "no-such-stop", came=text)
            return text
        longitude, latitude = columns.find(f"{place}_longitude"), columns.find(f"{place}_latitude")
        if longitude is None or latitude is None:
            return ""
        if not columns.text(row, longitude) and not columns.text(row, latitude):
            return ""
        if not self._located:
            raise columns.refuse(row, latitude, "empty-in-planes")
        fields = (longitude, latitude)
        location = [columns.tried(0.0, columns.number, row, at) for at in fields]
        check_degrees(columns, row, fields, location)
        name = self._places.setdefault(tuple(location), f"{place} of {vehicle}")
        if name not in self._ids:
            self._ids.add(name)
            self._stops.append({"id": name, "location": location})
        return name


def _name_servers(stops: list[Stop], names: Mapping[str, str]) -> None:
    """Name the vehicle of each stop as the table of vehicles does, also if it has its driver."""
    for stop in stops:
        if "vehicle" in stop:
            name = str(stop["vehicle"])
            stop["vehicle"] = names.get(name, name)


def _add_limits(columns: Columns, vehicles: list[Vehicle], *, clock: bool, located: bool) -> None:
    """Add the limits on routes: on their time if there is a clock, and on their length.

    In a plane with times the length is a time.
    """
    if not clock:
        columns.leave_out("longest_time", " without times")
    elif not located:
        columns.leave_out("longest_distance", " with times in a plane")
    for row, limit in columns.values("longest_time", partial(seconds_in, columns), 0.0):
        vehicles[row]["longest"] = limit
    for row, limit in columns.values("longest_distance", partial(_metres, columns), 0.0):
        vehicles[row]["max_distance" if clock else "longest"] = limit


def _metres(columns: Columns, row: int, at: int) -> float:
    unit = _KILOMETRE if _IN_KILOMETRES.search(columns.names[at]) else 1.0
    return unit * columns.amount(row, at)


def _add_costs(columns: Columns, vehicles: list[Vehicle], *, located: bool) -> None:
    """Add what vehicles cost by the kilometre, if that differs, by the hour, and by the use."""
    rates = _rates(columns)
    if not located:
        columns.leave_out("per_hour", " in a plane")
    hourly = _hourly(columns)
    differ = len(set(rates)) > 1
    if located and (differ or hourly):
        for vehicle, rate in zip(vehicles, rates or [0.0] * len(vehicles), strict=True):
            vehicle["per_distance"] = rate / _KILOMETRE
        for vehicle, rate in zip(vehicles, hourly, strict=False):
            vehicle["per_time"] = rate / _HOUR
        return _add_fixed(columns, vehicles, 1.0, "added to the cost for each vehicle used")
    if differ or 0.0 in rates:
        columns.leave_out("per_km", ", which is 0 or differs by vehicle,")
        rates = []
    if not located:
        return _add_fixed(columns, vehicles, 1.0, "added to the length for each vehicle used")
    if rates:
        means = "converted to the metres that cost the same"
        return _add_fixed(columns, vehicles, rates[0] / _KILOMETRE, means)
    unit = "as metres: if it is money, name a cost per km as well"
    means = f"added to the distance for each vehicle used, {unit}"
    return _add_fixed(columns, vehicles, 1.0, means)


def _add_fixed(columns: Columns, vehicles: list[Vehicle], unit: float, means: str) -> None:
    """Add the cost of using a vehicle, in units of the first length, and note what it means."""
    if (at := columns.find("fixed")) is None:
        return
    columns.source.note("fixed", f"{quoted(columns.names[at])} is {means}.")
    for row, cost in columns.values("fixed", columns.amount, 0.0):
        vehicles[row]["fixed"] = cost / unit


def _hourly(columns: Columns) -> list[float]:
    """Return the cost of an hour of each vehicle; nothing without a column."""
    costs = dict(columns.values("per_hour", columns.amount, 0.0))
    rows = range(len(columns.table.rows) if "per_hour" in columns.fields else 0)
    return [costs.get(row, 0.0) for row in rows]


def _rates(columns: Columns) -> list[float]:
    """Return the cost per kilometre of each vehicle; nothing without a column."""
    at = columns.find("per_km")
    rows = range(0 if at is None else len(columns.table.rows))
    return [columns.tried(0.0, columns.amount, row, at) for row in rows]
