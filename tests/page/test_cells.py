"""What is typed into the tables of a fleet and the form: the page's modules in Node."""

from typing import Any

import pytest

from tests.helpers.node import Node

CELL = """async ([table, title, text, second]) => {
  const { columnsOf } = await import("./page/fleet/columns.js");
  const { cellText, hintOf, isUnread, withText } = await import("./page/fleet/cells.js");
  const objectives = [{ name: "distance", unit: "m" }, { name: "time", unit: "s" }];
  const asked = { stops: [{ id: "depot" }], vehicles: [{ id: "van" }], objectives, clock: "time" };
  const column = columnsOf(table, asked).find((each) => each.title === title);
  const { id, ...item } = withText({ id: "it" }, column, text, second);
  const read = isUnread(item, column) ? null : item;
  return [read, cellText(item, column, second), hintOf(column, second)];
}"""
HOUR, MINUTE = 3600, 60
LUNCH = {"window": [12 * HOUR, 13 * HOUR], "length": 30 * MINUTE}


def read(node: Node, table: str, title: str, text: str, second: int = 1) -> list[Any]:
    """Return the members that a text becomes, None if it is refused; the text; and the hint."""
    found: list[Any] = node.evaluate(CELL, [table, title, text, second])
    return found


@pytest.mark.parametrize(
    ("table", "title", "text", "members", "shown"),
    [
        ("stops", "Demand", "2", {"demand": [2]}, "2"),
        ("stops", "Demand", "2, 5", {"demand": [2, 5]}, "2, 5"),
        ("stops", "Service", "5 min", {"service": 300}, "5 min"),
        ("stops", "Service", "5", {"service": 300}, "5 min"),
        ("stops", "Service", "120", {"service": 7200}, "120 min"),
        ("stops", "Service", "45.5 s", {"service": 45.5}, "45.5 s"),
        ("stops", "Service", "0:05:30", {"service": 330}, "330 s"),
        ("stops", "Service", "1 h 5 min", {"service": 3900}, "65 min"),
        ("stops", "Window", "8-12", {"window": [8 * HOUR, 12 * HOUR]}, "8:00-12:00"),
        ("stops", "Window", "0800-1200", {"window": [8 * HOUR, 12 * HOUR]}, "8:00-12:00"),
        ("stops", "Window", "8h30-12h", {"window": [8.5 * HOUR, 12 * HOUR]}, "8:30-12:00"),
        ("stops", "Window", "8-12 Uhr", {"window": [8 * HOUR, 12 * HOUR]}, "8:00-12:00"),
        ("stops", "Window", "11 - 1:30 pm", {"window": [11 * HOUR, 13.5 * HOUR]}, "11:00-13:30"),
        (
            "stops",
            "Window",
            "8.30-12; 14-16",
            {"windows": [[8.5 * HOUR, 12 * HOUR], [14 * HOUR, 16 * HOUR]]},
            "8:30-12:00; 14:00-16:00",
        ),
        ("stops", "Due", "28800", {"due": 28_800}, "8:00"),
        ("stops", "Due", "10-10:30", {"due": [10 * HOUR, 10.5 * HOUR]}, "10:00-10:30"),
        ("stops", "Urgency", "2,5", {"urgency": 2.5}, "2.5"),
        ("vehicles", "Count", "3", {"count": 3}, "3"),
        ("vehicles", "Shift", "8am-1pm", {"shift": [8 * HOUR, 13 * HOUR]}, "8:00-13:00"),
        ("vehicles", "Shift", "28800 to 12:00", {"shift": [8 * HOUR, 12 * HOUR]}, "8:00-12:00"),
        (
            "vehicles",
            "Breaks",
            "11:30-12:30 30 min",
            {"breaks": [{"window": [11.5 * HOUR, 12.5 * HOUR], "length": 30 * MINUTE}]},
            "11:30-12:30 30 min",
        ),
        ("vehicles", "Breaks", "12-13 30", {"breaks": [LUNCH]}, "12:00-13:00 30 min"),
        ("vehicles", "Longest route", "8 h", {"longest": 8 * HOUR}, "480 min"),
        ("vehicles", "Start", "depot", {"start": "depot"}, "depot"),
        ("vehicles", "Speed, %", "80 %", {"speed_factor": 0.8}, "80"),
        ("vehicles", "Time at stops, %", "125", {"service_factor": 1.25}, "125"),
        ("vehicles", "Price per km", "0,5", {"per_distance": 0.0005}, "0.5"),
        ("vehicles", "Price per hour", "36", {"per_time": 0.01}, "36"),
        ("vehicles", "Most distance, km", "90", {"max_distance": 90_000}, "90"),
        ("vehicles", "Most driving", "4:30", {"max_driving": 4.5 * HOUR}, "270 min"),
        ("vehicles", "Profile", "truck", {"profile": "truck"}, "truck"),
        ("stops", "Takes back", "2; 5", {"pickup": [2, 5]}, "2, 5"),
        (
            "stops",
            "Service by vehicle",
            "van: 10; cargo bike: 5 min",
            {
                "services": [
                    {"vehicle": "van", "service": 600},
                    {"vehicle": "cargo bike", "service": 300},
                ]
            },
            "van: 10 min; cargo bike: 5 min",
        ),
        ("vehicles", "Count", "", {}, ""),
    ],
)
def test_a_cell_is_read_as_people_write_it(
    node: Node, table: str, title: str, text: str, members: dict[str, Any], shown: str
) -> None:
    assert read(node, table, title, text)[:2] == [members, shown]


@pytest.mark.parametrize(
    ("table", "title", "text", "hint"),
    [
        ("vehicles", "Count", "0", "a whole number, 1 or more"),
        ("vehicles", "Count", "two", "a whole number, 1 or more"),
        ("vehicles", "Capacity", "-8", "a whole number such as 2"),
        ("vehicles", "Capacity", "big", "a whole number such as 2"),
        ("stops", "Demand", "2.5", "a whole number such as 2"),
        ("stops", "Latitude", "95", "a number, -90 to 90"),
        ("stops", "Longitude", "181", "a number, -180 to 180"),
        ("stops", "Window", "12:00-8:00", "two times in order"),
        ("stops", "Window", "tomorrow", "two times in order"),
        ("stops", "Window", "8:00-10:00; 9:00-12:00", "that neither overlap nor touch"),
        ("vehicles", "Shift", "8:00-12:00; 12:00-16:00", "that neither overlap nor touch"),
        ("stops", "Service", "-5", "how long it takes"),
        ("stops", "Service", "300", "as 5 min, 0:05 or 300 s"),  # seconds, or five hours
        ("vehicles", "Longest route", "8", "as 8 h, 480 min or 8:00"),
        ("stops", "Due", "8.5", "a time, as 10:30"),
        ("stops", "Due", "10:30-10:00", "or from when and until when"),
        ("vehicles", "Breaks", "12:00-13:00", "when it may begin and how long it takes"),
        ("vehicles", "Speed, %", "0", "a number of per cent"),
        ("stops", "Service by vehicle", "10 min", "how long it takes by some vehicles"),
        ("vehicles", "Start", "yard", None),
        ("vehicles", "End", "yard", None),
    ],
)
def test_a_cell_that_is_not_understood_keeps_its_text_and_says_what_to_write(
    node: Node, table: str, title: str, text: str, hint: str | None
) -> None:
    members, shown, said = read(node, table, title, text)
    assert (members, shown) == (None, text)
    assert hint is None or hint in said


def test_times_of_a_clock_that_is_none_are_numbers(node: Node) -> None:
    assert read(node, "stops", "Window", "8-12", second=0)[0] == {"window": [8, 12]}
    assert read(node, "stops", "Service", "300", second=0)[0] == {"service": 300}
    assert read(node, "stops", "Service", "5", second=60)[0] == {"service": 5}
    assert read(node, "stops", "Due", "x", second=0)[2] == "a number in the unit of the times"


@pytest.mark.parametrize(
    ("text", "hours"),
    [
        ("7:00 1, 7:30 x1,6; 9:30 1.1", [[7 * HOUR, 1], [7.5 * HOUR, 1.6], [9.5 * HOUR, 1.1]]),
        ("9:00 2", [[9 * HOUR, 2]]),
        ("", []),
        ("7:00 fast", None),
        ("9:00 1; 8:00 2", None),
        ("9:00 0", None),
        ("9:00 101", None),
    ],
)
def test_rush_hours_are_times_and_factors_in_order(
    node: Node, text: str, hours: list[list[float]] | None
) -> None:
    assert node.call("inputs/day.js", "hoursTyped", text) == hours


@pytest.mark.parametrize(
    ("text", "names", "meant"),
    [
        ("deopt", ["depot", "shop"], "depot"),
        ("SHOP", ["depot", "shop"], "shop"),
        ("yard", ["depot", "shop"], None),
        ("order-8", ["order-18", "bakery"], "order-18"),
    ],
)
def test_the_name_that_somebody_meant_is_found(
    node: Node, text: str, names: list[str], meant: str | None
) -> None:
    assert node.call("common/nearest.js", "nearest", text, names) == meant
