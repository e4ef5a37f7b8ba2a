"""Prizes in files are traded against costs, as money is not metres; and notes say so."""

from typing import Any

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

UNASSIGNED = {"name": "unassigned", "measure": "unassigned"}
LATENESS = {"name": "lateness", "measure": "lateness"}
PLACED = "depot,60.171,24.941{0}\na,60.169,24.952{1}\nb,60.165,24.933{2}\n"


def read(heading: str, *cells: str, vans: str = "") -> Reading:
    rows = f"id,lat,lon,{heading}\n" + PLACED.format(*(f",{each}" for each in cells))
    files = [NamedFile("orders.csv", rows.encode())]
    files += [NamedFile("vans.csv", vans.encode())] if vans else []
    return read_files(files, Bounds(), wanted=None)


@pytest.mark.parametrize(
    ("heading", "cells", "measures", "clock"),
    [
        ("prize", ("", "100", "80"), [UNASSIGNED], False),
        ("prize", ("0", "100", "80"), [UNASSIGNED], False),
        ("prize", ("", "100", ""), [UNASSIGNED], False),
        ("qty,prize", (",", "1,100", "2,80"), [UNASSIGNED], False),
        ("prize,service [min]", (",", "100,5", "80,5"), [UNASSIGNED], True),
        ("prize,due", (",", "100,9:00", "80,10:00"), [UNASSIGNED, LATENESS], True),
        ("due", ("", "9:00", "10:00"), [LATENESS], True),
    ],
)
def test_a_prize_makes_the_second_objective(
    heading: str, cells: tuple[str, ...], measures: list[dict[str, Any]], clock: bool
) -> None:
    reading = read(heading, *cells)
    first, *others = reading.request["objectives"]
    assert (first["name"], others) == ("distance", measures)
    assert ("clock" in reading.request) == clock
    if UNASSIGNED in measures:
        assert "prize" in reading.request["stops"][1]
        assert any(
            "The second objective is the prizes of the stops" in n.text for n in reading.notes
        )


def test_no_prize_leaves_the_objectives_as_they_are() -> None:
    request = read("qty", "", "1", "2").request
    assert [each["over"] for each in request["objectives"]] == ["sum", "max"]


def test_a_prize_of_nothing_is_noted() -> None:
    [note] = [each.text for each in read("prize", "", "100", "0").notes if each.code == "prize"]
    assert note.startswith("'b' may be left out for nothing, as the prize is 0.")


def test_a_prize_must_not_be_negative() -> None:
    with pytest.raises(UnreadableFile, match="row 3, column 'prize' must not be negative"):
        read("prize", "", "-1", "2")


@pytest.mark.parametrize(
    ("vans", "fixed", "note"),
    [
        ("van,fixed cost\nv,40\n", 40, "as metres: if it is money, name a cost per km as well."),
        ("van,fixed cost,cost per km\nv,40,0.5\n", 80_000, "converted to the metres"),
        ("van,fixed cost,cost per km\nv,40,0.5\nw,9,0\n", 40, "added to the cost"),
    ],
)
def test_a_fixed_cost_in_money_is_converted_or_noted(vans: str, fixed: float, note: str) -> None:
    reading = read("prize", "", "100", "80", vans=vans)
    assert reading.request["vehicles"][0]["fixed"] == fixed
    [text] = [each.text for each in reading.notes if each.code == "fixed"]
    assert note in text


def test_vehicles_that_differ_by_the_kilometre_have_their_own_prices() -> None:
    request = read("prize", "", "100", "80", vans="van,cost per km\nv,0.5\nw,0\n").request
    assert [each["per_distance"] for each in request["vehicles"]] == [0.0005, 0]
    assert request["objectives"][0]["name"] == "cost"


def test_vehicles_have_prices_by_the_hour_and_are_slower_or_faster_than_others() -> None:
    vans = (
        "van,hourly wage,cost per km,speed factor,service factor,min time\n"
        "v,36,0.5,,,2:00\nw,18,0,0.8,1.5,\n"
    )
    request = read("qty", "", "1", "2", vans=vans).request
    of_both = {"capacity": [3], "start": "depot", "end": "depot"}
    slow = {"speed_factor": 0.8, "per_distance": 0, "per_time": 0.005, "service_factor": 1.5}
    assert request["vehicles"] == [
        {"id": "v", **of_both, "per_distance": 0.0005, "per_time": 0.01, "shortest": 7200},
        {"id": "w", **of_both, **slow},
    ]
    assert request["clock"] == "time"
    assert request["objectives"][0]["name"] == "cost"
    with pytest.raises(UnreadableFile, match="'speed factor' must be over 0"):
        read("qty", "", "1", "2", vans="van,speed factor\nv,0\n")
