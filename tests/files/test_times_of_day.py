"""Times of day as people write them in tables: hours alone, with words, or seconds."""

import pytest

from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile

HOUR = 3600
MORNING = [8 * HOUR, 12 * HOUR]


def read(heading: str, *cells: str, places: str = "lat;lon") -> Reading:
    rows = [f"{at};60.1{at};24.9{at};1;{each}" for at, each in enumerate(cells, 1)]
    text = "\n".join([f"id;{places};demand;{heading}", "0;60.1;24.9;;", *rows])
    return read_files([NamedFile("orders.csv", text.encode())], Bounds())


def said(found: Reading) -> list[str]:
    return [note.text for note in found.notes if note.code == "times"]


@pytest.mark.parametrize(
    ("text", "window"),
    [
        ("8-12", MORNING),
        ("8 - 12", MORNING),
        ("8.00-12.00", MORNING),
        ("0800-1200", MORNING),
        ("800-1200", MORNING),
        ("8 to 12", MORNING),
        ("8-12h", MORNING),
        ("8-12 Uhr", MORNING),
        ("8 Uhr bis 12:00 Uhr", MORNING),
        ("8:00h-12:00h", MORNING),
        ("8am-12pm", MORNING),
        ("8-11:30 a.m.", [8 * HOUR, 11.5 * HOUR]),
        ("8:00 AM - 1:30 PM", [8 * HOUR, 13.5 * HOUR]),
        ("8-1:30 pm", [8 * HOUR, 13.5 * HOUR]),
        ("1:00-3:00 PM", [13 * HOUR, 15 * HOUR]),
        ("8h30-12h", [8.5 * HOUR, 12 * HOUR]),
        ("8.30-12.30h", [8.5 * HOUR, 12.5 * HOUR]),
        ("8,30-12,00", [8.5 * HOUR, 12 * HOUR]),
        ("8.3-12", [8.5 * HOUR, 12 * HOUR]),
        ("8.5-12", [8.5 * HOUR, 12 * HOUR]),
        ("8.75-12.5", [8.75 * HOUR, 12.5 * HOUR]),
        ("0-24", [0, 24 * HOUR]),
        ("22:00-26:00", [22 * HOUR, 26 * HOUR]),
        ("28800-43200", MORNING),
        ("480 min-720 min", MORNING),
        ("480-720 min", MORNING),
    ],
)
def test_a_window_on_the_earth_is_of_times_of_day(text: str, window: list[float]) -> None:
    assert read("window", text).request["stops"][1]["window"] == window
    assert read("window", text, "9:00-10:00").request["stops"][1]["window"] == window


def test_how_hours_are_read_is_said_once_by_an_example() -> None:
    found = read("window", "8-12", "8.30-11", "9:00-10:00")
    assert said(found) == ["'window' has hours, such as 8.30-11, read as 8:30-11:00."]
    two = read("window", "8-10, 14-16")
    assert said(two) == [
        "'window' has hours, such as 8-10, 14-16, read as 8:00-10:00; 14:00-16:00."
    ]
    assert said(read("window", "8 am - 12 pm", "9:00-10:00", "8-12 Uhr")) == []


@pytest.mark.parametrize(
    ("cell", "window"),
    [
        ("8;12", MORNING),
        ("8;12:00", MORNING),
        ("800;1200", MORNING),
        ("0800;1200", MORNING),
        ("8 am;12 pm", MORNING),
        (";12", [0, 12 * HOUR]),
        ("28800;43200", MORNING),
        ("0;43200", [0, 12 * HOUR]),
        ("10;7000", [10, 7000]),
    ],
)
def test_begin_and_end_in_columns_of_their_own_are_read_together(
    cell: str, window: list[float]
) -> None:
    assert read("from;to", cell).request["stops"][1]["window"] == window


@pytest.mark.parametrize("field", ["due", "release"])
@pytest.mark.parametrize(
    ("text", "seconds"),
    [("12", 43200), ("8.30", 30600), ("0930", 34200), ("34200", 34200), ("90 min", 5400)],
)
def test_a_single_time_on_the_earth_is_a_time_of_day(field: str, text: str, seconds: int) -> None:
    assert read(field, text).request["stops"][1][field] == seconds


def test_the_unit_of_a_heading_is_that_of_its_numbers() -> None:
    found = read("window (min)", "480-720")
    assert found.request["stops"][1]["window"] == MORNING
    assert said(found) == []


def test_times_that_stay_seconds_beside_hours_are_said() -> None:
    found = read("window", "28800-43200", "8-12")
    assert [each.get("window") for each in found.request["stops"]] == [None, MORNING, [8, 12]]
    sentence = "'window' is in seconds, such as 8. Write times of day as 8:00."
    assert said(found) == [sentence]
    assert said(read("window", "28800-43200")) == []


@pytest.mark.parametrize(
    ("heading", "cell", "member", "value"),
    [
        ("ready;due", "0;12", "window", [0, 12]),
        ("window", "8-12", "window", [8, 12]),
        ("window", "800-1200", "window", [800, 1200]),
        ("due", "12", "due", 12),
    ],
)
def test_numbers_in_a_plane_are_in_the_unit_of_distances(
    heading: str, cell: str, member: str, value: object
) -> None:
    found = read(heading, cell, places="x;y")
    assert found.request["stops"][1][member] == value
    assert said(found) == []


@pytest.mark.parametrize(
    ("heading", "cell", "column"),
    [
        ("window", "12:00-8:00", "window"),
        ("window", "12-8", "window"),
        ("from;to", "22:00;2:00", "to"),
    ],
)
def test_a_window_that_ends_before_it_begins_is_refused(
    heading: str, cell: str, column: str
) -> None:
    with pytest.raises(UnreadableFile) as refused:
        read(heading, cell)
    where = f"row 3, column '{column}' must have a window that ends after it begins"
    assert f"{where} (after midnight, 2:00 is 26:00), got" in str(refused.value)


@pytest.mark.parametrize("cell", ["25-30", "8.75-9.30"])
def test_numbers_that_are_not_hours_beside_times_are_refused(cell: str) -> None:
    demand = "row 4, column 'window' must be seconds, or a time as 10:30 or 5 min, got"
    with pytest.raises(UnreadableFile, match=demand):
        read("window", "8:00-12:00", cell)


@pytest.mark.parametrize(
    ("heading", "cell", "shift"),
    [
        ("shift", "8-12", MORNING),
        ("shift start;shift end", "8;12", MORNING),
        ("shift [h]", "8-12", MORNING),
        ("working hours", "8-12", MORNING),
        ("working hours", "8.30-12", [8.5 * HOUR, 12 * HOUR]),
        ("working hours", "0800-1200", MORNING),
        ("start;end", "8am;12pm", MORNING),
        ("shift", "28800-43200", MORNING),
    ],
)
def test_shifts_are_read_as_windows_are(heading: str, cell: str, shift: list[float]) -> None:
    stops = b"id;lat;lon;demand\n0;60.1;24.9;\n1;60.2;24.9;1\n"
    vans = f"vehicle;{heading}\nvan;{cell}\n".encode()
    found = read_files([NamedFile("stops.csv", stops), NamedFile("vans.csv", vans)], Bounds())
    assert found.request["vehicles"][0]["shift"] == shift
