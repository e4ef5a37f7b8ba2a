"""Fleets edited on the page: tables of stops and vehicles, objectives, and stops on the map."""

import json
import re
from copy import deepcopy
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    curl_body,
    needs_chromium,
    open_files,
    shown_front,
    wait_until_planned,
)

pytestmark = needs_chromium

HOUR, MINUTE = 3600, 60
WINDOWS = [[8 * HOUR, 8.5 * HOUR], [10 * HOUR, 11 * HOUR]]
FLEET: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": [24.941, 60.171]},
        {"id": "order-17", "location": [24.952, 60.169]},
        {"id": "order-18", "location": [24.933, 60.165], "demand": [3]},
        {
            "id": "order-19",
            "location": [24.925, 60.18],
            "windows": [[28800, 30600], [36000, 39600]],
        },
    ],
    "vehicles": [
        {"id": "van", "count": 2, "start": 0, "end": "depot", "capacity": [8]},
        {"id": "bike", "start": "depot", "end": "depot", "capacity": [3]},
    ],
    "shipments": [{"pickup": "order-18", "delivery": "order-17"}],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": 30, "over": "max"},
    ],
    "clock": "time",
    "seed": 7,
    "time_limit": 0.05,
}


@pytest.fixture
def fleet(window: Page) -> Page:
    """The page with the fleet opened, and not planned."""
    window.get_by_role("button", name="Clear").click()
    expect(window.locator("#count")).to_have_text("0 stops")
    open_files(window, {"fleet.json": json.dumps(FLEET)})
    expect(window.locator("#brought")).to_have_text("A fleet: 3 vehicles and 4 stops.")
    return window


def cell(page: Page, name: str) -> Locator:
    """Return the cell of a table by its name, such as "Window of order-17"."""
    return page.get_by_label(name, exact=True)


def write(page: Page, name: str, text: str) -> None:
    """Write a text into a cell, and leave it."""
    cell(page, name).fill(text)
    cell(page, name).press("Tab")


def edited(**members: Any) -> dict[str, Any]:
    return {**deepcopy(FLEET), **members}


def plan(page: Page) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()


def test_cells_are_written_as_people_write_times_and_amounts(fleet: Page) -> None:
    """What the tables do not show, and what was not written, stays as it was."""
    expect(cell(fleet, "Window of order-19")).to_have_value("8:00-8:30; 10:00-11:00")
    expect(cell(fleet, "Start of van")).to_have_value("depot")
    write(fleet, "Demand of order-18", "1")
    write(fleet, "Window of order-17", "8:30-10:00")
    write(fleet, "Window of order-19", "")
    fleet.get_by_label("Add a column to the stops").select_option("Service")
    expect(cell(fleet, "Service of depot")).to_be_focused()
    write(fleet, "Service of order-17", "5 min")
    write(fleet, "Service of order-18", "0:05:30")
    write(fleet, "Count of van", "3")
    write(fleet, "Shift of bike", "28800 to 12:00")
    fleet.get_by_label("Add a column to the vehicles").select_option("Breaks")
    write(fleet, "Breaks of van", "11:30-12:30 30 min")
    expect(cell(fleet, "Shift of bike")).to_have_value("8:00-12:00")
    wanted = edited()
    first, second, third = wanted["stops"][1:]
    first |= {"window": [8.5 * HOUR, 10 * HOUR], "service": 5 * MINUTE}
    second |= {"demand": [1], "service": 330}
    del third["windows"]
    van, bike = wanted["vehicles"]
    van |= {"count": 3, "breaks": [{"window": [11.5 * HOUR, 12.5 * HOUR], "length": 30 * MINUTE}]}
    bike["shift"] = [8 * HOUR, 12 * HOUR]
    asked = curl_body(fleet, "fleet")
    assert {name: asked[name] for name in wanted} == wanted
    expect(fleet.locator("#brought")).to_have_text("A fleet: 4 vehicles and 4 stops.")


def test_new_names_are_taken_over_wherever_they_are_used(fleet: Page) -> None:
    fleet.get_by_label("Add a column to the stops").select_option("Served by")
    write(fleet, "Served by of order-19", "bike")
    write(fleet, "Name of vehicle 2", "cargo bike")
    write(fleet, "Name of stop 1", "yard")
    write(fleet, "Name of stop 2", "o17")
    asked = curl_body(fleet, "fleet")
    assert [(each["start"], each["end"]) for each in asked["vehicles"]] == [("yard", "yard")] * 2
    assert asked["shipments"] == [{"pickup": "order-18", "delivery": "o17"}]
    assert asked["stops"][3]["vehicle"] == "cargo bike"
    fleet.get_by_role("button", name="Delete order-18").click()
    assert [each["id"] for each in curl_body(fleet, "fleet")["stops"]] == [
        "yard",
        "o17",
        "order-19",
    ]


@pytest.mark.parametrize(
    ("name", "text", "said"),
    [
        (
            "Window of order-17",
            "tomorrow",
            "Window of order-17 cannot be “tomorrow”: write two times",
        ),
        ("Start of bike", "deopt", "the name of a stop, got “deopt”; did you mean depot?"),
    ],
)
def test_a_cell_that_cannot_be_planned_with_is_marked(
    fleet: Page, name: str, text: str, said: str
) -> None:
    write(fleet, name, text)
    faults = fleet.locator("#stops-fault, #vehicles-fault")
    if "cannot" in said:
        expect(faults.filter(has_text=said)).to_be_visible()
        expect(cell(fleet, name)).to_have_attribute("aria-invalid", "true")
    plan(fleet)
    expect(cell(fleet, name)).to_be_focused()
    expect(cell(fleet, name)).to_have_attribute("aria-invalid", "true")
    expect(faults.filter(has_text=said)).to_be_visible()
    expect(fleet.locator("#fleet")).to_be_hidden()


def test_objectives_are_chosen_from_a_list(fleet: Page) -> None:
    against = fleet.get_by_label("First objective against")
    expect(against).to_have_value("max")
    against.select_option("Vehicles used")
    asked = curl_body(fleet, "fleet")
    assert asked["objectives"][1] == {"name": "vehicles", "measure": "vehicles"}
    assert asked["clock"] == {"name": "time", "from": "great_circle", "speed": 30}
    against.select_option("Lateness")
    plan(fleet)
    expect(fleet.locator("#objectives-fault")).to_contain_text("needs stops that are due")
    write(fleet, "Due of order-17", "9:15")
    plan(fleet)
    wait_until_planned(fleet)
    assert shown_front(fleet)["objectives"][1]["measure"] == "lateness"
    against.select_option("Longest route")
    asked = curl_body(fleet, "fleet")
    assert asked["objectives"][1] == {
        **{"name": "longest route", "over": "max"},
        **{"from": "great_circle", "speed": 30},
    }
    assert asked["clock"] == "longest route"


def test_late_visits_are_traded_where_times_vary_from_day_to_day(fleet: Page) -> None:
    fleet.get_by_label("First objective against").select_option("Late visits")
    varies = fleet.get_by_label("Times vary from day to day by, %")
    expect(varies).to_have_value("20")
    varies.fill("a lot")
    varies.press("Tab")
    said = "Times must vary by 0 to 1000 %, as 20, got \N{LEFT DOUBLE QUOTATION MARK}a lot"
    expect(fleet.locator("#spread-fault")).to_contain_text(said)
    varies.fill("30 %")
    varies.press("Tab")
    expect(fleet.locator("#spread-fault")).to_be_empty()
    asked = curl_body(fleet, "fleet")
    late = {"name": "late visits", "measure": "on_time"}
    assert (asked["clock"]["spread"], asked["objectives"][1]) == (0.3, late)
    plan(fleet)
    wait_until_planned(fleet)
    sentence = (
        r"On an average day, [\d.]+ % of the visits with a window or a due time are on time\."
    )
    expect(fleet.locator("#choice")).to_contain_text(re.compile(sentence))
    expect(fleet.get_by_role("row", name=re.compile("^Visits on time, %"))).to_be_visible()


def test_a_third_objective_is_chosen_from_a_list_and_planned(fleet: Page) -> None:
    third = fleet.get_by_label("and against", exact=True)
    expect(third).to_have_value("")
    third.select_option("Vehicles used")
    assert curl_body(fleet, "fleet")["objectives"][2] == {"name": "vehicles", "measure": "vehicles"}
    plan(fleet)
    wait_until_planned(fleet)
    expect(fleet.locator("#several")).to_be_visible()
    front = shown_front(fleet)
    assert [len(each["lengths"]) for each in front["front"]] == [3] * len(front["front"])
    # What is the second objective now can no longer be the third.
    fleet.get_by_label("First objective against").select_option("Vehicles used")
    assert len(curl_body(fleet, "fleet")["objectives"]) == 2
    third.select_option("Load carried")
    assert curl_body(fleet, "fleet")["objectives"][2]["measure"] == "load_distance"
    third.select_option("nothing else")
    assert len(curl_body(fleet, "fleet")["objectives"]) == 2


def test_a_clock_in_metres_is_not_taken_in_silence(fleet: Page) -> None:
    fleet.get_by_label("What the second objective is measured by").select_option(
        "Straight lines, m"
    )
    expect(fleet.locator("#objectives-fault")).to_contain_text("Times are measured in metres")
    times = fleet.get_by_label("Windows, shifts and service are")
    times.select_option("There are no times")
    expect(fleet.locator("#objectives-fault")).to_be_empty()
    plan(fleet)
    expect(fleet.locator("#stops-fault")).to_contain_text("Window of order-19 needs times")
    fleet.get_by_label("Windows, shifts and service are").select_option(
        "Those of the second objective"
    )
    assert curl_body(fleet, "fleet")["objectives"][1]["speed"] == 30


def test_stops_and_vehicles_are_added_and_moved(fleet: Page) -> None:
    fleet.locator("form").get_by_role("button", name="Add", exact=True).first.click()
    expect(cell(fleet, "Name of stop 5")).to_be_focused()
    fleet.locator("#add-vehicle").click()
    expect(cell(fleet, "Name of vehicle 3")).to_be_focused()
    board = fleet.locator("#plane-1")
    board.press("Enter")
    board.press("ArrowRight")
    asked = curl_body(fleet, "fleet")
    assert [len(asked[each]) for each in ("stops", "vehicles")] == [5, 3]
    east, _ = asked["stops"][0]["location"]
    assert east > FLEET["stops"][0]["location"][0]
    plan(fleet)
    wait_until_planned(fleet)
    expect(fleet.locator("#fleet")).to_be_visible()
    check_on_a_phone(fleet, "#request")


def test_a_chosen_stop_is_served_by_another_vehicle_and_planned_again(fleet: Page) -> None:
    plan(fleet)
    wait_until_planned(fleet)
    expect(fleet.get_by_label("Serve it by")).to_be_hidden()
    fleet.locator("#fleet-lanes").get_by_role("button", name="order-19").first.click()
    fleet.get_by_label("Serve it by").select_option("bike")
    expect(cell(fleet, "Served by of order-19")).to_have_value("bike")
    expect(fleet.locator("#fleet")).to_be_visible()
    wait_until_planned(fleet)
    routes = [route for each in shown_front(fleet)["front"] for route in each["routes"]]
    assert {each["vehicle"] for each in routes if "order-19" in each["stops"]} == {"bike"}
    expect(fleet.get_by_label("Serve it by")).to_have_value("bike")
    expect(fleet.locator("#fleet-stop")).to_contain_text("bike arrives")
