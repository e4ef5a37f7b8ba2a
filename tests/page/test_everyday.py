"""What every dispatcher has, asked once: a depot, minutes at the stops, shifts and a speed."""

from typing import Any

import pytest

from tests.helpers.node import Node

HOUR = 3600
EIGHT_TO_FOUR = [8 * HOUR, 16 * HOUR]
YARD = [24.93, 60.17]
ORDERS = [
    {"id": "A", "location": [24.94, 60.17], "demand": [2]},
    {"id": "B", "location": [24.95, 60.18], "demand": [3]},
]
METRES: dict[str, Any] = {
    "stops": ORDERS,
    "vehicles": [{"id": "Pekka"}, {"id": "Anna"}],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "longest route", "from": "great_circle", "over": "max"},
    ],
    "details": [{"column": "Customer", "texts": ["Bo", "Cy"]}],
}
FLEET: dict[str, Any] = {
    **METRES,
    "objectives": [METRES["objectives"][0], {**METRES["objectives"][1], "speed": 30}],
    "clock": "longest route",
}
HOME = {"start": "depot", "end": "depot"}
NOTHING = (
    "No depot is given: vehicles start and end at any stop. No time at the stops is given: 0 min."
    " No shifts are given: vehicles set off at any time of the day."
)
EVERYDAY = """async ([asked, steps]) => {
  const everyday = await import("./page/fleet/everyday.js");
  const end = steps.reduce((before, [name, given]) => everyday[name](before, given), asked);
  const known = everyday.everydayIn(end);
  return [end, known, everyday.missingSaid(known)];
}"""
RECALLED = """async ([asked, known]) =>
  (await import("./page/fleet/everyday.js")).recalled(asked, known)"""


def given(node: Node, asked: dict[str, Any], *steps: tuple[str, Any]) -> Any:
    """Return the request after these changes, what it gives, and what is said of the rest."""
    return node.evaluate(EVERYDAY, [asked, steps])


def test_what_is_missing_is_said_in_one_line(node: Node) -> None:
    assert given(node, FLEET)[2] == NOTHING
    steps = ("withDepot", {"location": YARD}), ("withService", 480), ("withShift", EIGHT_TO_FOUR)
    asked, known, said = given(node, FLEET, *steps)
    assert said == ""
    assert known["depot"] == "depot"
    assert (known["service"], known["shift"], known["speed"]) == (480, EIGHT_TO_FOUR, 30)
    assert asked["stops"] == [
        *({**order, "service": 480} for order in ORDERS),
        {"id": "depot", "location": YARD},
    ]
    assert asked["details"] == [{"column": "Customer", "texts": ["Bo", "Cy", ""]}]
    assert asked["vehicles"] == [
        {"id": name, **HOME, "shift": EIGHT_TO_FOUR} for name in ("Pekka", "Anna")
    ]
    some = {**FLEET, "stops": [{**ORDERS[0], "service": 60}, ORDERS[1]]}
    assert "1 of the stops: 0 min." in given(node, some)[2]


def test_times_are_filled_in_where_there_are_none_and_changed_where_all_are_alike(
    node: Node,
) -> None:
    def services(asked: dict[str, Any], *seconds: int | None) -> list[Any]:
        steps = [("withService", each) for each in seconds]
        return [stop.get("service") for stop in given(node, asked, *steps)[0]["stops"]]

    assert services(FLEET, 480, 600) == [600, 600]
    assert services(FLEET, 480, None) == [None, None]
    some = {**FLEET, "stops": [{**ORDERS[0], "service": 60}, ORDERS[1]]}
    assert services(some, 480) == services(some, 480, 600) == [60, 480]
    one = {**FLEET, "vehicles": [{"id": "Pekka", "shift": [0, 9]}, {"id": "Anna"}]}
    vehicles = given(node, one, ("withShift", EIGHT_TO_FOUR))[0]["vehicles"]
    assert [each["shift"] for each in vehicles] == [[0, 9], EIGHT_TO_FOUR]


def test_a_fleet_without_times_has_some_once_they_are_asked_for(node: Node) -> None:
    asked, known, _ = given(node, METRES, ("withService", 480), ("withSpeed", 20))
    assert asked["clock"] == "longest route"
    assert asked["objectives"][1]["speed"] == known["speed"] == 20
    traded = {
        **METRES,
        "objectives": [METRES["objectives"][0], {"name": "v", "measure": "vehicles"}],
    }
    asked, *_ = given(node, traded, ("withShift", EIGHT_TO_FOUR))
    assert asked["clock"] == {"name": "time", "from": "great_circle", "speed": 30}


def test_vehicles_leave_early_or_late_and_with_time_in_hand(node: Node) -> None:
    minutes = {**FLEET, "clock": {"unit": "min", "from": "road_time"}}
    asked, known, said = given(node, minutes, ("withLeave", "early"), ("withSlack", 900))
    assert (asked["leave"], asked["slack"]) == ("early", 15)
    assert (known["leave"], known["slack"]) == ("early", 900)
    assert "vehicles set off at midnight." in said
    assert given(node, asked, ("withLeave", "late"), ("withSlack", None))[0] == minutes
    assert given(node, METRES, ("withSlack", 900))[0]["clock"] == "longest route"


RUSH = """async ([asked, hours]) => {
  const { canHaveDay, changingOver, hoursIn } = await import("./page/inputs/day.js");
  const changed = changingOver(asked, hours);
  return [canHaveDay(asked), changed, hoursIn(changed)];
}"""


def test_rush_hours_of_a_fleet_are_of_all_that_its_clock_measures(node: Node) -> None:
    straight, hours = {"from": "great_circle", "speed": 20}, [[25200, 1.8], [32400, 1.1]]
    timed = [{"name": "driving", **straight}, {"name": "longest", **straight, "over": "max"}]
    asked = {**FLEET, "objectives": timed, "clock": "driving"}
    can, changed, known = node.evaluate(RUSH, [asked, hours])
    assert (can, known) == (True, hours)
    assert changed == {**asked, "objectives": [{**each, "over_the_day": hours} for each in timed]}
    metres = {"name": "distance", "from": "great_circle"}
    own = {**asked, "objectives": [metres, {"name": "vehicles", "measure": "vehicles"}]}
    own["clock"] = {"name": "time", **straight}
    can, changed, known = node.evaluate(RUSH, [own, hours])
    assert (can, known) == (True, hours)
    assert changed == {**own, "clock": {**own["clock"], "over_the_day": hours}}
    assert node.evaluate(RUSH, [changed, []])[1] == own
    assert node.evaluate(RUSH, [{**asked, "clock": None}, []])[0] is False


def test_a_depot_is_a_row_or_a_place_and_moves_with_its_vehicles(node: Node) -> None:
    rows = {**FLEET, "stops": [{"id": "yard", "location": YARD, "service": 60}, *ORDERS]}
    asked, *_ = given(node, rows, ("withDepotAt", "yard"))
    assert asked["stops"] == [{"id": "yard", "location": YARD}, *ORDERS]
    assert [each["start"] for each in asked["vehicles"]] == ["yard", "yard"]
    # An order stays one that is visited: a depot is added beside it.
    asked, *_ = given(node, rows, ("withDepotAt", "A"))
    assert asked["stops"][-1] == {"id": "depot", "location": ORDERS[0]["location"]}
    # Another click moves it, and another row takes its place.
    steps = [("withDepot", {"location": YARD}), ("withDepot", {"location": [25, 60]})]
    asked, *_ = given(node, FLEET, *steps)
    assert asked["stops"] == [*ORDERS, {"id": "depot", "location": [25, 60]}]
    asked, *_ = given(node, rows, *steps, ("withDepotAt", "yard"))
    assert [stop["id"] for stop in asked["stops"]] == ["yard", "A", "B"]
    # Where vehicles load again moves as well.
    asked, *_ = given(node, rows, steps[0], ("withReload", True), ("withDepotAt", "yard"))
    assert [each["reload"] for each in asked["vehicles"]] == [["yard"], ["yard"]]
    asked, *_ = given(node, asked, ("withReload", False))
    assert asked["vehicles"][0] == {"id": "Pekka", "start": "yard", "end": "yard"}
    # What a vehicle says itself stays.
    own = {**FLEET, "vehicles": [{"id": "Pekka", "start": "A", "end": None}, {"id": "Anna"}]}
    asked, known, _ = given(node, own, ("withDepot", {"location": YARD}))
    assert asked["vehicles"] == [own["vehicles"][0], {"id": "Anna", **HOME}]
    assert "depot" not in known  # they differ


REMEMBERED = {
    "depot": {"id": "depot", "location": YARD},
    "service": 480,
    "shift": EIGHT_TO_FOUR,
    "speed": 25,
    "reload": True,
    "leave": "early",
    "slack": 600,
}
SAID = [
    "the depot",
    "vehicles load again there",
    "8 min at each stop",
    "shifts from 8:00 to 16:00",
    "10 min to spare before a window closes",
    "vehicles set off as early as possible",
    "25 km/h",
]


@pytest.mark.parametrize(
    ("asked", "known", "said"),
    [
        (FLEET, REMEMBERED, SAID),
        (FLEET, {"service": 480}, SAID[2:3]),
        (FLEET, {}, []),
        ({**FLEET, "slack": 60, "leave": "early"}, {**REMEMBERED}, SAID[:4] + SAID[6:]),
        # What the file gives stays; and another city has another depot.
        (
            {**FLEET, "vehicles": [{"id": "Pekka", "shift": [0, 9]}]},
            REMEMBERED,
            SAID[:3] + SAID[4:],
        ),
        (FLEET, {"depot": {"id": "depot", "location": [13.4, 52.5]}}, []),
        ({**FLEET, "stops": [{"id": "A"}]}, REMEMBERED, []),
    ],
)
def test_what_is_remembered_fills_in_what_a_file_does_not_give(
    node: Node, asked: dict[str, Any], known: dict[str, Any], said: list[str]
) -> None:
    found = node.evaluate(RECALLED, [asked, known])
    assert found["said"] == said
    if said == SAID:
        assert found["asked"]["stops"][-1] == {"id": "depot", "location": YARD}
        assert "service" not in found["asked"]["stops"][-1]


@pytest.mark.parametrize(
    ("text", "room", "cells"),
    [
        ("8-12\n9-12\n", 3, [["8-12"], ["9-12"]]),
        ("5\tfrost\r\n7\tlift", 2, [["5", "frost"], ["7", "lift"]]),
        ("2, 5\n3, 1", 1, [["2, 5"], ["3, 1"]]),
        ("a\tb", 2, [["a", "b"]]),
        ("8-12", 3, None),  # one cell is the browser's
        ("id\tlon\tlat\nA\t1\t2", 2, None),  # wider than the table from there: it is a file
        ("id,lon,lat\nA,24.9,60.1", 3, None),
        ('{"stops":\n[]}', 3, None),
    ],
)
def test_pasted_cells_fill_cells_and_a_pasted_table_is_opened(
    node: Node, text: str, room: int, cells: list[list[str]] | None
) -> None:
    assert node.call("inputs/filling.js", "blockOf", text, room) == cells
