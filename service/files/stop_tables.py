"""Requests of tables: stops with places, two planes, or one objective of two."""

import re
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.files.columns import FLEET, fields_of, seconds_of
from service.files.fleets import measured, planar, timed, with_one_vehicle
from service.files.places import check_range, note_places, weighted
from service.files.reading import Column, Reading, Request, Source, quoted
from service.files.tables import Table, number_in

Array = NDArray[np.float64]
Stop = dict[str, Any]
_POINT = re.compile(
    r"(?:SRID=4326;)?\s*POINT\s*Z?M?\s*\(\s*(\S+)\s+(\S+?)[\s\d.e+-]*\)", re.IGNORECASE
)
_TIME = re.compile(r"(?:\d{4}-\d\d-\d\d[ T])?(\d{1,2}):(\d\d)(?::(\d\d)(?:\.0+)?)?", re.ASCII)
_BETWEEN = re.compile(r"\s*(?:-|–|—|\bto\b|\bbis\b|/)\s*", re.IGNORECASE)
_NO_WAY = {"", "-", "inf", "+inf", "infinity", "nan", "na", "n/a", "null", "none", "x", "∞"}
_MOST_DECIMALS = 3  # of demands, which become whole numbers


@dataclass(frozen=True)
class Part:
    """What one file says of the stops of two: ids, and costs, a plane, or places on the earth."""

    name: str
    count: int
    ids: list[str] | None = None
    costs: dict[str, Any] = field(default_factory=dict)  # a member of an objective
    stops: list[Stop] | None = None  # that have locations


@dataclass
class Columns:
    """The columns of a table by what they are taken for."""

    source: Source
    table: Table
    names: list[str]
    fields: list[str | None]

    def find(self, field: str) -> int | None:
        """Return the column that is taken for a field, if one is."""
        return self.fields.index(field) if field in self.fields else None

    def text(self, row: int, column: int) -> str:
        """Return a field."""
        return self.table.rows[row][1][column]

    def where(self, row: int, column: int) -> str:
        """Return where a field is, for sentences."""
        return f"row {self.table.rows[row][0]}, column {quoted(self.names[column])}"

    def number(self, row: int, column: int) -> float:
        """Return the number in a field.

        Raises:
            UnreadableFile: It is none.
        """
        text = self.text(row, column)
        number = number_in(text)
        if number is None:
            demand = f"{self.where(row, column)} must be a number"
            raise self.source.refusal(f"{demand}, got {quoted(text)}")
        return number

    def numbers(self, columns: list[int]) -> list[list[float]]:
        """Return the numbers of columns, row by row."""
        return [[self.number(row, at) for at in columns] for row in range(len(self.table.rows))]

    def are_numbers(self, column: int) -> bool:
        """Return whether all fields of a column are numbers."""
        return all(number_in(row[column]) is not None for _, row in self.table.rows)

    def tell(self) -> None:
        """Note what each column is taken for, where there is a heading."""
        if self.table.heading is None:
            return
        told = [
            Column(name[:200], each or "ignored")
            for name, each in zip(self.names, self.fields, strict=True)
        ]
        self.source.columns.extend(told)
        used = [
            f"{quoted(each.name)} ({each.taken_for})"
            for each in told
            if each.taken_for != "ignored"
        ]
        unused = [quoted(each.name) for each in told if each.taken_for == "ignored"]
        not_used = f" Not used: {', '.join(unused)}." if unused else ""
        self.source.note("columns", f"Columns were taken for: {', '.join(used)}.{not_used}"[:1000])


def columns_of(source: Source, table: Table) -> Columns:
    """Return what the columns of a table are taken for by its heading, or by what they hold."""
    names = table.heading or [f"{number}" for number in range(1, table.width + 1)]
    fields = fields_of(names) if table.heading else [None] * table.width
    columns = Columns(source, table, names, fields)
    for at in range(table.width):
        if fields[at] in (None, "place") and all(_POINT.match(row[at]) for _, row in table.rows):
            fields[at] = "place"
        elif fields[at] == "place":
            fields[at] = None
    if "id" not in fields and table.width > 1:
        unnamed = (
            table.heading is not None
            and fields[0] is None
            and names[0].casefold().strip() in ("", "unnamed: 0", "index")
        )
        words = (
            fields[0] is None
            and not columns.are_numbers(0)
            and (table.heading is None or table.width in (3, 5))
        )
        if unnamed or words:
            fields[0] = "id"
    return columns


def reading_of(source: Source, table: Table) -> Reading:
    """Return the request of a table that holds both objectives, or stops where they lie.

    Raises:
        UnreadableFile: A field is not what its column asks for, or columns are missing.
    """
    columns = columns_of(source, table)
    fields = columns.fields
    if "place" in fields or {"longitude", "latitude"} <= set(fields) or _degrees(columns):
        return _located(columns)
    fleet = [name for name, each in zip(columns.names, fields, strict=True) if each in FLEET]
    if fleet and {"x", "y"} <= set(fields):
        return _planar_fleet(columns)
    if fleet:
        raise source.refusal(
            f"has {', '.join(map(quoted, fleet))} and no places: it must have columns lon and lat, or x and y"
        )
    return _two_planes(columns)


def _degrees(columns: Columns) -> bool:
    """Return whether columns x and y alone are degrees, as QGIS writes them, and take them so."""
    x, y = columns.find("x"), columns.find("y")
    if x is None or y is None or any("x" in each or "y" in each for each in _others(columns)):
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


def _others(columns: Columns) -> list[str]:
    """Return the names of columns of numbers that are taken for nothing, in small letters."""
    pairs = enumerate(zip(columns.names, columns.fields, strict=True))
    return [
        name.casefold() for at, (name, each) in pairs if each is None and columns.are_numbers(at)
    ]


def _two_planes(columns: Columns) -> Reading:
    """Return the request of four columns of numbers, x and y in either plane."""
    source, table = columns.source, columns.table
    free = [at for at, each in enumerate(columns.fields) if each != "id"]
    if table.heading and len(free) > 4:
        free = [at for at in free if columns.are_numbers(at)]
    named = [columns.fields[at] for at in free]
    planes = len(free) == 4 and set(named) <= {None, "x", "y"}
    if planes and {"x", "y"} <= set(named):
        planes = all(re.match("[xy]|x?lon|y?lat", name) for name in _others(columns))
    if not planes:
        came = f"{len(free)} columns: {', '.join(quoted(columns.names[at]) for at in free[:8])}"
        raise source.refusal(
            f"must have 4 columns, x and y in either plane, or columns named lon and lat, got {came}"
            + (
                "; it is one plane: bring a second file"
                if {"x", "y"} <= set(named) or len(free) == 2
                else ""
            )
        )
    for at, name in zip(free, ("x", "y", "second x", "second y"), strict=True):
        columns.fields[at] = name
    rows = columns.numbers(free)
    ids = _ids(columns) if "id" in columns.fields else None
    columns.tell()
    if ids is None:
        return source.reading("front", {"coordinates": rows})
    planes_of = [[row[at : at + 2] for row in rows] for at in (0, 2)]
    return source.reading(
        "front", _named_planes(ids, [{"coordinates": each} for each in planes_of])
    )


def _named_planes(ids: list[str], costs: list[dict[str, Any]]) -> Request:
    names = ("first length", "second length")
    objectives = [{"name": name, **each} for name, each in zip(names, costs, strict=True)]
    return {"stops": [{"id": each} for each in ids], "objectives": objectives}


def _located(columns: Columns) -> Reading:
    """Return the request for stops on the earth, a fleet's where there are demands or windows."""
    source = columns.source
    stops = _stops(columns, _places(columns))
    note_places(source, stops)
    if any(each in FLEET for each in columns.fields):
        _visits(columns, stops)
        columns.tell()
        objectives = measured(source, stops, timed(stops))
        return source.reading("fleet", with_one_vehicle(source, stops, objectives))
    second = _second(columns, stops)
    columns.tell()
    distance = {"name": "distance", "from": "great_circle"}
    return source.reading("front", {"stops": stops, "objectives": [distance, second]})


def _planar_fleet(columns: Columns) -> Reading:
    source = columns.source
    xy = columns.numbers([columns.fields.index("x"), columns.fields.index("y")])
    stops = _stops(columns, None)
    _visits(columns, stops)
    columns.tell()
    source.note("objectives", "Distances in the plane of x and y are time as well.")
    return source.reading("fleet", with_one_vehicle(source, stops, planar({"coordinates": xy})))


def _places(columns: Columns) -> list[list[float]]:
    """Return the longitude and latitude of each row."""
    at = columns.find("place")
    if at is None:
        longitude, latitude = columns.fields.index("longitude"), columns.fields.index("latitude")
        places, column = columns.numbers([longitude, latitude]), latitude
    else:
        for name in ("longitude", "latitude"):
            if (other := columns.find(name)) is not None:
                columns.fields[other] = None
        found = [_POINT.match(row[at]) for _, row in columns.table.rows]
        pairs = [tuple(map(number_in, each.groups())) if each else () for each in found]
        places, column = [[x or 0.0 for x in pair] for pair in pairs], at
    for row, place in enumerate(places):
        check_range(columns.source, place, columns.where(row, column))
    return places


def _stops(columns: Columns, places: list[list[float]] | None) -> list[Stop]:
    if "id" in columns.fields:
        ids = _ids(columns)
    else:
        ids = [str(number) for number in range(1, len(columns.table.rows) + 1)]
        columns.source.note("ids", "No column has names of stops: they are numbered from 1.")
    columns.source.check_count("stops", columns.source.bounds.cities, len(ids))
    if places is None:
        return [{"id": each} for each in ids]
    return [{"id": each, "location": place} for each, place in zip(ids, places, strict=True)]


def _ids(columns: Columns) -> list[str]:
    """Return the id of each row.

    Raises:
        UnreadableFile: One is missing, or comes twice.
    """
    at = columns.fields.index("id")
    seen: dict[str, int] = {}
    for number, row in columns.table.rows:
        name = " ".join(row[at].split())
        where = f"row {number}, column {quoted(columns.names[at])}"
        if not name:
            raise columns.source.refusal(f"{where} must be an id, got none")
        if name in seen:
            demand = f"{where} must be an id of its own"
            raise columns.source.refusal(f"{demand}, got {quoted(name)} as row {seen[name]} has it")
        seen[name] = number
    return list(seen)


def _second(columns: Columns, stops: list[Stop]) -> dict[str, Any]:
    """Return the second objective: the plane of x and y, a cost of each metre, or time by road."""
    x, y, cost = (columns.find(name) for name in ("x", "y", "cost"))
    if x is not None and y is not None:
        return {"name": "second length", "coordinates": columns.numbers([x, y])}
    if cost is not None:
        source = columns.source
        source.check_count("stops with a cost", source.bounds.matrix_cities, len(stops))
        weights = np.array([each for (each,) in columns.numbers([cost])])
        if (weights < 0).any():
            row = int(np.argmax(weights < 0))
            raise source.refusal(f"{columns.where(row, cost)} must not be negative")
        name = quoted(columns.names[cost])
        source.note(
            "objectives", f"{name} is what a metre costs near a stop: the second objective."
        )
        places = np.array([stop["location"] for stop in stops])
        return {"name": columns.names[cost][:100], "matrix": weighted(places, weights)}
    columns.source.note("objectives", "The second objective is time by road, of a routing engine.")
    return {"name": "time", "from": "road_time"}


def _visits(columns: Columns, stops: list[Stop]) -> None:
    """Add what a vehicle's visit needs to stops: demand, window, service and prize."""
    demands = [at for at, each in enumerate(columns.fields) if each == "demand"]
    for at, each in enumerate(columns.fields):
        if each == "skills":
            columns.fields[at] = None
            name = quoted(columns.names[at])
            columns.source.note("left-out", f"{name} was not used: vehicles have no skills here.")
    for at, field_name in enumerate(columns.fields):
        for row, stop in enumerate(stops):
            text = columns.text(row, at)
            if text and field_name == "service":
                stop["service"] = _seconds(columns, row, at)
            elif text and field_name == "prize":
                stop["prize"] = columns.number(row, at)
    if demands:
        _add_demands(columns, demands, stops)
    for row, stop in enumerate(stops):
        if window := _window(columns, row):
            stop["window"] = window


def _add_demands(columns: Columns, demands: list[int], stops: list[Stop]) -> None:
    """Add demands as whole numbers, of fractions in smaller units."""
    rows = np.array(
        [
            [columns.number(row, at) if columns.text(row, at) else 0.0 for at in demands]
            for row in range(len(stops))
        ]
    )
    decimals = next(
        (
            k
            for k in range(_MOST_DECIMALS + 1)
            if (np.abs(rows * 10**k - np.rint(rows * 10**k)) < 1e-6).all()
        ),
        None,
    )
    wrong = (rows < 0).any(axis=1)
    if decimals is None or wrong.any():
        row = int(np.argmax(wrong))
        demand = f"must be 0 or more, with at most {_MOST_DECIMALS} decimals"
        raise columns.source.refusal(
            f"{columns.where(row, demands[0])} {demand}, got {rows[row].tolist()}"
        )
    if decimals:
        columns.source.note(
            "demand", f"Demands are whole numbers, so they are in 1/{10**decimals} here."
        )
    for stop, amounts in zip(stops, np.rint(rows * 10**decimals).astype(int).tolist(), strict=True):
        stop["demand"] = amounts


def _window(columns: Columns, row: int) -> list[float] | None:
    """Return when a visit may begin, in seconds; None where the fields are empty."""
    both = columns.find("window")
    if both is not None:
        text = columns.text(row, both)
        bounds = _BETWEEN.split(text.strip("[]() "))
        if text and len(bounds) != 2:
            demand = f"{columns.where(row, both)} must be two times, as 8:00-12:30"
            raise columns.source.refusal(f"{demand}, got {quoted(text)}")
        return [_seconds(columns, row, both, each) for each in bounds] if text else None
    ends = [columns.find("window_from"), columns.find("window_to")]
    texts = ["" if at is None else columns.text(row, at) for at in ends]
    if not any(texts):
        return None
    earliest, latest = ends
    if latest is None or not texts[1]:
        at = latest if latest is not None else earliest
        assert at is not None
        raise columns.source.refusal(
            f"{columns.where(row, at)} must say when the window ends, got none"
        )
    start = 0.0 if earliest is None or not texts[0] else _seconds(columns, row, earliest)
    return [start, _seconds(columns, row, latest)]


def _seconds(columns: Columns, row: int, at: int, text: str | None = None) -> float:
    """Return a time in seconds: hours and minutes, or a number in the unit of its heading."""
    text = columns.text(row, at) if text is None else text.strip()
    if time := _TIME.fullmatch(text):
        hours, minutes, seconds = (int(each or 0) for each in time.groups())
        return 3600 * hours + 60 * minutes + seconds
    number = number_in(text)
    if number is None or number < 0:
        demand = f"{columns.where(row, at)} must be seconds, or a time as 10:30"
        raise columns.source.refusal(f"{demand}, got {quoted(text)}")
    return number * (seconds_of(columns.names[at]) or 1)


def part_of(source: Source, table: Table) -> Part:
    """Return what one table of two says: stops, a plane, or costs from each row to each column.

    Raises:
        UnreadableFile: It is none of these.
    """
    columns = columns_of(source, table)
    name, count = source.name, len(table.rows)
    if "place" in columns.fields or {"longitude", "latitude"} <= set(columns.fields):
        stops = _stops(columns, _places(columns))
        note_places(source, stops)
        columns.tell()
        return Part(name, count, [stop["id"] for stop in stops], stops=stops)
    free = [at for at, each in enumerate(columns.fields) if each != "id"]
    if len(free) != count and table.width == count:  # a square whose first column looked like ids
        free = list(range(count))
        columns.fields[0] = None
    if len(free) not in (2, count):
        demand = "must have 2 columns, x and y, or as many as rows"
        raise source.refusal(f"{demand}, got {count} rows of {len(free)}")
    ids = _ids(columns) if "id" in columns.fields else None
    if len(free) == 2 != count:
        return Part(name, count, ids, {"coordinates": columns.numbers(free)})
    source.check_count("cities", source.bounds.matrix_cities, count)
    return Part(name, count, ids, {"matrix": _costs(columns, free)})


def _costs(columns: Columns, free: list[int]) -> list[list[float | None]]:
    """Return costs, None where a field says that there is no way."""
    costs: list[list[float | None]] = []
    for row, (_, texts) in enumerate(columns.table.rows):
        costs.append(
            [None if texts[at].casefold() in _NO_WAY else columns.number(row, at) for at in free]
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
    """Return the numbers of a table that holds nothing else, as costs of cells do."""
    columns = Columns(
        source, table, [f"{at}" for at in range(1, table.width + 1)], [None] * table.width
    )
    return columns.numbers(list(range(table.width)))
