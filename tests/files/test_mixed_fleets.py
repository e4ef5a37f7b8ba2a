"""Columns of what stops give back, and of the kinds of vehicles."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

STOPS = "id,lat,lon,demand,takes back\ndepot,60.1,24.9,,\na,60.2,24.9,4,2.5\nb,60.15,24.95,5,\n"
VEHICLES = "vehicle,capacity,profile\nvan,6,car\nlorry,9,truck\n"
KNOWN = Bounds(roads=True, profiles=("car", "truck"))


def read(*texts: str, bounds: Bounds) -> Reading:
    files = [NamedFile(f"{at}.csv", text.encode()) for at, text in enumerate(texts)]
    return read_files(files, bounds)


@pytest.mark.parametrize(
    ("heading", "row", "visit"),
    [
        ("demand,takes back", "4,2.5", {"demand": [40], "pickup": [25]}),
        ("empties", "3", {"pickup": [3]}),
        (
            "weight,volume,pickup volume,pickup weight",
            "4,1,2,3",
            {"demand": [4, 1], "pickup": [3, 2]},
        ),
        ("demand,returns", "4,not today", {"demand": [4]}),
    ],
)
def test_what_a_stop_gives_back_is_a_column(
    heading: str, row: str, visit: dict[str, list[int]]
) -> None:
    found = read(f"id,lat,lon,{heading}\na,60.2,24.9,{row}\n", bounds=Bounds())
    [stop] = found.request["stops"]
    assert {name: stop[name] for name in ("demand", "pickup") if name in stop} == visit
    most = [sum(each) for each in zip(*visit.values(), strict=True)]
    assert found.request["vehicles"][0]["capacity"] == most


def test_vehicles_drive_by_road_as_their_kind_does() -> None:
    request = read(STOPS, VEHICLES, bounds=KNOWN).request
    assert [each["profile"] for each in request["vehicles"]] == ["car", "truck"]
    assert [each["from"] for each in request["objectives"]] == ["road_distance", "road_time"]
    plain = read(STOPS, VEHICLES, bounds=Bounds())
    assert not any("profile" in each for each in plain.request["vehicles"])
    assert any("'profile' without profiles" in note.text for note in plain.notes)


@pytest.mark.parametrize(
    ("vehicles", "reason"),
    [
        (VEHICLES.replace("truck", "trick"), 'must be "car" or "truck", the profiles that'),
        ("vehicle,max weight,max volume\nvan,6,9\n", "a column of capacity for each demand"),
    ],
)
def test_columns_of_vehicles_that_do_not_fit_are_refused(vehicles: str, reason: str) -> None:
    with pytest.raises(UnreadableFile, match=reason):
        read(STOPS, vehicles, bounds=KNOWN)
