"""`POST /files`: files become requests that the service plans, or are refused with a code."""

import io
import json
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import openpyxl
import paretour
import pytest

from service.errors import MOST_FAULTS
from tests.files.test_examples import FOLDER as EXAMPLES
from tests.helpers.serving import LIMITS, app_of, problem, serving

ORDERS = "Order ID;Breitengrad;Längengrad;demand\ndepot;60,1;24,9;0\n#1001;60,2;24,95;3\n"


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


@pytest.fixture(scope="module")
def roomy() -> Iterator[str]:
    """A service that takes long bodies."""
    with serving(app_of(limits=replace(LIMITS, body_bytes=2**24))) as address:
        yield address


@pytest.fixture(scope="module")
def patient() -> Iterator[str]:
    """A service that may plan for seconds."""
    with serving(app_of(limits=replace(LIMITS, seconds=5))) as address:
        yield address


def sent(address: str, *files: tuple[str, bytes]) -> httpx.Response:
    return httpx.post(f"{address}/files", files=[("file", each) for each in files], timeout=300)


def test_a_table_becomes_a_fleet_that_the_service_plans(address: str) -> None:
    answer = sent(address, ("ORDERS.CSV", ORDERS.encode("cp1252"))).json()
    assert (answer["kind"], answer["name"]) == ("fleet", "ORDERS.CSV")
    assert [stop["id"] for stop in answer["request"]["stops"]] == ["depot", "#1001"]
    column = {"file": "ORDERS.CSV", "name": "Breitengrad", "taken_for": "latitude"}
    assert column in answer["columns"]
    assert {"encoding", "separator", "vehicle", "columns"} <= {n["code"] for n in answer["notes"]}
    planned = httpx.post(f"{address}/fleet", json=answer["request"], timeout=300)
    assert planned.status_code == 200, planned.text


def test_columns_are_taken_for_what_is_chosen(address: str) -> None:
    """Also those of a table that cannot be read as its names say."""
    rows = b"ref,Nord-Sued,Ost-West,sacks\nA,60.17,24.94,0\nB,60.18,24.95,3\n"
    refused = sent(address, ("orders.csv", rows))
    assert (refused.status_code, refused.json()["code"]) == (422, "unreadable-file")
    columns = refused.json()["columns"]
    assert [each["name"] for each in columns] == ["ref", "Nord-Sued", "Ost-West", "sacks"]
    assert {"latitude", "ignored"} <= {*refused.json()["choices"]["orders.csv"]}
    chosen = {"Nord-Sued": "latitude", "Ost-West": "longitude", "sacks": "demand"}
    part = [{**each, "taken_for": chosen.get(each["name"], "id")} for each in columns]
    answer = httpx.post(
        f"{address}/files",
        files=[("file", ("orders.csv", rows)), ("columns", (None, json.dumps(part)))],
    ).json()
    assert answer["request"]["stops"][1] == {"id": "B", "location": [24.95, 60.18], "demand": [3]}
    assert answer["columns"] == part
    wrong = httpx.post(
        f"{address}/files",
        files=[("file", ("orders.csv", rows)), ("columns", (None, "[1]"))],
    )
    problem(wrong, 422, "invalid-parts")


def test_details_for_drivers_are_told_beside_the_request(address: str) -> None:
    rows = "id,lat,lon,note\na,60.17,24.94,\nb,60.18,24.95,ring twice\n"
    answer = sent(address, ("orders.csv", rows.encode())).json()
    assert answer["details"] == [{"column": "note", "texts": ["", "ring twice"]}]
    assert answer["columns"][-1]["taken_for"] == "detail"
    assert "ring" not in json.dumps(answer["request"])
    part = json.dumps([{**answer["columns"][-1], "taken_for": "ignored"}])
    files = [("file", ("orders.csv", rows.encode())), ("columns", (None, part.encode()))]
    assert "details" not in httpx.post(f"{address}/files", files=files).json()


def test_details_that_are_too_long_for_an_answer_are_left_out() -> None:
    stops = [f"s{number},60.{number:03},24.9,{'note ' * 30}" for number in range(50)]
    table = "\n".join(["id,lat,lon,note", *stops]).encode()
    with serving(app_of(limits=replace(LIMITS, body_bytes=len(table) + 1000))) as address:
        answer = sent(address, ("orders.csv", table)).json()
    assert "details" not in answer, answer
    assert answer["columns"][-1]["taken_for"] == "ignored"
    assert "details" in {note["code"] for note in answer["notes"]}


def test_a_table_with_windows_is_planned_without_a_routing_engine(address: str) -> None:
    rows = "id,lat,lon,from,to\ndepot,60.17,24.94,08:00,18:00\na,60.18,24.95,09:00,09:10\n"
    answer = sent(address, ("windows.csv", rows.encode())).json()
    time = answer["request"]["objectives"][1]
    assert time == {"name": "time", "from": "great_circle", "speed": 30, "over": "max"}
    assert any("straight lines at 30 km/h" in note["text"] for note in answer["notes"])
    planned = httpx.post(f"{address}/fleet", json=answer["request"], timeout=300)
    assert planned.status_code == 200, planned.text
    [plan] = planned.json()["front"]
    assert plan["routes"][0]["stops"] == ["depot", "a", "depot"]
    assert 9 * 3600 <= plan["routes"][0]["arrivals"][1] <= 9 * 3600 + 600


PLANNED = [
    "orders-of-two-days.csv vans-of-two-shifts.csv",
    "assigned.csv",
    "due-in-a-plane.csv",
    "several-windows.json",
    "vroom-skills.json",
    "vroom-between-towns.json",
    "vroom-shipments.json",
]


@pytest.mark.parametrize("names", PLANNED)
def test_files_with_bounds_are_planned_within_them(patient: str, names: str) -> None:
    files = [(name, (EXAMPLES / name).read_bytes()) for name in names.split()]
    asked = sent(patient, *files).json()["request"]
    planned = httpx.post(f"{patient}/fleet", json=asked | {"time_limit": 5}, timeout=300)
    assert planned.status_code == 200, planned.text
    stops = {stop["id"]: stop for stop in asked["stops"]}
    skills = {vehicle["id"]: vehicle.get("skills", []) for vehicle in asked["vehicles"]}
    assert planned.json()["front"]
    for plan in planned.json()["front"]:
        for route in plan["routes"]:
            for stop in (stops[each] for each in route["stops"]):
                assert stop.get("vehicle", route["vehicle"]) == route["vehicle"]
                assert set(stop.get("skills", ())) <= set(skills[route["vehicle"]])


def test_two_tables_are_an_objective_each(address: str) -> None:
    answer = sent(address, ("a.csv", b"0,1\n2,0\n"), ("b.csv", b"0,\n2,0\n")).json()
    assert answer["request"] == {"matrices": [[[0, 1], [2, 0]], [[0, None], [2, 0]]]}


def spreadsheet(sheet: bytes, times: int) -> bytes:
    """A spreadsheet whose one sheet repeats these bytes."""
    packed = io.BytesIO()
    book = openpyxl.Workbook()
    book.save(packed)
    parts = zipfile.ZipFile(packed)
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file:
        for name in parts.namelist():
            if "sheet1" not in name:
                file.writestr(name, parts.read(name))
        with file.open("xl/worksheets/sheet1.xml", "w", force_zip64=True) as part:
            for _ in range(times):
                part.write(sheet)
    return made.getvalue()


SHEET = '<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>'
CELLS = (
    f'<row r="{row}"><c r="A{row}"><v>1</v></c><c r="XFD{row}"><v>1</v></c></row>'
    for row in range(1, 9999)
)
WIDE = f"{SHEET}{''.join(CELLS)}"
LAUGHS = "".join(f'<!ENTITY a{i} "{f"&a{i - 1};" * 10}">' for i in range(1, 12))
LAUGHING = (
    f'<!DOCTYPE x [<!ENTITY a0 "ha">{LAUGHS}]>{SHEET}<row><c t="str"><v>&a11;</v></c></row>'
    "</sheetData></worksheet>"
)


@pytest.mark.parametrize(
    ("sheet", "times", "status"),
    [
        (b"<row/>" * 2**17, 200, 422),
        (f"{WIDE}</sheetData></worksheet>".encode(), 1, 413),
        (LAUGHING.encode(), 1, 422),
    ],
    ids=["unpacks to 150 MB, not XML", "160 million fields", "entities"],
)
def test_a_spreadsheet_that_would_fill_the_memory_is_refused(
    roomy: str, sheet: bytes, times: int, status: int
) -> None:
    answer = sent(roomy, ("a.xlsx", spreadsheet(sheet, times)))
    assert answer.status_code == status, answer.text


@pytest.mark.parametrize(
    ("files", "status", "code", "sentence"),
    [
        ([("a.csv", b"id,lat,lon\na,1,2\nb,north,3\n")], 422, "unreadable-file", "row 3"),
        ([("a.csv", b"")], 422, "unreadable-file", "a.csv"),
        ([("../../etc/x\x1b.csv", b"1,2\n")], 422, "unreadable-file", "4, 6 or 8 columns"),
        (
            [("a.tsp", b"DIMENSION: 20000\nEDGE_WEIGHT_TYPE: EUC_2D\n")] * 2,
            413,
            "file-too-large",
            "20000",
        ),
        ([("a.xlsx", b"PK\x03\x04")], 422, "unreadable-file", "XLSX"),
        ([("a.csv", b"1,2,3,4\n")] * 9, 422, "invalid-parts", "8 parts"),
    ],
)
def test_what_cannot_be_read_is_refused(
    address: str, files: Any, status: int, code: str, sentence: str
) -> None:
    answer = sent(address, *files)
    assert (answer.status_code, answer.json()["code"]) == (status, code)
    assert sentence in answer.json()["detail"]
    assert "\x1b" not in answer.text


def test_all_wrong_cells_are_told_at_once_and_those_that_are_not_listed_are_counted(
    address: str,
) -> None:
    stops = [f"s{row},{'north' if row % 2 else '60.1'},24.9" for row in range(2, 52)]
    vans = b"vehicle,capacity\nKim,5\nLee,big\n"
    files = ("orders.csv", "\n".join(["id,lat,lon,qty", *stops]).replace(".9", ".9,1").encode())
    answer = sent(address, files, ("vans.csv", vans))
    problem(answer, 422, "unreadable-file")
    told = answer.json()
    first = "orders.csv: row 3, column 'lat' must be a number, got 'north'"
    assert told["detail"] == f"{first} (and 25 more)"
    assert told["wrong_cells"] == 26
    said = [f"row {row}, column 'lat'" for row in range(3, 3 + 2 * MOST_FAULTS, 2)]
    assert [each["detail"].split(" must")[0] for each in told["errors"]] == [
        f"orders.csv: {each}" for each in said
    ]
    assert {"latitude", "ignored"} <= {*told["choices"]["orders.csv"]}
    alone = sent(address, ("vans.csv", vans), ("orders.csv", b"id,lat,lon,qty\na,1,2,3\nb,1,2,4\n"))
    told = alone.json()
    cell = {"file": "vans.csv", "row": 3, "column": "capacity", "came": '"big"'}
    demand = "must be a number, got 'big'"
    assert told["errors"] == [
        {"detail": told["detail"], "code": "no-number", "demand": demand, "values": cell}
    ]
    empty = sent(address, ("a.csv", b"")).json()
    assert [each["code"] for each in empty["errors"]] == ["no-stops"]
    assert "wrong_cells" not in empty


def test_other_bodies_are_refused(address: str) -> None:
    answer = httpx.post(f"{address}/files", json={})
    assert (answer.status_code, answer.json()["code"]) == (415, "not-files")
    answer = httpx.post(f"{address}/files", files=[("map", ("a.csv", b"1"))])
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid-parts")


def test_a_map_says_which_cells_are_unknown_and_takes_pictures_of_costs(address: str) -> None:
    said = b"image: office.pgm\nresolution: 0.5\norigin: [0, 0, 0]\nnegate: 0\n"
    said += b"occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    office = b"P2 4 2 255  254 254 254 205  254 254 0 205\n"
    dust = b"P2 4 2 255  255 0 51 255  255 255 255 255\n"
    files = (("dust.pgm", dust), ("office.yaml", said), ("office.pgm", office))
    answer = sent(address, *files).json()
    request = answer["request"]
    assert request["grid"] == [[0, 0, 0, 1], [0, 0, 1, 1]]
    assert answer["unknown_cells"] == [[0, 0, 0, 1], [0, 0, 0, 1]]
    layer = [[0, 1, 0.8, 0], [0, 0, 0, 0]]
    assert request["cost_layers"] == [{"name": "dust", "layer": layer}]
    planned = httpx.post(f"{address}/coverage", json={**request, "spacing": 0.5}, timeout=300)
    assert planned.json()["objectives"][1]["name"] == "dust"
    known = sent(address, ("known.pgm", b"P2 2 1 255  254 0\n")).json()
    assert "unknown_cells" not in known


def test_half_a_character_in_json_is_refused(address: str) -> None:
    data = b'[{"id":"\\ud800","lat":60,"lon":24},{"id":"b","lat":61,"lon":24}]'
    refused = problem(sent(address, ("a.json", data)), 422, "unreadable-file")
    assert "half a character" in refused["detail"]


def test_the_client_sends_a_file_whose_name_is_no_text(address: str) -> None:
    rows = b"id,lat,lon\na,60,24\nb,61,24\n"
    with paretour.Client(address) as client:
        answer = client.read_files({"caf\udce9.csv": rows})
    assert answer["name"] == "caf?.csv"


def test_the_client_plans_what_it_has_read(address: str) -> None:
    rows = b"id,x,y,second x,second y\na,0,0,5,5\nb,3,1,9,1\nc,5,2,2,8\n"
    with paretour.Client(address) as client:
        plan = client.read_files({"stops.csv": rows})
        front = client.plan_any(plan)
    assert isinstance(front, paretour.Front)
    assert sorted(front[0].stops or ()) == ["a", "b", "c"]
    assert {"kind", "request", "notes"} <= plan.keys()
