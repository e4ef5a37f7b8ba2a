"""Make requests from tables: of stops with places, of two to four planes, or of one objective."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray
from paretour.member_parts import ObjectiveRequest

from service.files.cells.times import read_calendar
from service.files.column_names import FLEET, GROUPS, PLANES
from service.files.columns import Columns, columns_of, place_in
from service.files.depots import for_stops
from service.files.fleets import Stop, fleet_of_tables
from service.files.groups import groups_of, have_waits, without_groups
from service.files.places import note_places, out_of_range, weighted
from service.files.planes import (
    called_planes,
    count_rows,
    degrees_in,
    is_nameless,
    pasted_planes,
    question,
    recognise_pasted,
)
from service.files.reading import Reading, Source, quoted
from service.files.tables import Table, number_in, plain_numbers
from service.files.visits import add_visits
from service.objectives import MOST_OBJECTIVES, NTH, OBJECTIVES

Array = NDArray[np.float64]
_ON_EARTH = ("longitude", "latitude", "place")
_NO_WAY = {"", "-", "inf", "+inf", "infinity", "nan", "na", "n/a", "null", "none", "x", "∞"}
_FREE = {"0", "0.0", "0,0", *_NO_WAY}


@dataclass(frozen=True)
class FilePart:
    """The stops in one of several files: their ids, and costs, a plane, or places on the earth."""

    name: str
    count: int
    ids: list[str] | None = None
    matrix: list[list[Any]] | None = None
    coordinates: list[list[float]] | None = None
    stops: list[Stop] | None = None  # stops with locations
    plane: list[list[float]] | None = None  # points whose rounded distances are the costs


def reading_of(source: Source, table: Table) -> Reading:
    """Return the request of a table of planes, of stops with locations, or of a fleet.

    Raises:
        UnreadableFile: A field does not fit its column, or columns are missing.
    """
    return reading_of_columns(columns_of(source, table))


def reading_of_columns(columns: Columns) -> Reading:
    """Return the request of the columns of a table. See `reading_of`."""
    recognise_pasted(columns)
    if any(each in FLEET for each in columns.fields):
        return _fleet(columns)
    without_groups(columns)
    return _located(columns) if _is_located(columns) else _in_planes(columns)


def _is_located(columns: Columns) -> bool:
    """Return whether a table has places on the earth."""
    fields = set(columns.fields)
    return "place" in fields or {"longitude", "latitude"} <= fields or _degrees(columns)


def _degrees(columns: Columns) -> bool:
    """Return whether x and y are degrees, as QGIS writes them; if so, rename their fields."""
    x, y = columns.find("x"), columns.find("y")
    if x is None or y is None or columns.is_chosen(x) or columns.is_chosen(y):
        return False
    if len(called_planes(columns)) > 1:
        return False
    rows = [row for _, row in columns.table.rows]
    exact = all(re.search(r"[.,]\d{3}", row[at]) for row in rows for at in (x, y))
    numbers = [(number_in(row[x]), number_in(row[y])) for row in rows]
    if not exact or not all(
        a is not None and b is not None and abs(a) <= 180 and abs(b) <= 90 for a, b in numbers
    ):
        return False
    columns.fields[x], columns.fields[y] = "longitude", "latitude"
    columns.source.note("place", "x and y look like degrees: taken for longitude and latitude.")
    return True


def _in_planes(columns: Columns) -> Reading:
    """Return the request of columns that are called x and y of planes, or pasted as such."""
    source = columns.source
    free = [at for at, each in enumerate(columns.fields) if each != "id"]
    planes = called_planes(columns)
    if len(planes) < OBJECTIVES and is_nameless(columns):
        if len(free) > 2 and degrees_in(columns, free):
            raise question(columns, free)
        columns.read_signs(free)
        planes = pasted_planes(columns, free) or planes
    if not OBJECTIVES <= len(planes) <= MOST_OBJECTIVES:
        numeric = [at for at in free if columns.are_numbers(at)]
        is_plane = len(numeric) == 2 and (planes or is_nameless(columns))
        if len(numeric) > 1 and not is_plane:
            raise question(columns, numeric)
        raise source.refusal("no-places", given=_without_places(columns, free))
    columns.read_signs([at for plane in planes for at in plane])
    columns.leave_free([at for plane in planes for at in plane])
    for plane, names in zip(planes, zip(PLANES[::2], PLANES[1::2], strict=True), strict=False):
        columns.fields[plane[0]], columns.fields[plane[1]] = names
    found = [columns.numbers(list(plane)) for plane in planes]
    ids = columns.ids() if "id" in columns.fields else None
    columns.report()
    if ids is None:
        rows = [list(chain.from_iterable(each)) for each in zip(*found, strict=True)]
        return source.reading("front", {"coordinates": rows})
    objectives: list[ObjectiveRequest] = [
        {"name": f"{nth} length", "coordinates": plane}
        for nth, plane in zip(NTH, found, strict=False)
    ]
    stops: list[Stop] = [{"id": each} for each in ids]
    return source.reading("front", {"stops": stops, "objectives": objectives})


def _without_places(columns: Columns, free: list[int]) -> str:
    """Return what a table without places has, and what to do."""
    table, names = columns.table, columns.names[:8]
    words = not all(map(columns.are_numbers, free))
    first = (table.heading or table.rows[0][1])[0]
    if table.width == 1:
        came = f"a single column, which begins with {quoted(first)}"
    elif table.heading is None:
        came = f"{table.width} columns without names"
    else:
        came = f"columns named {', '.join(map(quoted, names))}"
    if table.width == 1 and (sign := re.search(r"[^\w\s.+-]", first)):
        came += f". If {sign[0]} separates its columns, write sep={sign[0]} as the first line"
    elif words or not free:
        came += ". Look up the places of names and addresses first (geocoding)"
    elif len(free) == 2:
        came += ". One plane needs a second file with the other one"
    return came


def _located(columns: Columns) -> Reading:
    """Return the request for stops on the earth."""
    source = columns.source
    stops = _stops(columns, _places(columns))
    note_places(source, stops)
    others = _other_objectives(columns, stops)
    columns.report()
    objectives: list[ObjectiveRequest] = [{"name": "distance", "from": "great_circle"}, *others]
    return source.reading("front", {"stops": stops, "objectives": objectives})


def _fleet(columns: Columns) -> Reading:
    """Return the request for a fleet whose vehicles have no table."""
    source = columns.source
    stops, plane = visits_of(columns)
    read_calendar([columns])
    add_visits(columns, stops)
    groups = groups_of(columns, stops)
    stops, vehicles = for_stops(columns, stops, plane)
    columns.report()
    request = fleet_of_tables(source, stops, vehicles, plane, waits=have_waits(groups))
    return source.reading("fleet", {**request, **groups})


def visits_of(columns: Columns) -> tuple[list[Stop], list[list[float]] | None]:
    """Return the stops of a fleet; and their points in the plane, if they are not on the earth.

    Raises:
        UnreadableFile: It has no places.
    """
    source, fields = columns.source, columns.fields
    if _is_located(columns):
        columns.keep((*_ON_EARTH, *FLEET, *GROUPS), "a fleet has no costs or planes of its own")
        stops = _stops(columns, _places(columns))
        note_places(source, stops)
        return stops, None
    if not {"x", "y"} <= set(fields):
        named = zip(columns.names, fields, strict=True)
        fleet = ", ".join(quoted(name) for name, each in named if each in FLEET)
        if fleet:
            raise source.refusal("no-places-beside", names=fleet)
        raise source.refusal("no-places-of-fleet")
    columns.keep(("x", "y", *FLEET, *GROUPS), "a fleet has no costs or other planes of its own")
    source.note("objectives", "Distances in the plane of x and y are time as well.")
    plane = columns.numbers([fields.index("x"), fields.index("y")])
    return _stops(columns, None), plane


def _places(columns: Columns) -> list[list[float]]:
    """Return the longitude and latitude of each row."""
    at = columns.find("place")
    if at is None:
        longitude, latitude = columns.fields.index("longitude"), columns.fields.index("latitude")
        places = columns.numbers([longitude, latitude])
    else:
        for name in ("longitude", "latitude"):
            if (other := columns.find(name)) is not None:
                columns.fields[other] = None
        places = [place_in(text) or [0.0, 0.0] for text in columns.table.texts(at)]
        longitude = latitude = at
    for row, place in enumerate(places):
        check_degrees(columns, row, (longitude, latitude), place)
    return places


def check_degrees(
    columns: Columns, row: int, fields: tuple[int, int], place: Sequence[float]
) -> None:
    """Keep the longitude and latitude of a row as wrong if they are out of range."""
    for axis, code, values in out_of_range(place):
        columns.refuse(row, fields[axis], code, **values)


def _stops(columns: Columns, places: list[list[float]] | None) -> list[Stop]:
    if "id" in columns.fields:
        ids = columns.ids()
    else:
        ids = [str(number) for number in range(1, len(columns.table.rows) + 1)]
        columns.source.note("ids", "No column has names of stops: they are numbered from 1.")
    columns.source.check_count("stops", columns.source.bounds.cities, len(ids))
    if places is None:
        return [{"id": each} for each in ids]
    return [{"id": each, "location": place} for each, place in zip(ids, places, strict=True)]


def _other_objectives(columns: Columns, stops: list[Stop]) -> list[ObjectiveRequest]:
    """Return the objectives after distance: a plane, costs per metre, or else time by road."""
    x, y = (columns.find(name) for name in ("x", "y"))
    if x is not None and y is not None:
        columns.keep((*_ON_EARTH, "x", "y"), "the other objective is the plane of x and y")
        return [{"name": "second length", "coordinates": columns.numbers([x, y])}]
    columns.keep((*_ON_EARTH, "cost"), "a plane needs x and y")
    costs = [at for at, each in enumerate(columns.fields) if each == "cost"]
    if not costs:
        sentence = "The second objective is time by road, of a routing engine."
        columns.source.note("objectives", sentence)
        return [{"name": "time", "from": "road_time"}]
    if len(costs) >= MOST_OBJECTIVES:
        came = ", ".join(quoted(columns.names[at]) for at in costs)
        raise columns.source.refusal("too-many-costs", most=MOST_OBJECTIVES - 1, given=came)
    return [_cost_per_metre(columns, at, stops) for at in costs]


def _cost_per_metre(columns: Columns, cost: int, stops: list[Stop]) -> ObjectiveRequest:
    """Return the objective of a column that says what a metre costs near each stop."""
    source = columns.source
    source.check_count("stops with a cost", source.bounds.matrix_cities, len(stops))
    weights = np.array([each for (each,) in columns.numbers([cost])])
    for row in np.flatnonzero(weights < 0).tolist():
        columns.refuse(row, cost, "below-0")
    name = quoted(columns.names[cost])
    source.note("objectives", f"{name} is what a metre costs near a stop: an objective.")
    places = np.array([stop["location"] for stop in stops])
    named = columns.names[cost][:90]  # with its unit within 100 characters
    unit = f"{named} \N{MULTIPLICATION SIGN} m"
    return {"name": named, "unit": unit, "matrix": weighted(places, weights)}


def part_of(source: Source, table: Table) -> FilePart:
    """Return the content of one of several tables: stops, a plane, or costs from rows to columns.

    Raises:
        UnreadableFile: The table is none of these.
    """
    columns = columns_of(source, table)
    name, count = source.name, len(table.rows)
    if "place" in columns.fields or {"longitude", "latitude"} <= set(columns.fields):
        columns.keep(_ON_EARTH, "beside a file of costs, stops have places alone")
        stops = _stops(columns, _places(columns))
        note_places(source, stops)
        columns.report()
        return FilePart(name, count, [stop["id"] for stop in stops], stops=stops)
    free = [at for at, each in enumerate(columns.fields) if each != "id"]
    if table.heading is None and len(free) == table.width and _is_numbered(columns):
        columns.fields[0] = "id"
        del free[0]
    if len(free) not in (2, count) and table.width == count and columns.are_numbers(0):
        free = list(range(count))
        columns.fields[0] = None
    if len(free) not in (2, count):
        rows = "1 row" if count == 1 else f"{count} rows"
        wide = "1 column" if len(free) == 1 else f"{len(free)} columns"
        raise source.refusal("no-costs", rows=rows, given=wide if free else "ids alone")
    columns.read_signs(free)
    ids = columns.ids() if "id" in columns.fields else None
    if len(free) == 2 != count:
        return FilePart(name, count, ids, coordinates=columns.numbers(free))
    source.check_count("cities", source.bounds.matrix_cities, count)
    return FilePart(name, count, ids, _costs(columns, free))


def _is_numbered(columns: Columns) -> bool:
    """Return whether the first column counts rows, before a plane or before costs.

    A square of numbers is one of costs, unless it costs something to stay.
    """
    table = columns.table
    count = len(table.rows)
    if not count_rows(columns, 0) or table.width not in (3, count + 1):
        return False
    return table.width != count or any(
        row[at] not in _FREE for at, (_, row) in enumerate(table.rows)
    )


def _costs(columns: Columns, free: list[int]) -> list[list[float | None]]:
    """Return costs; None for a field that forbids the leg."""
    costs: list[list[float | None]] = []
    for row, (_, texts) in enumerate(columns.table.rows):
        fields = [texts[at] for at in free]
        costs.append(
            [*(plain_numbers(fields) or ())]
            or [
                None
                if texts[at].casefold() in _NO_WAY
                else columns.tried(0.0, columns.number, row, at)
                for at in free
            ]
        )
    missing = sum(
        cost is None for row, each in enumerate(costs) for at, cost in enumerate(each) if at != row
    )
    if missing:
        columns.source.note(
            "no-way", f"{missing} fields without a number mean that there is no way."
        )
    return costs


def numbers_of(source: Source, table: Table) -> list[list[float]]:
    """Return the numbers of a table that holds only numbers, such as the costs of cells."""
    columns = Columns(
        source, table, [f"{at}" for at in range(1, table.width + 1)], [None] * table.width
    )
    columns.read_signs(range(table.width))
    return columns.numbers(list(range(table.width)))
