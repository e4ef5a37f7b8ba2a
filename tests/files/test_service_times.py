"""How long stops take, as people write it in tables: names of columns, units, and plain numbers."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading
from tests.helpers.serving import LIMITS

BRIEF = "is in seconds, {} at most. For minutes, write 5 min or name it"


def read(heading: str, service: str) -> Reading:
    text = f"id;lat;lon;{heading}\ndepot;60.17;24.94;\na;60.18;24.95;{service}\n"
    return read_files([NamedFile("orders.csv", text.encode())], Bounds(roads=LIMITS.roads))


def notes(found: Reading) -> list[str]:
    return [note.text for note in found.notes if note.code == "service"]


@pytest.mark.parametrize(
    ("heading", "service", "seconds"),
    [
        ("minutes", "5", 300),
        ("Minutes on site", "2.5", 150),
        ("mins", "5", 300),
        ("Time at stop (min)", "5", 300),
        ("visit duration minutes", "5", 300),
        ("service", "5 min", 300),
        ("service", "5min.", 300),
        ("Unloading time", "1 h", 3600),
        ("Unloading time", "0:05", 300),
        ("service (min)", "90 sec", 90),
        ("service seconds", "20", 20),
        ("service", "300", 300),
    ],
)
def test_service_is_in_the_unit_that_is_written(heading: str, service: str, seconds: int) -> None:
    found = read(heading, service)
    assert found.request["stops"][1]["service"] == seconds
    assert notes(found) == []


def test_short_service_without_a_unit_is_said_to_be_in_seconds() -> None:
    found = read("Unloading time", "5")
    assert found.request["stops"][1]["service"] == 5
    [said] = notes(found)
    assert "'Unloading time' " + BRIEF.format(5) + " 'Unloading time (min)'." in said


def test_service_in_a_plane_has_the_unit_of_its_distances() -> None:
    text = b"id;x;y;demand;service\ndepot;0;0;0;\na;3;4;1;10\n"
    found = read_files([NamedFile("plane.csv", text)], Bounds(roads=LIMITS.roads))
    assert found.request["stops"][1]["service"] == 10
    assert notes(found) == []
