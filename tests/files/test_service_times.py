"""How long stops take, as people write it in tables: names of columns, units, and plain numbers."""

import pytest
from pydantic_core import to_json

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.kinds.parsing import parse_task
from service.requests.task import TaskSource
from tests.helpers.serving import LIMITS

BRIEF = "is in seconds, {} at most. For minutes, write 5 min or name it"
USUAL = "is in minutes, {} at most. For seconds, write 90 sec or name it"


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
        ("service [ms]", "90000", 90),
        ("serviceTimeSeconds", "90", 90),
        ("service_duration_s", "90", 90),
        ("Service (Std.)", "1.5", 5400),
        ("Durée [minutes]", "5", 300),
        ("Standzeit in Minuten", "5", 300),
        ("service", "0", 0),
    ],
)
def test_service_is_in_the_unit_that_is_written(heading: str, service: str, seconds: int) -> None:
    found = read(heading, service)
    assert found.request["stops"][1]["service"] == seconds
    assert notes(found) == []


@pytest.mark.parametrize("service", ["5", "300"])
def test_service_without_a_unit_is_said_to_be_in_seconds(service: str) -> None:
    found = read("service", service)
    assert found.request["stops"][1]["service"] == int(service)
    assert notes(found) == ["'service' " + BRIEF.format(service) + " 'service (min)'."]


@pytest.mark.parametrize(
    "heading", ["Duration", "Time at stop", "Service Time", "Stop duration", "Unloading time"]
)
def test_what_route_planners_write_is_in_minutes_with_a_note(heading: str) -> None:
    found = read(heading, "15")
    assert found.request["stops"][1]["service"] == 900
    assert notes(found) == [f"'{heading}' " + USUAL.format(15) + f" '{heading} (sec)'."]
    assert read(heading, "900").request["stops"][1]["service"] == 900


@pytest.mark.parametrize("cells", ["5;0:10", "5;10 min"])
def test_a_number_beside_hours_and_minutes_is_asked_about(cells: str) -> None:
    first, second = cells.split(";")
    text = f"id;lat;lon;service\na;60.17;24.94;{first}\nb;60.18;24.95;{second}\n"
    with pytest.raises(UnreadableFile, match=r"column 'service' has '5' beside .*: is it 5 min or"):
        read_files([NamedFile("orders.csv", text.encode())], Bounds())
    minutes = text.replace("service", "service (min)").encode()
    stops = read_files([NamedFile("orders.csv", minutes)], Bounds()).request["stops"]
    assert [each["service"] for each in stops] == [300, 600]


@pytest.mark.parametrize(
    ("heading", "cell", "member", "seconds"),
    [("max time", "300", "longest", 300), ("overtime", "30", "max_overtime", 30)],
)
def test_durations_of_vehicles_without_a_unit_are_noted(
    heading: str, cell: str, member: str, seconds: int
) -> None:
    stops = b"id,lat,lon,demand\ndepot,60.17,24.94,\na,60.18,24.95,1\n"
    vans = f"vehicle,shift,{heading}\nvan,8-12,{cell}\n".encode()
    found = read_files([NamedFile("stops.csv", stops), NamedFile("vans.csv", vans)], Bounds())
    assert found.request["vehicles"][0][member] == seconds
    assert f"'{heading}' is in seconds, {cell} at most" in str(found.notes)


def test_hours_and_a_range_both_bound_a_route_except_in_a_plane() -> None:
    vans = NamedFile("vans.csv", b"vehicle,shift,max time [h],max km\nvan,8-12,3,80\nbike,8-12,,\n")
    stops = b"id,lat,lon,demand\ndepot,60.17,24.94,\na,60.18,24.95,1\n"
    found = read_files([NamedFile("stops.csv", stops), vans], Bounds())
    van, bike = found.request["vehicles"]
    assert (van["longest"], van["max_distance"]) == (10800, 80_000)
    assert not {"longest", "max_distance"} & bike.keys()
    parse_task(TaskSource(found.kind, to_json(found.request)), LIMITS, {})
    plane = b"id,x,y,demand,service\ndepot,0,0,,\na,3,4,1,2\n"
    vans = NamedFile("vans.csv", b"vehicle,max time,max distance\nvan,9,80\n")
    found = read_files([NamedFile("stops.csv", plane), vans], Bounds())
    [van] = found.request["vehicles"]
    assert (van["longest"], van.get("max_distance")) == (9, None)
    assert "'max distance' with times in a plane" in str(found.notes)


def test_service_in_a_plane_has_the_unit_of_its_distances() -> None:
    text = b"id;x;y;demand;service\ndepot;0;0;0;\na;3;4;1;10\n"
    found = read_files([NamedFile("plane.csv", text)], Bounds(roads=LIMITS.roads))
    assert found.request["stops"][1]["service"] == 10
    assert notes(found) == []
