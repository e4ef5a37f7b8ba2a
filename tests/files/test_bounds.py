"""Files with the bounds of dispatchers: what their columns become, and what is refused where."""

import pytest
from pydantic_core import to_json

from service.files.column_names import (
    NAMES_OF_VEHICLES,
    best_fields,
    fields_of,
    is_about_vehicles,
)
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile, Reading, UnreadableFile
from service.requests.fleet import parse_fleet_request
from tests.files.test_examples import FOLDER, read
from tests.helpers.serving import LIMITS

ORDERS, VANS = "orders-of-two-days.csv", "vans-of-two-shifts.csv"
EXAMPLES = [f"{ORDERS} {VANS}", ORDERS, "assigned.csv", "several-windows.json"]


def changed(*pairs: tuple[str, str], roads: bool = False) -> Reading:
    """Read both tables with other texts in them."""
    texts = {name: (FOLDER / name).read_text() for name in (ORDERS, VANS)}
    for old, new in pairs:
        assert any(old in text for text in texts.values()), old
        texts = {name: text.replace(old, new) for name, text in texts.items()}
    files = [NamedFile(name, text.encode()) for name, text in texts.items()]
    return read_files(files, Bounds(roads=roads))


def test_columns_of_stops_become_their_members() -> None:
    stops = {stop["id"]: stop for stop in read(f"{ORDERS} {VANS}").request["stops"]}
    assert stops["depot"].keys() == {"id", "location"}
    assert stops["#2001"]["windows"] == [[28800, 36000], [50400, 57600]]
    assert stops["#2001"]["skills"] == ["fridge"]
    assert stops["#2002"]["skills"] == ["fridge", "tail lift"]
    assert stops["#2002"]["due"] == 37800
    assert stops["#2003"]["release"] == 30600
    assert not stops["#2003"].keys() & {"window", "windows", "skills", "vehicle"}
    assert stops["#2005"]["vehicle"] == "Kim"
    assert stops["#2005"]["window"] == [28800, 43200]


def test_columns_of_vehicles_become_their_members() -> None:
    kim, lee, mo = read(f"{ORDERS} {VANS}").request["vehicles"]
    home = {"start": "depot", "end": "depot"}
    assert kim == {
        **home,
        "id": "Kim",
        "capacity": [6],
        "shifts": [[28800, 43200], [46800, 61200]],
        "max_stops": 4,
        "max_overtime": 1800,
    }
    assert lee == {
        **home,
        "id": "Lee",
        "capacity": [5],
        "shift": [28800, 57600],
        "skills": ["fridge", "tail lift"],
        "reload": ["depot"],
        "max_trips": 2,
        "initial_load": [1],
    }
    # Without a stop for loading again, that is the start.
    assert mo["reload"] == ["depot"]


@pytest.mark.parametrize("names", EXAMPLES)
def test_the_service_takes_the_stops_and_vehicles_of_each(names: str) -> None:
    request = parse_fleet_request(to_json(read(names).request), LIMITS)
    assert len(request.subject().rules.visits) == len(request.stops)


def test_lateness_is_the_second_objective_of_stops_that_are_due() -> None:
    request = read(f"{ORDERS} {VANS}").request
    assert request["objectives"][1] == {"name": "lateness", "measure": "lateness"}
    assert request["clock"] == {"name": "time", "from": "great_circle", "speed": 30}
    assert changed(roads=True).request["clock"] == {"name": "time", "from": "road_time"}


def test_overtime_is_the_second_objective_where_no_stop_is_due() -> None:
    request = changed(("Deadline", "Note")).request
    assert request["objectives"][1] == {"name": "overtime", "measure": "overtime"}
    neither = changed(("Deadline", "Note"), ("Overtime", "Note")).request
    assert neither["objectives"][1]["name"] == neither["clock"] == "time"


def test_skills_are_left_out_with_a_note_where_no_vehicle_has_a_column_of_them() -> None:
    reading = changed(("Skills", "Hobbies"))
    assert not any("skills" in stop for stop in reading.request["stops"])
    sentence = "'Requires' without skills of vehicles was not used"
    assert any(note.text.startswith(sentence) for note in reading.notes)


REFUSED = [
    ("Kim\n", "Kin\n", f"{ORDERS}: row 6, column 'Driver' must be the id of a vehicle of {VANS}"),
    ('tail lift"', 'crane"', f"{ORDERS}: row 4, column 'Requires' must be skills that one"),
    (
        "fridge,,,\n",
        "fridge,,,Kim\n",
        "column 'Requires' must be skills that vehicle 'Kim' has",
    ),
    (
        "14:00,16:00",
        "09:30,16:00",
        "row 3, column 'Window 2 to' must begin after the window before",
    ),
    ("10:30", "soon", f"{ORDERS}: row 4, column 'Deadline' must be seconds, or a time as 10:30"),
    ("08:30", "-1", f"{ORDERS}: row 5, column 'Ready at depot' must be seconds, or a time as"),
    (";4;;;30", ";0;;;30", f"{VANS}: row 2, column 'Max stops' must be a whole number from 1"),
    (";4;;;30", ";4;depot;;30", "column 'Max stops' must be empty beside 'Reload at', got '4'"),
    (";4;;;30", ";4;;2;30", "column 'Max stops' must be empty beside 'Max trips', got '4'"),
    (
        ";depot;",
        ";depot, kiosk;",
        f"{VANS}: row 3, column 'Reload at' must be ids of stops, got 'kio",
    ),
    ("Working hours", "Hours", f"{VANS}: row 2, column 'Overtime [min]' needs a shift of the vehi"),
    (
        ";2;;1",
        ";2;;6",
        f"{VANS}: row 3, column 'Initial load' must be at most the capacity, 5, got",
    ),
    ("Mo;4", "Mo;many", f"{VANS}: row 4, column 'Capacity' must be a number, got 'many'"),
    ("12:00, 13", "12:00 / 13", f"{VANS}: row 2, column 'Working hours' must be two times, as 8:"),
    ("12:00, 13", "12:00, 11", "column 'Working hours' must begin after the shift before has ende"),
]


@pytest.mark.parametrize(("old", "new", "sentence"), REFUSED)
def test_a_cell_that_cannot_be_is_refused_by_row_and_column(
    old: str, new: str, sentence: str
) -> None:
    with pytest.raises(UnreadableFile) as refused:
        changed((old, new))
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    ("field", "skills"),
    [
        ("fridge", ["fridge"]),
        ("fridge;crane | tail  lift (500 kg),", ["fridge", "crane", "tail lift (500 kg)"]),
        ("['fridge', 'crane']", ["fridge", "crane"]),
        (";", []),
    ],
)
def test_skills_are_the_texts_between_separators(field: str, skills: list[str]) -> None:
    rows = f'id\tlat\tlon\tskills\ndepot\t60.1\t24.9\t\na\t60.2\t24.8\t"{field}"\n'
    [_, stop] = read_files([NamedFile("a.tsv", rows.encode())], Bounds()).request["stops"]
    assert stop["skills"] == skills


@pytest.mark.parametrize(
    ("field", "member"),
    [
        ("8:00-10:00", {"window": [28800, 36000]}),
        ("[8:00 to 10:00]", {"window": [28800, 36000]}),
        ("14:00-15:00 and 8:00-10:00", {"windows": [[28800, 36000], [50400, 54000]]}),
        ("8:00-10:00, 14:00-15:00", {"windows": [[28800, 36000], [50400, 54000]]}),
        ("8,5-10,25", {"window": [8.5, 10.25]}),
        ("", {}),
    ],
)
def test_a_field_may_have_several_windows(field: str, member: dict[str, object]) -> None:
    rows = f"id;lat;lon;time window\ndepot;60.1;24.9;0-99999\na;60.2;24.8;{field}\n"
    [_, stop] = read_files([NamedFile("a.csv", rows.encode())], Bounds()).request["stops"]
    assert {name: stop[name] for name in stop if name.startswith("window")} == member


HEADINGS = [
    ("READY TIME, DUE DATE", "window_from window_to"),
    ("ready, due", "window_from window_to"),
    ("due", "due"),
    ("due date", "window_to"),
    ("open, close, due", "window_from window_to due"),
    ("deliver by, available from", "due release"),
    ("from 2, to 2, window 3", "window_2_from window_2_to window_3"),
    ("tw_start_2, window 2 end", "window_2_from window_2_to"),
    ("opening hours, closing hours", "window_from window_to"),
    ("vehicle type, requirements, status", "None None None"),
]


@pytest.mark.parametrize(("heading", "fields"), HEADINGS)
def test_a_heading_is_taken_for_what_it_says(heading: str, fields: str) -> None:
    assert [str(each) for each in fields_of(heading.split(", "))] == fields.split()


def test_a_driver_beside_places_is_a_column_of_stops_and_a_bound_one_of_vehicles() -> None:
    assert not is_about_vehicles(["id", "lat", "lon", "driver"])
    assert is_about_vehicles(["id", "lat", "lon", "max stops"])
    of_loads = best_fields(
        ["max kg", "max boxes", "initial kg", "initial boxes"], NAMES_OF_VEHICLES
    )
    assert of_loads == ["capacity", "capacity", "initial_load", "initial_load"]
