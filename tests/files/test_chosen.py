"""Columns that a person takes for something else than their names say."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.files.chosen import with_chosen
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from tests.helpers.sampled import third

FOLDER = Path(__file__).parent / "examples"
TABLE = "ref,y,x,what,note,when\nA,60.17,24.94,0,,\nB,60.18,24.95,3,ring twice,09:00-10:30\n"
FROM_PIECES = [
    {"file": "orders.csv", "name": "what", "taken_for": "demand"},
    {"file": "orders.csv", "name": "when", "taken_for": "window"},
]


def read(table: str = TABLE, **chosen: str) -> Reading:
    return read_files([NamedFile("orders.csv", table.encode(), chosen)], Bounds(), wanted=None)


def taken(reading: Reading) -> dict[str, str]:
    return {each.name: each.taken_for for each in reading.columns}


def test_a_column_is_taken_for_what_was_chosen_and_makes_a_fleet() -> None:
    reading = read(what="demand", when="window")
    assert reading.kind == "fleet"
    assert reading.request["stops"][1]["demand"] == [3]
    assert reading.request["stops"][1]["window"] == [9 * 3600, 10.5 * 3600]
    assert taken(reading)["what"] == "demand"


def test_an_ignored_column_stays_in_its_place_among_the_others() -> None:
    heading = TABLE.splitlines()[0].split(",")
    reading = read("id,lat,lon,qty,cost\nA,60.1,24.9,1,2\nB,60.2,24.9,1,2\n", qty="ignored")
    assert reading.kind == "front"
    assert list(taken(reading)) == ["id", "lat", "lon", "qty", "cost"]
    assert taken(reading)["qty"] == "ignored"
    assert list(taken(read(what="demand", x="longitude", y="latitude"))) == heading


def test_a_chosen_column_takes_a_field_from_another() -> None:
    table = "id,lat,lon,name,lat2,lon2\n1,60.1,24.9,A,61.1,25.9\n2,60.2,24.8,B,61.2,25.8\n"
    reading = read(table, lat2="latitude", lon2="longitude", name="id", id="ignored")
    stops = reading.request["stops"]
    assert [stop["id"] for stop in stops] == ["A", "B"]
    assert [stop["location"] for stop in stops] == [[25.9, 61.1], [25.8, 61.2]]


def told(reading: Reading) -> dict[str, list[str]]:
    return {each.column: each.texts for each in reading.details}


NOTED = """id,lat,lon,customer,note,empty,qty
depot,60.17,24.94,,,,0
,,,,,,
A,60.18,24.95,Ann  Lee,ring twice,,3
B,60.16,24.93,Bo,,,2
"""


def test_unused_columns_of_stops_are_details() -> None:
    reading = read(NOTED)
    assert told(reading) == {"customer": ["", "Ann Lee", "Bo"], "note": ["", "ring twice", ""]}
    fields = taken(reading)
    assert (fields["customer"], fields["note"]) == ("detail", "detail")
    assert fields["empty"] == "ignored"
    assert "detail" in reading.choices["orders.csv"]
    assert "Ann Lee" not in json.dumps(reading.request)


def test_a_detail_is_ignored_if_that_is_chosen_and_a_load_becomes_a_detail() -> None:
    reading = read(NOTED, customer="ignored", qty="detail")
    assert told(reading) == {"note": ["", "ring twice", ""], "qty": ["0", "3", "2"]}
    assert reading.kind == "front"
    assert list(taken(reading)) == NOTED.splitlines()[0].split(",")
    assert taken(reading)["customer"] == "ignored"


def test_details_are_of_the_stops_of_the_request() -> None:
    """Also of a stop that only vehicles name, of planes, and of stops without an id."""
    vans = NamedFile("vans.csv", b"van,max load,start lat,start lon,colour\nv1,9,60.1,24.9,red\n")
    reading = read_files([NamedFile("o.csv", NOTED.encode()), vans], Bounds(), wanted=None)
    assert len(reading.request["stops"]) == 4
    assert told(reading)["customer"] == ["", "Ann Lee", "Bo", ""]
    assert "colour" not in told(reading)
    planes = read("x,y,u,v,who\n0,0,1,1,Ann\n1,0,2,1,Bo\n")
    assert len(planes.request["coordinates"]) == 2
    assert told(planes) == {"who": ["Ann", "Bo"]}
    assert told(read("id,x,y,u,v,who\na,0,0,1,1,Ann\nb,1,0,2,1,Bo\n")) == {"who": ["Ann", "Bo"]}


def test_a_row_of_totals_has_no_details() -> None:
    table = "id,lat,lon,boxes,note\nA,60.1,24.9,3,ring twice\nB,60.2,24.8,4,\nTotal,,,7,checked\n"
    for chosen in ({}, {"note": "detail"}, {"boxes": "detail"}):
        found = read(table, **chosen)
        assert told(found)["note"] == ["ring twice", ""]


def test_tables_of_costs_have_no_details() -> None:
    files = [NamedFile(f"{name}.csv", b"id,a,b\na,0,1\nb,1,0\n") for name in "ab"]
    assert not read_files(files, Bounds(), wanted=None).details


def test_details_are_bounded() -> None:
    names = [f"note {number}" for number in range(12)]
    rows = [["id", "lat", "lon", *names]]
    rows += [[each, "60.1", f"24.{each}", *["\x1b" + "t" * 300] * 12] for each in "12"]
    table = "\n".join(",".join(row) for row in rows)
    assert [*told(read(table))] == names[:10]
    assert {*told(read(table, **{names[11]: "detail"}))} == {*names[:9], names[11]}
    assert {text for texts in told(read(table)).values() for text in texts} == {"?" + "t" * 199}


def test_places_may_be_exchanged() -> None:
    assert read("id,lat,lon\n1,24.9,60.1\n2,24.8,60.2\n", lat="longitude", lon="latitude").request[
        "stops"
    ][0]["location"] == [24.9, 60.1]


def test_columns_of_vehicles_may_be_chosen() -> None:
    stops = NamedFile("stops.csv", b"id,lat,lon,qty\nA,60.1,24.9,0\nB,60.2,24.9,2\n")
    vans = b"van,max load,room,base\nv1,9,4,A\n"
    chosen = {"room": "capacity", "max load": "ignored"}
    files = [stops, NamedFile("vans.csv", vans, chosen)]
    reading = read_files(files, Bounds(), wanted=None)
    assert reading.request["vehicles"][0]["capacity"] == [4]
    assert "max_trips" in reading.choices["vans.csv"]
    assert "due" in reading.choices["stops.csv"]


@pytest.mark.parametrize(
    ("chosen", "sentence"),
    [
        ({"piece": "demand"}, "orders.csv: has no column of the name that was chosen, got 'piece'"),
        ({"what": "weight"}, "column 'what' must be taken for id, longitude, latitude, place,"),
        ({"note": "demand"}, "row 3, column 'note' must be a number, got 'ring twice'"),
        ({"note": "place"}, "row 2, column 'note' must be a place, as 60.1, 24.9"),
        ({"what": "demand", "note": "id"}, "column 'note' must be an id, got none"),
        (dict.fromkeys(TABLE.splitlines()[0].split(","), "ignored"), "must have a column that is"),
    ],
)
def test_what_cannot_be_chosen_is_refused(chosen: dict[str, str], sentence: str) -> None:
    with pytest.raises(UnreadableFile) as refused:
        read(**chosen)
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    "part",
    [
        *(b"", b"{}", b'"x"', b"[1]", b'[{"file": "orders.csv"}]', b"[[" * 5000),
        b'[{"file": "other.csv", "name": "qty", "taken_for": "demand"}]',
        json.dumps([FROM_PIECES[0]] * 1001).encode(),
    ],
)
def test_a_part_that_is_no_list_of_columns_is_refused(part: bytes) -> None:
    with pytest.raises(Refusal) as refused:
        with_chosen([NamedFile("orders.csv", TABLE.encode())], part)
    assert refused.value.code == "invalid-parts"


def test_a_part_is_as_the_columns_of_the_answer() -> None:
    [file] = with_chosen([NamedFile("orders.csv", b"")], json.dumps(FROM_PIECES).encode())
    assert file.chosen == {"what": "demand", "when": "window"}


def tables() -> list[str]:
    """The examples that are one table with a heading."""
    found = []
    for path in sorted(FOLDER.iterdir()):
        try:
            reading = read_files([NamedFile(path.name, path.read_bytes())], Bounds(), wanted=None)
        except UnreadableFile:
            continue
        if reading.columns:
            found.append(path.name)
    return found


def test_whatever_is_chosen_becomes_a_request_or_a_refusal(subtests: pytest.Subtests) -> None:
    for name in tables():
        with subtests.test(name):
            check_all_choices(name)


def check_all_choices(name: str) -> None:
    """Take every column of an example for everything, and some columns together at random."""
    file = NamedFile(name, (FOLDER / name).read_bytes())
    usual = read_files([file], Bounds(), wanted=None)
    columns = [each.name for each in usual.columns]
    fields = list(usual.choices[name])
    random = np.random.default_rng(1)
    some: list[dict[str, Any]] = [{column: each} for column in columns for each in fields]
    some += [
        {column: str(random.choice(fields)) for column in columns if random.random() < 0.5}
        for _ in range(50)
    ]
    for at in random.permutation(len(some))[: third(len(some))]:
        chosen = some[at]
        try:
            reading = read_files([NamedFile(name, file.data, chosen)], Bounds(), wanted=None)
        except UnreadableFile:
            continue
        assert reading.request
        assert {each.name for each in reading.columns} == set(columns)
