"""Find where vehicles start: the depot among the rows of orders, which is not visited.

A row is an order if it has a demand, a window, a service, a customer or the like, unless it is
called a depot. No order becomes a depot: it is visited, and a vehicle that starts there has a stop
of its own at that place.
"""

import re
from collections.abc import Mapping, Sequence
from typing import cast

from service.files.column_names import CUSTOMERS, NAMES_OF_STOPS, plain_name
from service.files.columns import Columns
from service.files.fleets import (
    ENDS,
    Stop,
    Vehicle,
    all_loads,
    distinct,
    in_shifts,
    listed,
    numbers,
    without,
)
from service.files.reading import quoted

_DEPOT = re.compile(  # anywhere in a name
    r"\b(?:depots?|dep[oó]sito|dépôt|warehouse|hub|headquarters|hq|distribution cent(?:re|er)"
    r"|zentrallager|lager|betriebshof|magazzino|almac[eé]n|entrep[oô]t|armaz[eé]m|magazijn|varasto"
    r"|terminaali)\b",
    re.IGNORECASE,
)
_HOME = re.compile(  # as the whole name
    r"(?:base|home|garage|yard|terminal|start|start point|starting point|origin|dc|office|zentrale)"
    r"[ #-]*\d*",
    re.IGNORECASE,
)
_SHOP = re.compile(r"home depot", re.IGNORECASE)
_NAMED = {*NAMES_OF_STOPS["id"].split(), "type", "stoptype", "kind", "description", "role"}
_TIMES = ("service", "window", "windows", "due", "release")
_OF_VISITS = ("service", "due", "release", "prize")
_OF_ORDERS = (*_TIMES, "demand", "pickup", "prize", "skills", "vehicle")


def depot_of(columns: Columns, stops: Sequence[Stop]) -> str | None:
    """Return the id of the stop from which vehicles start that are not told where; or None.

    It is the only row that is called a depot, or else the first one, unless that is an order.
    """
    rows = range(len(columns.table.rows))
    called = [row for row in rows if _is_called_depot(columns, row) and not _is_loaded(stops[row])]
    if len(called) != 1 and is_order(columns, stops, 0):
        return None
    return str(stops[called[0] if len(called) == 1 else 0]["id"])


def is_order(columns: Columns, stops: Sequence[Stop], row: int) -> bool:
    """Return whether a row is an order, and not a depot."""
    stop = stops[row]
    if _is_loaded(stop):
        return True
    if _is_called_depot(columns, row):
        return False
    if _has_customer(columns, row):
        return True
    return any(stop.get(name) for name in _OF_ORDERS) and not _is_horizon(stops, row)


def _is_loaded(stop: Stop) -> bool:
    return _has_load(stop) or any(stop.get(name) for name in ("skills", "vehicle"))


def _has_load(stop: Stop) -> bool:
    loads = (stop.get("demand", ()), stop.get("pickup", ()))
    return any(any(cast(Sequence[int], each)) for each in loads)


def _is_called_depot(columns: Columns, row: int) -> bool:
    """Return whether the name of a row, or what kind of stop it is, says that it is a depot."""
    cells = [
        (columns.names[at], text)
        for at, (text, field) in enumerate(
            zip(columns.table.rows[row][1], columns.fields, strict=True)
        )
        if field in ("id", None)
    ]
    cells += [(each.name, each.texts[row]) for each in columns.table.left_out.values()]
    texts = [text.replace("_", " ") for name, text in cells if plain_name(name) in _NAMED]
    if columns.table.heading is None and "id" in columns.fields:
        texts.append(columns.text(row, columns.fields.index("id")))
    customers = [text.strip() for name, text in cells if plain_name(name) in CUSTOMERS]
    return any(_DEPOT.fullmatch(text) for text in customers) or any(
        (_DEPOT.search(text) and not _SHOP.search(text)) or _HOME.fullmatch(text) for text in texts
    )


def _is_horizon(stops: Sequence[Stop], row: int) -> bool:
    """Return whether a row alone has no demand, and no visit: its window is that of the depot."""
    others = [stop for at, stop in enumerate(stops) if at != row]
    alone = bool(others) and all(map(_has_load, others))
    return alone and not any(stops[row].get(each) for each in _OF_VISITS)


def _has_customer(columns: Columns, row: int) -> bool:
    """Return whether a row has a text in a column of customers that is not planned."""
    return any(
        field is None and plain_name(name) in CUSTOMERS and columns.text(row, at)
        for at, (name, field) in enumerate(zip(columns.names, columns.fields, strict=True))
    )


def with_depots(
    columns: Columns,
    stops: Sequence[Stop],
    vehicles: Sequence[Vehicle],
    plane: list[list[float]] | None,
) -> list[Stop]:
    """Return stops; fill in places and shifts that vehicles do not name.

    The shift of a vehicle without one is the window of the depot where it starts.

    Args:
        columns: The table of the stops. The first stops are its rows.
        stops: All stops.
        plane: The points of the stops in the plane, if they are not on the earth. Those of stops
            that are added for vehicles are added here too.
    """
    rows = {stops[row]["id"]: row for row in range(len(columns.table.rows))}
    are_free = [not each.keys() & {"start", "end"} for each in vehicles]
    home = depot_of(columns, stops) if any(are_free) else None
    if any(are_free) and home is None:
        _note_anywhere(columns, stops[0])
    if home is not None and not _is_called_depot(columns, rows[home]):
        text = f"{quoted(home)} has nothing to deliver or visit, so vehicles start and end there."
        columns.source.note("depot", text)
    for vehicle, is_free in zip(vehicles, are_free, strict=True):
        if is_free and home is not None:
            vehicle["start"] = vehicle["end"] = home
    named = {stop for each in vehicles for stop in _depots_of(each)}
    orders = {each for each in named & rows.keys() if is_order(columns, stops, rows[each])}
    stops, moved = _with_stops_for(columns, stops, sorted(orders), plane)
    depots = {stop["id"]: stop for stop in stops if stop["id"] not in orders}
    used = {name for each in vehicles for name in _settle(each, depots, moved)}
    return _without_orders(columns, stops, named - orders, used)


def _depots_of(vehicle: Vehicle) -> list[str]:
    return [*(str(vehicle[end]) for end in ENDS if end in vehicle), *_reloads(vehicle)]


def _reloads(vehicle: Vehicle) -> Sequence[str]:
    return cast(Sequence[str], vehicle.get("reload", ()))


def _with_stops_for(
    columns: Columns, stops: Sequence[Stop], orders: Sequence[str], plane: list[list[float]] | None
) -> tuple[list[Stop], dict[str, str]]:
    """Return stops with one more for each order at which vehicles start, end or load again."""
    ids = {stop["id"] for stop in stops}
    added: list[Stop] = []
    moved = {}
    for order in orders:
        at = next(at for at, stop in enumerate(stops) if stop["id"] == order)
        name = next(each for each in _free_names(order) if each not in ids)
        stop: Stop = {"id": name}
        if "location" in stops[at]:
            stop["location"] = stops[at]["location"]
        added.append(stop)
        if plane is not None:
            plane.append(plane[at])
        moved[order] = name
    if moved:
        text = f"Vehicles start, end or load at {listed([*moved])}, which are orders as well: "
        text += f"{listed([*moved.values()])} was added at the same place."
        columns.source.note("depot", text)
    return [*stops, *added], moved


def _free_names(name: str) -> list[str]:
    return [f"{name} (depot)", *(f"{name} (depot {number})" for number in range(2, 100))]


def _settle(vehicle: Vehicle, depots: Mapping[str, Stop], moved: Mapping[str, str]) -> list[str]:
    """Give a vehicle the windows of its depot as shifts, and the stops that were added for it.

    Returns:
        Its start, if anything has changed.
    """
    before = vehicle.copy()
    start = str(vehicle.get("start", ""))
    depot: Stop = {"id": ""} if in_shifts([vehicle]) else depots.get(start, {"id": ""})
    if "window" in depot:
        vehicle["shift"] = depot["window"]
    if "windows" in depot:
        vehicle["shifts"] = depot["windows"]
    for end in ENDS:
        if end in vehicle:
            vehicle[end] = moved.get(str(vehicle[end]), vehicle[end])
    if "reload" in vehicle:
        vehicle["reload"] = [moved.get(each, each) for each in _reloads(vehicle)]
    return [str(vehicle.get("start"))] if vehicle != before else []


def _without_orders(
    columns: Columns, stops: Sequence[Stop], depots: set[str], used: set[str]
) -> list[Stop]:
    """Return stops, whose depots have nothing that orders have; note what is lost but windows.

    `used` are the depots whose windows have become shifts.
    """
    kept = []
    for stop in stops:
        if stop["id"] not in depots:
            kept.append(stop)
            continue
        kept.append(without(stop, _OF_ORDERS))
        lost = [name for name in _OF_ORDERS if stop.get(name) and name not in ("demand", "pickup")]
        if lost := [name for name in lost if name[:6] != "window" or stop["id"] not in used]:
            text = f"{quoted(stop['id'])} is a depot, so its {' and '.join(lost)} was not used."
            columns.source.note("depot", text)
    return kept


def _note_anywhere(columns: Columns, first: Stop) -> None:
    """Note that no row is a depot, so that vehicles start and end at any stop."""
    columns.source.note(
        "no-depot",
        f"No row is called a depot, and the first one, {quoted(first['id'])}, is an order: vehicles"
        " start and end at any stop. Where do they start? Add a row named depot, or a column start"
        " to a table of vehicles.",
    )


def for_stops(
    columns: Columns, stops: list[Stop], plane: list[list[float]] | None
) -> tuple[list[Stop], list[Vehicle]]:
    """Return stops, and the vehicles that they name, or one if they name none.

    Each vehicle starts at the depot, holds all demand and has all skills.
    """
    demands = all_loads(stops)
    named = distinct(str(stop["vehicle"]) for stop in stops if "vehicle" in stop)
    skills = distinct(skill for stop in stops for skill in stop.get("skills", ()))
    vehicles: list[Vehicle] = [{"id": name} for name in named or ["vehicle"]]
    for vehicle in vehicles:
        if demands:
            vehicle["capacity"] = demands
        if skills:
            vehicle["skills"] = skills
    stops = with_depots(columns, stops, vehicles, plane)
    home = vehicles[0].get("start")
    where = "from any stop to any"
    if home is not None:
        first = "the first stop, " if home == stops[0]["id"] else ""
        where = f"from and to {first}{quoted(home)}"
    holds = f", and holds all demand, {numbers(demands)}" if demands else ""
    able = f", and has all skills, {listed(skills)}" if skills else ""
    added = "The file names no vehicles, so one was added. It"
    if named:
        added = f"One vehicle was added for each that stops name, {listed(named)}. Each"
    columns.source.note("vehicle", f"{added} drives {where}{holds}{able}.")
    return stops, vehicles
