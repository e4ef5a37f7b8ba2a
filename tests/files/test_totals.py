"""Rows of totals at the end of a table, which are not stops or vehicles."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

STOPS = "id;lat;lon;demand\ndepot;60.1;24.9;\na;60.2;24.9;4\nb;60.15;24.95;5\n"


def read(*texts: str) -> Reading:
    files = [NamedFile(f"{at}.csv", text.encode()) for at, text in enumerate(texts)]
    return read_files(files, Bounds())


def totals(found: Reading) -> list[str]:
    return [note.text for note in found.notes if note.code == "total"]


@pytest.mark.parametrize("row", ["Total;;;9", "Summe:;;;", ";;;9", "all;;;9"])
@pytest.mark.parametrize("below", ["", ";;;\n", " ; ; ; \n;;;\n"])
def test_a_total_is_left_out_with_a_note(row: str, below: str) -> None:
    found = read(f"{STOPS}{row}\n{below}")
    assert [stop["id"] for stop in found.request["stops"]] == ["depot", "a", "b"]
    came = " ".join(filter(None, row.split(";")))
    assert totals(found) == [f"Row 5, '{came}', was taken for a total and left out."]


@pytest.mark.parametrize(
    "text",
    [
        "name,WKT,qty\na,POINT(24.9 60.1),3\nb,POINT(24.8 60.2),3\nTotal,,6\n",
        "id,x,y,demand\na,0,0,0\nb,1,2,3\nTotal,,,3\n",
        "id,lat,lon\na,60.1,24.9\nb,60.2,24.9\nTotal,,\n",
    ],
)
def test_places_may_be_in_any_columns(text: str) -> None:
    found = read(text)
    assert [stop["id"] for stop in found.request["stops"]] == ["a", "b"]
    assert len(totals(found)) == 1


@pytest.mark.parametrize("row", ["c;;;3", "c;;;", "Total;;;9\nc;60.1;24.8;1", "Total;;24.9;9"])
def test_a_stop_without_a_place_is_refused(row: str) -> None:
    with pytest.raises(UnreadableFile, match=r"row 5, column '(lat|lon)' must be a number, got ''"):
        read(f"{STOPS}{row}\n")


def test_a_stop_may_be_named_total() -> None:
    found = read(f"{STOPS}Total;60.1;24.8;9\n")
    assert found.request["stops"][3]["id"] == "Total"
    assert totals(found) == []


def test_a_total_of_vehicles_is_not_a_vehicle() -> None:
    found = read(STOPS, "vehicle;capacity\nvan;6\nbike;3\nTotal;9\n")
    assert [each["id"] for each in found.request["vehicles"]] == ["van", "bike"]
    assert totals(found) == ["Row 4, 'Total 9', was taken for a total and left out."]
