"""The folder of examples: files as people have them, and what each must become."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from pydantic_core import to_json

from service.errors import Refusal
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.helpers.actors import info_of
from tests.helpers.sampled import IS_WHOLE
from tests.helpers.serving import LIMITS

ACTORS = {
    "pa-one": info_of("pa-one", "coordinates"),
    "pa-one-matrix": info_of("pa-one-matrix", "matrices"),
}
FOLDER = Path(__file__).parent / "examples"
BINARY = (".xlsx", ".XLSX", ".pgm")
HELSINKI = [[24.94, 60.17], [24.95, 60.18]]


@dataclass(frozen=True)
class Becomes:
    """What files must become: ids with spaces between, other members, and codes of notes."""

    kind: str
    ids: str = ""
    places: list[list[float]] | None = None
    members: dict[str, Any] = field(default_factory=dict)
    notes: str = ""


def ids(names: str, places: Any = HELSINKI, notes: str = "", **members: Any) -> Becomes:
    return Becomes("front", names, places, members, notes)


def fleet(names: str, notes: str = "", **members: Any) -> Becomes:
    return Becomes("fleet", names, None, members, notes)


def rows(*coordinates: list[float], notes: str = "") -> Becomes:
    return Becomes("front", members={"coordinates": list(coordinates)}, notes=notes)


def van(**members: Any) -> list[dict[str, Any]]:
    return [{"id": "vehicle", "start": "depot", "end": "depot", **members}]


def named(*matrices: list[list[Any]]) -> Becomes:
    return Becomes("front", members={"matrices": list(matrices)})


VAN_1 = {"id": "van 1", "start": "depot", "end": "depot"}
VAN_2, BIKE = VAN_1 | {"id": "van 2"}, VAN_1 | {"id": "bike"}
PLAIN = [[0, 1, 2], [1, 0, 3], [2, 3, 0]]
EARTH = {
    "orders-with-hashes.csv": ids("#1001 #1002 #1003 #1004 #1005 #1006", None),
    "excel-german.CSV": ids(
        "München Köln", [[11.575, 48.137], [6.96, 50.938]], "encoding separator empty-rows"
    ),
    "excel-sep-line.csv": ids("depot shop", notes="separator"),
    "utf16-from-excel.txt": ids("zażółć b", notes="separator"),
    "utf8-bom.csv": ids("a b"),
    "bars.csv": ids("a b", notes="separator"),
    "carets.csv": ids("a b", notes="separator"),
    "tildes.csv": ids("a b", notes="separator"),
    "title.csv": ids("a b", notes="separator title"),
    "two-titles.csv": ids("a b", notes="title"),
    "pandas-unnamed.csv": ids("0 1"),
    "quoted-line-breaks.csv": ids('Main_Street_5_back_door Say_"hello"'),
    "units-in-headings.csv": ids("a b"),
    "gtfs-stops.txt": ids("S1 S2"),
    "upper-case-xy.csv": ids("1 2", [[24.9384, 60.1699], [24.9521, 60.1721]], "place"),
    "wkt-from-qgis.csv": ids("a b"),
    "phone-is-not-a-cost.csv": ids("a b"),
    "pairs.csv": ids("a b", notes="place"),
    "semicolon-in-one-row.csv": ids("a b"),
    "risk.csv": ids("a b c", None, "objectives"),
    "second-plane.csv": ids("depot shop"),
    "zero-zero.csv": ids("a b c", None, "place"),
    "groups-of-customers.csv": ids("a b c", None),
    "one-swapped.csv": ids("a b c", None, "swapped"),
    "far.csv": ids("a b c", None, "far"),
    "qgis.geojson": ids("depot shop"),
    "geojson-io.geojson": ids("0 2", notes="ids"),
    "records.json": ids("a b"),
    "handheld.gpx": ids("depot shop", notes="left-out"),
}
OTHERS = {
    "thousands.csv": rows([1234.5, 2, 3, 4], notes="separator thousands"),
    "pandas-heading.csv": rows([0.5, 1, 2, 3], [4, 5, 6, 7], [8, 9, 10, 11], notes="heading"),
    "no-heading.csv": rows([1, 2, 3, 4], [5, 6, 7, 8], notes="planes"),
    "white-space.txt": rows([1, 2, 3, 4], [5, 6, 7, 8]),
    "rows.json": rows([1, 2, 3, 4], [5, 6, 7, 8]),
    "bom.json": rows([1, 2, 3, 4]),
    "numbers.XLSX": rows([1, 2, 3, 4], [5, 6.5, 7, 8]),
    "pandas-index.csv": ids("0 1", None),
    "no-heading-ids.csv": ids("depot b", None),
    "demand.csv": fleet("depot a b", "vehicle", vehicles=van(capacity=[7]), clock="time"),
    "windows-as-times.csv": fleet("depot a b", vehicles=van(shift=[28800, 64800])),
    "windows-as-seconds.csv": fleet("depot a", vehicles=van()),
    "window-in-one-column.csv": fleet("depot a", vehicles=van()),
    "service-in-minutes.csv": fleet("depot a", clock="time"),
    "demand-with-decimals.csv": fleet("depot a b", "demand", vehicles=van(capacity=[35])),
    "two-demands.csv": fleet("depot a b", vehicles=van(capacity=[3, 12])),
    "rfc3339.csv": fleet("job1 job2", "dates", vehicles=[{"id": "vehicle", "capacity": [3]}]),
    "skills.csv": fleet("depot a", "vehicle", vehicles=van(capacity=[2], skills=["fridge"])),
    "groups.csv": fleet(
        "depot oven hob hood bottles paint",
        "groups",
        together=[["oven", "hob", "hood"]],
        apart=[{"stops": ["hob", "bottles"]}],
        before=[{"first": ["oven"], "then": ["hob", "hood"]}],
    ),
    "groups-by-id.csv": fleet(
        "D A1 A2 B",
        together=[["A1", "A2"]],
        apart=[{"stops": ["B"], "others": ["A1", "A2"]}],
        before=[{"first": ["A1"], "then": ["B"]}],
    ),
    "waits-for.csv": fleet(
        "D A1 A2 B",
        before=[{"first": ["A1", "A2"], "then": ["B"], "vehicles": "any"}],
        clock="time",
    ),
    "assigned.csv": fleet(
        "home boiler_1 boiler_2 roof",
        "vehicle",
        vehicles=[
            {"id": name, "skills": ["gas", "heights"], "start": "home", "end": "home"}
            for name in ("Anna", "Bob")
        ],
    ),
    "ready-and-due.csv": fleet(
        "0 1 2",
        vehicles=[
            {"id": "vehicle", "capacity": [3], "start": "0", "end": "0", "shift": [0, 100]},
        ],
        clock="longest route",
    ),
    "due-in-a-plane.csv": fleet(
        "0 1 2",
        "objectives",
        clock={"name": "time", "coordinates": [[0, 0], [3, 4], [6, 8]]},
    ),
    "several-windows.json": fleet("depot a b", vehicles=van(skills=["fridge", "crane"])),
    "orders-of-two-days.csv vans-of-two-shifts.csv": fleet(
        "depot #2001 #2002 #2003 #2004 #2005",
        "objectives",
        clock={"name": "time", "from": "great_circle", "speed": 30},
    ),
    "plane-with-demand.csv": fleet("depot a b", "objectives", vehicles=van(capacity=[3])),
    "first-stop-has-demand.csv": fleet("a b", vehicles=[{"id": "vehicle", "capacity": [5]}]),
    "ogr2ogr-3d.GEOJSON": fleet("7 8", vehicles=[{"id": "vehicle", "capacity": [7]}]),
    "map-of-mine.kml": fleet("depot shop_&_bar", "left-out", vehicles=van(capacity=[3])),
    "nested-records.json": fleet("a b", vehicles=[{"id": "vehicle", "capacity": [3]}]),
    "orders.xlsx": fleet("depot #1001", "sheet", vehicles=van(shift=[28800, 64800], capacity=[2])),
    "vroom.json": fleet(
        "depot_1 14 pickup_4 delivery_5",
        shipments=[{"pickup": "pickup 4", "delivery": "delivery 5"}],
    ),
    "vroom-matrix.json": fleet(
        "depot_1 depot_2 1414 1515",
        vehicles=[{"id": "0", "start": "depot 1", "end": "depot 2"}],
    ),
    "vroom-between-towns.json": fleet(
        "depot_1 1 2 5 6 pickup_4 delivery_3", "objectives", clock="time"
    ),
    "vroom-skills.json": fleet("depot_1 1 2 3", "left-out ids", clock="time"),
    "vroom-shipments.json": fleet(
        "depot_1 pickup_1000 delivery_1",
        "left-out",
        vehicles=[
            {
                **{"id": "1", "start": "depot 1", "end": "depot 1", "skills": ["3"]},
                **{"capacity": [5500, 35], "shift": [28800, 86340]},
            },
        ],
    ),
    "cvrp.vrp": fleet(
        "1 2 3 4",
        "vehicle",
        vehicles=[{"id": "vehicle", "count": 3, "start": "1", "end": "1", "capacity": [5]}],
    ),
    "solomon.txt": fleet("0 1 2", "objectives", clock="longest route"),
    "li-lim.txt": fleet("0 1 2", shipments=[{"pickup": "1", "delivery": "2"}]),
    "fleet-stops.csv fleet-vehicles.csv": fleet(
        "depot a b c",
        "separator fixed demand columns",
        vehicles=[
            {**VAN_1, "shift": [28800, 57600], "capacity": [3005, 40], "fixed": 100_000},
            # Its shift is the depot's window.
            {**VAN_2, "shift": [21600, 72000], "capacity": [2500, 30], "fixed": 80_000},
        ],
        clock="time",
    ),
    "fleet-vehicles.csv fleet-stops.csv": fleet("depot a b c", clock="time"),
    "demand.csv fleet-places.csv": fleet(
        "depot a b",
        vehicles=[
            {**BIKE, "count": 2, "shift": [27000, 43200], "capacity": [10]},
            {**BIKE, "id": "van", "count": 1, "capacity": [100]},
        ],
    ),
    "orders.xlsx fleet-places.csv": fleet(
        "depot #1001",
        "sheet",
        vehicles=[
            {**BIKE, "count": 2, "shift": [27000, 43200], "capacity": [10]},
            {**BIKE, "id": "van", "count": 1, "capacity": [100], "shift": [28800, 64800]},
        ],
    ),
    "bars.csv fleet-homes.csv": fleet(
        "a b start_of_Kim",
        "separator",
        vehicles=[
            {"id": "Kim", "start": "start of Kim", "end": "b", "longest": 40_000},
            {"id": "Lee", "start": "a", "end": "a"},
        ],
    ),
    "fleet-plane.csv fleet-trucks.csv": fleet(
        "0 1 2",
        "objectives",
        vehicles=[
            {"id": "small", "count": 3, "capacity": [4], "start": "0", "end": "0"},
            {"id": "big", "count": 1, "capacity": [9], "start": "0", "end": "0", "longest": 25},
        ],
    ),
    "two-demands.csv fleet-shifts.csv": fleet(
        "depot a b",
        "vehicle",
        vehicles=[
            {
                **BIKE,
                "id": "vehicle 1",
                "shift": [28800, 57600],
                "longest": 28800,
                "fixed": 5,
                "capacity": [3, 12],
                "skills": ["cold"],
            },
        ],
    ),
    "occupancy-grid.json": Becomes("coverage"),
    "map.pgm": Becomes("coverage", members={"grid": [[0, 0, 1]]}, notes="cell-size"),
    "map.yaml map.pgm": Becomes(
        "coverage", members={"grid": [[0, 1, 1]], "cell_size": 0.05, "origin": [-1, -2, 0]}
    ),
    "map.yaml map.pgm people-on-map.csv": Becomes(
        "coverage",
        members={
            "grid": [[0, 1, 1]],
            "cost_layers": [{"name": "people-on-map", "layer": [[0.5, 2, 1]]}],
        },
    ),
    "german-costs-of-map.csv map.pgm": Becomes(
        "coverage",
        members={"cost_layers": [{"name": "german-costs-of-map", "layer": [[0.5, 2, 1]]}]},
        notes="cell-size separator",
    ),
    "matrix-plain.csv matrix-plain.csv": named(PLAIN, PLAIN),
    "matrix-no-way.csv matrix-plain.csv": named([[0, 1, None], [3, 0, 7], [5, None, 0]], PLAIN),
    "matrix-names.csv matrix-plain.csv": ids("A B C", None),
    "plane-a.csv matrix-plain.csv": ids("a b c", None),
    "comments-behind.tsp comments-behind.tsp": named(*[[[0, 5, 8], [5, 0, 5], [8, 5, 0]]] * 2),
    "upper-row.tsp lower-diag-row.tsp": named(*[[[0, 5, 6], [5, 0, 7], [6, 7, 0]]] * 2),
    "asymmetric.atsp att.TSP": named(
        [[9999, 1, 2], [3, 9999, 4], [5, 6, 9999]], [[0, 4, 4], [4, 0, 1], [4, 1, 0]]
    ),
    # The first distances of ulysses16, whose places these are.
    "geo.tsp asymmetric.atsp": named(
        [[0, 509, 501], [509, 0, 126], [501, 126, 0]], [[9999, 1, 2], [3, 9999, 4], [5, 6, 9999]]
    ),
    "fixed-edges.tsp upper-row.tsp": Becomes("front", notes="left-out rounded"),
}
REFUSED = {
    "swapped-out-of-range.csv": "row 2, column 'lat' must have a latitude of -90 to 90, got 139.7",
    "metres.csv": "degrees (WGS84, EPSG:4326)",
    "lat-is-text.csv": "row 3, column 'lat' must be a number, got 'north'",
    "lat-is-empty.csv": "row 3, column 'lat' must be a number, got ''",
    "same-id-twice.csv": "row 3, column 'id' must be an id that no other row has, got 'a'",
    "open-quote.csv": "must be CSV",
    "ragged.csv": "row 2 must have 4 fields, as the first row, got 3",
    "nothing.csv": "must have a row for each stop, got none",
    "demand-without-place.csv": "must have places, in columns lon and lat or x and y",
    "one-plane.csv": "needs a second file",
    "addresses.csv": "got a single column, which begins with 'address'. Look up the places",
    "addresses-plain.txt": "got a single column, which begins with 'address'. Look up the places",
    "single-column.csv": "columns named lat and lon, or in 4, 6 or 8 columns of numbers named x1",
    "single-numbers.csv": "of each plane; got a single column, which begins with '1'",
    "colons.csv": "If : separates its columns, write sep=: as the first line",
    "names-alone.csv": "got columns named 'id', 'name'. Look up the places",
    "single-numbers.csv one-plane.csv": "or 2 columns of numbers, x and y, or as many columns",
    "picture.pdf": "got a PDF",
    "old.xls": "save it as .xlsx or CSV",
    "utm.geojson": "export it in EPSG:4326",
    "line.geojson": "features/0 must be a Point, got 'LineString'",
    "cut-off.json": "must be JSON",
    "infinity.json": "Infinity is not JSON: write null where there is no way",
    "vroom-shipment-windows.json": "shipments/0/pickup/time_windows must be one window",
    "order.sop": "an order of cities",
    "att.TSP": "one objective: name another",
    "map.yaml": "open both together",
    "costs-of-another-map.csv map.yaml map.pgm": "1 x 3 costs, one for each cell of the map, got 2",
    "utf8-bom.csv map.yaml map.pgm": "utf8-bom.csv",
    "fleet-elsewhere.csv demand.csv": "column 'start' must be the id of a stop, got 'nowhere'",
    "fleet-vehicles.csv demand.csv": "a column of capacity for each demand of demand.csv, 1, got 2",
    "fleet-half.csv demand.csv": "row 2, column 'count' must be a whole number from 1, got '1.5'",
    "fleet-late.csv demand.csv": "row 2, column 'shift end' must say when the shift ends, got",
    "fleet-homes.csv fleet-plane.csv": "column 'start lat' must be empty, as stops have x and y",
}


def read(names: str, bounds: Bounds = Bounds()) -> Reading:  # noqa: B008  it is frozen
    files = [NamedFile(name, (FOLDER / name).read_bytes()) for name in names.split()]
    return read_files(files, bounds, wanted=None)


@pytest.mark.parametrize(("names", "expected"), [*EARTH.items(), *OTHERS.items()])
def test_every_example_becomes_what_it_must(names: str, expected: Becomes) -> None:
    reading = read(names)
    request = reading.request
    stops = request.get("stops", [])
    assert reading.kind == expected.kind
    assert [stop["id"].replace(" ", "_") for stop in stops] == expected.ids.split()
    if expected.places:
        assert [stop["location"] for stop in stops] == expected.places
    assert {name: request[name] for name in expected.members} == expected.members
    assert set(expected.notes.split()) <= {note.code for note in reading.notes}


@pytest.mark.parametrize("names", sorted({*EARTH, *OTHERS}))
def test_what_an_example_becomes_is_a_request_that_the_service_takes(names: str) -> None:
    reading = read(names)
    if reading.kind == "coverage":
        return  # which lacks a spacing and a second objective
    body = to_json(reading.request)
    if "by road" in "".join(note.text for note in reading.notes):
        with pytest.raises(Refusal, match="needs a routing engine"):
            parse_task(TaskSource(reading.kind, body), LIMITS, ACTORS)
    else:
        parse_task(TaskSource(reading.kind, body), LIMITS, ACTORS)


@pytest.mark.parametrize(
    ("names", "end"),
    [
        (names, end)
        for at, names in enumerate(sorted({*EARTH, *OTHERS}))
        for which, end in enumerate((b"\r\n", b"\r"))
        if IS_WHOLE or at % 2 == which  # by day in turn
    ],
)
def test_lines_may_end_as_in_windows_or_on_an_old_mac(names: str, end: bytes) -> None:
    files = [NamedFile(name, (FOLDER / name).read_bytes()) for name in names.split()]
    if any(b"\0" in each.data or each.name.endswith(BINARY) for each in files):
        return  # not text of one byte a character
    unix = [each.data.replace(b"\r\n", b"\n") for each in files]
    ended = [NamedFile(f.name, d.replace(b"\n", end)) for f, d in zip(files, unix, strict=True)]
    assert read_files(ended, Bounds(), wanted=None) == read(names)


@pytest.mark.parametrize(("name", "sentence"), REFUSED.items())
def test_what_is_no_request_is_refused_by_name(name: str, sentence: str) -> None:
    with pytest.raises(UnreadableFile) as refused:
        read(name)
    assert str(refused.value).startswith(f"{name.split()[0]}: ")
    assert sentence in str(refused.value)


def test_every_example_is_in_the_table() -> None:
    known = {name for names in [*EARTH, *OTHERS, *REFUSED] for name in names.split()}
    assert known == {path.name for path in FOLDER.iterdir()}
    assert len(known) >= 60


def test_visits_of_a_table_are_those_of_its_columns() -> None:
    [depot, visit, other] = read("windows-as-times.csv").request["stops"]
    assert depot.keys() == {"id", "location"}
    assert visit["window"] == [34200, 37830]
    assert "window" not in other
    [_, timed] = read("window-in-one-column.csv").request["stops"]
    assert timed["window"] == [28800, 45000]
    [_, slow] = read("service-in-minutes.csv").request["stops"]
    assert slow["service"] == 300
    [_, loaded, _] = read("demand-with-decimals.csv").request["stops"]
    assert loaded["demand"] == [25]


def test_a_column_is_ignored_or_a_cost_by_its_heading_alone() -> None:
    ignored = read("phone-is-not-a-cost.csv")
    assert ignored.columns[-1].taken_for == "detail"
    assert ignored.request["objectives"][1]["from"] == "road_time"
    risk = read("risk.csv").request["objectives"][1]
    assert (risk["name"], risk["unit"]) == ("risk", "risk \N{MULTIPLICATION SIGN} m")
    assert risk["matrix"][0][1] == pytest.approx(3 * 111195.08, rel=1e-6)


TIMED = [
    "windows-as-times.csv",
    "service-in-minutes.csv",
    "fleet-stops.csv fleet-vehicles.csv",
    "vroom.json",
]


@pytest.mark.parametrize("names", TIMED)
def test_times_are_along_straight_lines_where_there_is_no_routing_engine(names: str) -> None:
    reading = read(names)
    distance, time = reading.request["objectives"]
    assert distance == {"name": "distance", "from": "great_circle", "over": "sum"}
    assert time == {"name": "time", "from": "great_circle", "speed": 30, "over": "max"}
    assert reading.request["clock"] == "time"
    sentence = "Times are along straight lines at 30 km/h, as there is no routing engine here."
    assert [note.text for note in reading.notes if note.code == "objectives"] == [sentence]


@pytest.mark.parametrize("names", TIMED)
def test_times_are_by_road_where_there_is_a_routing_engine(names: str) -> None:
    reading = read(names, Bounds(roads=True))
    [_, time] = reading.request["objectives"]
    assert time == {"name": "time", "from": "road_time", "over": "max"}
    assert not [note for note in reading.notes if note.code == "objectives"]


@pytest.mark.parametrize("name", ["ogr2ogr-3d.GEOJSON", "nested-records.json"])
def test_a_fleet_without_times_has_its_longest_route_in_metres(name: str) -> None:
    [_, longest] = read(name).request["objectives"]
    assert longest == {"name": "longest route", "from": "great_circle", "over": "max"}


def test_stops_with_times_may_be_more_than_a_matrix_of_costs_may_have() -> None:
    few = Bounds(matrix_cities=1)
    assert len(read("windows-as-times.csv", few).request["stops"]) == 3
