"""`POST /files`: files become requests that the service plans, or are refused with a code."""

import io
import zipfile
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from tests.helpers.serving import app_of, serving

ORDERS = "Order ID;Breitengrad;Längengrad;demand\ndepot;60,1;24,9;0\n#1001;60,2;24,95;3\n"


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with serving(app_of()) as address:
        yield address


def sent(address: str, *files: tuple[str, bytes]) -> httpx.Response:
    return httpx.post(f"{address}/files", files=[("file", each) for each in files], timeout=60)


def test_a_table_becomes_a_fleet_that_the_service_plans(address: str) -> None:
    answer = sent(address, ("ORDERS.CSV", ORDERS.encode("cp1252"))).json()
    assert (answer["kind"], answer["name"]) == ("fleet", "ORDERS.CSV")
    assert [stop["id"] for stop in answer["request"]["stops"]] == ["depot", "#1001"]
    assert {"name": "Breitengrad", "taken_for": "latitude"} in answer["columns"]
    assert {"encoding", "separator", "vehicle", "columns"} <= {n["code"] for n in answer["notes"]}
    planned = httpx.post(f"{address}/fleet", json=answer["request"], timeout=60)
    assert planned.status_code == 200, planned.text


def test_two_tables_are_an_objective_each(address: str) -> None:
    answer = sent(address, ("a.csv", b"0,1\n2,0\n"), ("b.csv", b"0,\n2,0\n")).json()
    assert answer["request"] == {"matrices": [[[0, 1], [2, 0]], [[0, None], [2, 0]]]}


def bomb() -> bytes:
    """A spreadsheet whose one sheet unpacks to 2 GB."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("xl/workbook.xml", b"<workbook/>")
        with file.open("xl/worksheets/sheet1.xml", "w", force_zip64=True) as part:
            for _ in range(20):
                part.write(bytes(2**20))
    content = bytearray(packed.getvalue())
    return bytes(content)


@pytest.mark.parametrize(
    ("files", "status", "code", "sentence"),
    [
        ([("a.csv", b"id,lat,lon\na,1,2\nb,north,3\n")], 422, "unreadable-file", "row 3"),
        ([("a.csv", b"")], 422, "unreadable-file", "a.csv"),
        ([("../../etc/x\x1b.csv", b"1,2\n")], 422, "unreadable-file", "4 columns"),
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


def test_other_bodies_are_refused(address: str) -> None:
    answer = httpx.post(f"{address}/files", json={})
    assert (answer.status_code, answer.json()["code"]) == (415, "not-files")
    answer = httpx.post(f"{address}/files", files=[("map", ("a.csv", b"1"))])
    assert (answer.status_code, answer.json()["code"]) == (422, "invalid-parts")
