"""The columns of a table, and the fields of stops or vehicles that they are taken for."""

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from service.files.reading import Column, Source, UnreadableFile, quoted
from service.files.tables import Table, number_in, plain_numbers

# By field, the names that people give it, the best names first; without accents, units and signs.
_NAMES = {
    "id": "id orderid stopid stringid orderno ordernumber ordernr order jobid nodeid customerid"
    " customerno custno deliveryid shipmentid bestellnummer auftragsnummer kundennummer auftrag"
    " stop ref reference code key name stopname customer kunde node city label site no nr number",
    "longitude": "longitude lon lng long longitud laengengrad langengrad laenge lange lond",
    "latitude": "latitude lat latitud breitengrad breite latd",
    "place": "wkt wktgeom geom geometry thegeom point location coordinates coords coordinate latlon"
    " latlng latlong position gps",
    "x": "x xcoord coordx xcoordinate xc xpos posx easting rechtswert ost",
    "y": "y ycoord coordy ycoordinate yc ypos posy northing hochwert nord",
    "demand": "demand qty quantity load amount pallets parcels boxes items weight volume menge"
    " bedarf gewicht demanda cantidad kg",
    "window_from": "windowfrom windowstart timewindowstart timewindowfrom timefrom starttime "
    " twstart twfrom twopen readytime ready earliest open opens opening from begin von start",
    "window_to": "windowto windowend timewindowend timewindowto timeto endtime twend twto twclose"
    " duedate duetime latest close closes closing to until end bis",
    "window": "window timewindow tw deliverywindow zeitfenster windows timewindows deliverywindows",
    "service": "service duration servicetime serviceduration stoptime handlingtime dwell"
    " servicezeit standzeit",
    "due": "due dueby deadline deliverydeadline deliverby deliverbefore frist",
    "release": "release releasetime releasedate availablefrom readyatdepot",
    "skills": "skills skill requires requiredskills requiredskill skillsrequired skillsneeded"
    " qualifications qualification",
    "vehicle": "vehicle vehicleid vehiclename van vanid driver driverid drivername truck truckid"
    " assignedto assignedvehicle assigneddriver assignedvan fahrzeug fahrer",
    "prize": "prize",
    "cost": "cost costs risk danger exposure co2 emissions noise kosten risiko laerm",
}
_OF_WINDOWS = ("window_from", "window_to", "window")
WINDOWS = ("window", "window_2", "window_3")  # the windows that a table may have
_AMOUNTS = _NAMES["demand"].split()
_OF_VEHICLES_ONLY = {
    "id": "vehicleid vehicle vehiclename vehicletype truckid truck driverid driver van fahrzeug"
    " fahrer",
    "capacity": "capacity vehiclecapacity maxcapacity payload kapazitaet kapazitat nutzlast "
    + " ".join(f"max{each} capacity{each} {each}capacity" for each in _AMOUNTS),
    "shift_from": "shiftstart shiftfrom shiftbegin workstart schichtbeginn",
    "shift_to": "shiftend shiftto workend schichtende",
    "shift": "shift workinghours workhours schicht arbeitszeit",
    "longest_time": "maxtime maxtraveltime maxdrivingtime maxduration maxrouteduration",
    "longest_distance": "maxdistance maxdistancekm maxkm range rangekm",
    "fixed": "fixed fixedcost fixedcosts costfixed fixkosten",
    "max_stops": "maxstops maxnumberofstops maxtasks maxorders maxjobs maxvisits maxdeliveries",
    "max_trips": "maxtrips maxnumberoftrips tripsperday maxtours",
    "reload": "reload reloadat reloadstop reloadstops reloaddepot reloaddepots reloadlocation",
    "max_overtime": "overtime maxovertime overtimelimit allowedovertime ueberstunden",
    "initial_load": "initialload startload loadatstart loadonboard onboard "
    + " ".join(f"initial{each}" for each in _AMOUNTS if each != "load"),
    "per_km": "costperkm costkm kmcost perkm priceperkm kmkosten",
}  # fields that only vehicles have
_NAMES_OF_VEHICLES = {
    "start": "start startid startstop startplace startlocation startdepot",
    "end": "end endid endstop endplace endlocation enddepot destination",
    "depot": "depot depotid home base",
    "start_latitude": "startlatitude startlat",
    "start_longitude": "startlongitude startlon startlng",
    "end_latitude": "endlatitude endlat",
    "end_longitude": "endlongitude endlon endlng",
    "depot_latitude": "depotlatitude depotlat homelatitude homelat latitude lat",
    "depot_longitude": "depotlongitude depotlon depotlng homelongitude homelon homelng longitude"
    " lon lng",
    **_OF_VEHICLES_ONLY,
    "id": f"{_OF_VEHICLES_ONLY['id']} id name type",
    "capacity": f"{_OF_VEHICLES_ONLY['capacity']} {_NAMES['demand']}",
    "shift_from": f"{_OF_VEHICLES_ONLY['shift_from']} {_NAMES['window_from']}",
    "shift_to": f"{_OF_VEHICLES_ONLY['shift_to']} {_NAMES['window_to']}",
    "shift": f"{_OF_VEHICLES_ONLY['shift']} {_NAMES['window']}",
    "count": "count vehicles available anzahl",
    "skills": "skills skill abilities capabilities qualifications qualification",
}
_PLACES = ("longitude", "latitude", "x", "y")
_BEFORE = re.compile(r"^(stop|geo|gps|location|customer|address|position|pos|point)(?=l)")
_AFTER = re.compile(r"(deg|degree|degrees|wgs84|dd|decimal)$")
_UNIT = re.compile(r"[\[(](.*?)[\])]")
_HOURS_OF = (["working"], ["work"])  # whose hours are times of day
_SECONDS = {"s": 1, "sec": 1, "min": 60, "mins": 60, "minutes": 60, "h": 3600, "hours": 3600}
# Fields that a table may have several times.
_SEVERAL = ("demand", "capacity", "initial_load", "cost")
_NAMED_WINDOW = re.compile(r"^(timewindow|deliverywindow|window|tw)(?!s?$)")
_DEGREES = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d{1,2})?)"
_POINT = re.compile(
    rf"(?:SRID=4326;)?\s*POINT\s*Z?M?\s*\(\s*{_DEGREES}\s+{_DEGREES}(?:\s+{_DEGREES}){{0,2}}\s*\)",
    re.ASCII | re.IGNORECASE,
)
# As web maps show a place: latitude first.
_PAIR = re.compile(rf"\(?\s*{_DEGREES}°?\s*,\s*{_DEGREES}°?\s*\)?", re.ASCII | re.IGNORECASE)
_INDEX = ("", "index", "unnamed: 0")


def _numbered(words: str, number: int) -> str:
    """Return names of columns with a number at the end, or after `window`."""
    known = words.split()
    within = {_NAMED_WINDOW.sub(rf"\g<1>{number}", word) for word in known}
    return " ".join([*(f"{word}{number}" for word in known), *sorted(within - {*known})])


def _names_of_stops() -> dict[str, str]:
    """Return the names of all fields of stops, with those of second and third windows."""
    several = {
        field.replace("window", window, 1): _numbered(_NAMES[field], number)
        for number, window in enumerate(WINDOWS, 1)
        for field in _OF_WINDOWS
    }
    first = {field: f"{_NAMES[field]} {several.pop(field)}" for field in _OF_WINDOWS}
    return {**_NAMES, **first, **several}


_NAMES_OF_STOPS = _names_of_stops()
FLEET = (
    *(field for field in _NAMES_OF_STOPS if field.startswith("window")),
    *("demand", "service", "due", "release", "skills", "vehicle", "prize"),
)


@dataclass
class Columns:
    """The columns of a table, with the field that each is taken for."""

    source: Source
    table: Table
    names: list[str]
    fields: list[str | None]

    def find(self, field: str) -> int | None:
        """Return the column that is taken for a field, or None."""
        return self.fields.index(field) if field in self.fields else None

    def text(self, row: int, column: int) -> str:
        """Return a field."""
        return self.table.rows[row][1][column]

    def where(self, row: int, column: int) -> str:
        """Return the position of a field, for sentences."""
        return f"row {self.table.rows[row][0]}, column {quoted(self.names[column])}"

    def refusal(self, row: int, column: int, demand: str, *came: object) -> UnreadableFile:
        """Return the exception that says what a field must be, and quotes what came instead."""
        return self.source.refusal(f"{self.where(row, column)} {demand}", *came)

    def leave_out(self, field: str, when: str = "") -> None:
        """Note that a column, if there is one for a field, is not used."""
        if (at := self.find(field)) is not None:
            self.fields[at] = None
            self.source.note_left_out(quoted(self.names[at]) + when)

    def filled(self, column: int) -> list[int]:
        """Return the rows in which a column has text."""
        return [row for row in range(len(self.table.rows)) if self.text(row, column)]

    def number(self, row: int, column: int) -> float:
        """Return the number in a field.

        Raises:
            UnreadableFile: The field is not a number.
        """
        text = self.text(row, column)
        number = number_in(text)
        if number is None:
            raise self.refusal(row, column, "must be a number", text)
        return number

    def amount(self, row: int, column: int) -> float:
        """Return the number in a field, which must not be negative."""
        number = self.number(row, column)
        if number < 0:
            raise self.refusal(row, column, f"must not be negative, got {number:g}")
        return number

    def whole(self, row: int, column: int) -> int:
        """Return the whole number from 1 in a field."""
        number = self.number(row, column)
        if number < 1 or not number.is_integer():
            demand = "must be a whole number from 1"
            raise self.refusal(row, column, demand, self.text(row, column))
        return int(number)

    def numbers(self, columns: list[int]) -> list[list[float]]:
        """Return the numbers of columns, row by row."""
        rows = enumerate(self.table.rows)
        return [
            plain_numbers([texts[at] for at in columns]) or [self.number(row, at) for at in columns]
            for row, (_, texts) in rows
        ]

    def are_numbers(self, column: int) -> bool:
        """Return whether all fields of a column are numbers."""
        return all(number_in(row[column]) is not None for _, row in self.table.rows)

    def report(self) -> None:
        """If there is a heading, note what each column is taken for."""
        if self.table.heading is None:
            return
        pairs = list(zip(self.names, self.fields, strict=True))
        self.source.columns.extend(Column(name[:200], each or "ignored") for name, each in pairs)
        used = [f"{quoted(name)} ({each})" for name, each in pairs if each is not None]
        unused = [quoted(name) for name, each in pairs if each is None]
        not_used = f" Not used: {', '.join(unused)}." if unused else ""
        self.source.note("columns", f"Columns were taken for: {', '.join(used)}.{not_used}"[:1000])


def columns_of(source: Source, table: Table) -> Columns:
    """Return the columns of a table, recognised by its heading or by their contents."""
    names = table.heading or [f"{number}" for number in range(1, table.width + 1)]
    fields: list[str | None] = fields_of(names) if table.heading else [None] * table.width
    columns = Columns(source, table, names, fields)
    for at in range(table.width):
        if fields[at] in (None, "place"):
            fields[at] = _place_column(columns, at)
    if "id" not in fields and fields[0] is None and table.width > 1:
        first = table.rows[0][1][0]
        # Without a heading, or if a square of costs has named rows, the first row decides.
        named = table.heading is None or len(table.rows) == table.width - 1
        if (named and number_in(first) is None) or _is_index(table):
            fields[0] = "id"
    return columns


def _place_column(columns: Columns, at: int) -> str | None:
    """Return `place` for a column of points in WKT, or of pairs under such a heading; else None."""
    texts = [row[at] for _, row in columns.table.rows]
    if all(map(_POINT.fullmatch, texts)):
        return "place"
    located = {"longitude", "latitude"} <= set(columns.fields)
    paired = columns.fields[at] == "place" and all("." in text for text in texts)
    if located or not paired or not all(map(_PAIR.fullmatch, texts)):
        return None
    name = quoted(columns.names[at])
    columns.source.note("place", f"{name} is taken to be latitude, then longitude.")
    return "place"


def place_in(text: str) -> list[float]:
    """Return the longitude and latitude in a point of WKT, or in a pair, latitude first."""
    if point := _POINT.fullmatch(text):
        return [float(each) for each in point.group(1, 2)]
    pair = _PAIR.fullmatch(text)
    assert pair is not None
    return [float(each) for each in pair.group(2, 1)]


def _is_index(table: Table) -> bool:
    """Return whether the first column is the index that pandas writes, or names of rows."""
    return table.heading is not None and table.heading[0].strip().casefold() in _INDEX


def ids_of(columns: Columns) -> list[str]:
    """Return the id of each row.

    Raises:
        UnreadableFile: An id is missing, or comes twice.
    """
    at = columns.fields.index("id")
    seen: dict[str, int] = {}
    for row, (number, texts) in enumerate(columns.table.rows):
        name = " ".join(texts[at].split())
        if not name:
            raise columns.refusal(row, at, "must be an id, got none")
        if name in seen:
            came = f"got {quoted(name)} as in row {seen[name]}"
            raise columns.refusal(row, at, f"must be an id that no other row has, {came}")
        seen[name] = number
    return list(seen)


def fields_of_vehicles(heading: Sequence[str]) -> list[str | None]:
    """Return the field of vehicles that each column may be.

    Only those of loads may come several times.

    Columns `start` and `end` may be times of a shift instead: their contents decide.
    """
    return _fields_of(heading, _NAMES_OF_VEHICLES)


def is_about_vehicles(heading: Sequence[str]) -> bool:
    """Return whether a heading has columns of vehicles alone, and none of stops alone."""
    stops, found = fields_of(heading), set(_fields_of(heading, _OF_VEHICLES_ONLY))
    located = {"latitude", "x", "place"} & set(stops)
    return bool(found - ({"id", None} if located else {None})) and "demand" not in stops


def amount_of(name: str) -> str:
    """Return the amount that a column of demands or capacities is about, as `weight`, or ""."""
    plain = plain_name(name)
    forms = ("{}", "max{}", "capacity{}", "{}capacity", "initial{}")
    return next((each for each in _AMOUNTS for form in forms if form.format(each) == plain), "")


def fields_of(heading: Sequence[str]) -> list[str | None]:
    """Return the field of stops that each column may be, or None; only some come several times.

    A column `due` beside the begin of a window is its end, if no other column is.
    """
    taken = _fields_of(heading, _NAMES_OF_STOPS)
    if "window_from" in taken and "window_to" not in taken:
        pairs = zip(heading, taken, strict=True)
        return ["window_to" if plain_name(name) == "due" else each for name, each in pairs]
    return taken


def _fields_of(heading: Sequence[str], names: Mapping[str, str]) -> list[str | None]:
    """Return the field that each column may be, or None.

    Of two columns for a field that comes once, the one whose name comes first in `names` gets it,
    and the other one gets None.
    """
    ranks = [_rank(plain_name(name), names) for name in heading]
    taken: list[str | None] = [None] * len(heading)
    for at in sorted(range(len(heading)), key=lambda at: (ranks[at][1], at)):
        field = ranks[at][0]
        if field in _SEVERAL or field not in taken:
            taken[at] = field
    return taken


def seconds_of(name: str) -> int | None:
    """Return the seconds of the unit in a heading, as in `service [min]`; None without a unit."""
    unit = _UNIT.search(name)
    plain = unit[1].strip().casefold() if unit else re.split(r"[\s_]", name.casefold())[-1]
    return _SECONDS.get(plain)


def _rank(plain: str, names: Mapping[str, str]) -> tuple[str | None, int]:
    for field, words in names.items():
        known = words.split()
        for name in (plain, _AFTER.sub("", _BEFORE.sub("", plain))):
            if name in known and (name == plain or field in _PLACES):
                return field, known.index(name)
    return None, 0


def plain_name(name: str) -> str:
    """Return a heading without its unit, reduced to small letters and digits."""
    decomposed = unicodedata.normalize("NFKD", _UNIT.sub("", name).casefold()[:200])
    words = re.sub(r"[^a-z0-9]+", " ", re.sub(r"[\u0300-\u036f]", "", decomposed)).split()
    of_a_day = words[-1:] == ["hours"] and words[:1] in _HOURS_OF
    kept = words[:-1] if len(words) > 1 and words[-1] in _SECONDS and not of_a_day else words
    return "".join(kept)
