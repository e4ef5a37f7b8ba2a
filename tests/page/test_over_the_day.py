"""Tours over the day on the page: departures, rush hours, the hours of stops, replanning."""

import csv
import io
import json
import re
from typing import Any

from playwright.sync_api import Page, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    curl_body,
    needs_chromium,
    open_files,
    saved,
    wait_until_planned,
)

pytestmark = needs_chromium

HOUR, MINUTE = 3600, 60
REQUEST: dict[str, Any] = {
    "stops": [
        {"id": f"order-{k}", "location": [24.93 + k % 3 / 100, 60.16 + k % 4 / 100]}
        for k in range(7)
    ],
    "objectives": [
        {"name": "way", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": 30},
    ],
    "time_limit": 0.1,
}
HOURS = [[7.0 * HOUR, 1], [7.5 * HOUR, 1.6], [9.5 * HOUR, 1.1]]


def opened(page: Page, **members: Any) -> Page:
    """The page with stops opened, and nothing planned."""
    page.get_by_role("button", name="Clear").click()
    expect(page.locator("#count")).to_have_text("0 stops")
    open_files(page, {"stops.json": json.dumps({**REQUEST, **members})})
    expect(page.locator("#count")).to_have_text("7 stops")
    return page


def write(page: Page, label: str, text: str) -> None:
    """Write a text into a field by its label, and leave it."""
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Tab")


def asked(page: Page) -> dict[str, Any]:
    """The request that the page would send."""
    body = curl_body(page)
    return {
        "departure": body.get("departure"),
        "hours": [each.get("over_the_day") for each in body["objectives"]],
    }


def test_the_hours_of_a_tour_stand_beside_its_stops_and_in_files(window: Page) -> None:
    window.get_by_label("Example").select_option("Helsinki, rush hour")
    wait_until_planned(window)
    body = curl_body(window)
    assert body["departure"] == {"earliest": 25200, "latest": 30600}
    assert body["stops"][1]["service"] == 45
    assert len(body["objectives"][0]["over_the_day"]) == 5
    hours = window.locator("#comparison")
    expect(hours).to_contain_text(re.compile(r"Leaves at\s*[78]:\d\d"))
    window.locator("#order > summary").click()
    order = window.locator("#order li")
    expect(order).to_have_count(len(body["stops"]) + 1)
    expect(order.first).to_have_text(re.compile(r"^depot [78]:\d\d$"))
    expect(order.last).to_have_text(re.compile(r"^depot (9|10):\d\d$"))
    rows = list(csv.DictReader(io.StringIO(saved(window, "CSV").decode())))
    assert all(25200 <= float(row["departure"]) <= 30600 for row in rows)
    chart = window.get_by_role("img", name=re.compile("^Times of travel over the day"))
    expect(chart).to_contain_text("1.9")
    check_on_a_phone(window, "#request")


def test_stops_get_rush_hours_and_a_departure_by_typing(window: Page) -> None:
    page = opened(window)
    page.get_by_text("Time of day", exact=True).click()
    expect(page.get_by_label("Leaves at the earliest")).to_be_hidden()
    write(page, "Rush hours", "7:00 1, 7:30 x1,6; 9:30 1.1")
    assert asked(page) == {"departure": 7 * HOUR, "hours": [None, HOURS]}
    write(page, "to", "8:30")
    assert asked(page)["departure"] == {"earliest": 7 * HOUR, "latest": 8.5 * HOUR}
    write(page, "Leaves at, or from", "9:15")  # which takes the other one along
    assert asked(page)["departure"] == 9.25 * HOUR
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    expect(page.locator("#comparison")).to_contain_text(re.compile(r"Leaves at\s*9:15"))
    write(page, "Rush hours", "")
    write(page, "Leaves at, or from", "")
    assert asked(page) == {"departure": None, "hours": [None, None]}


def test_sliders_choose_when_tours_may_leave(window: Page) -> None:
    objectives = [REQUEST["objectives"][0], {**REQUEST["objectives"][1], "over_the_day": HOURS}]
    page = opened(window, objectives=objectives, departure=7 * HOUR)
    latest = page.get_by_label("Leaves at the latest")
    latest.press("ArrowRight")
    assert asked(page)["departure"] == {"earliest": 7 * HOUR, "latest": 7 * HOUR + 5 * MINUTE}
    expect(page.get_by_label("to", exact=True)).to_have_value("7:05")
    expect(latest).to_have_attribute("aria-valuetext", "7:05")
    page.get_by_label("Leaves at the earliest").press("PageUp")
    departure = asked(page)["departure"]
    assert isinstance(departure, int)  # both ends are where the first one is
    assert departure > 7 * HOUR + 5 * MINUTE


def test_rush_hours_that_are_not_understood_are_said_until_they_are(window: Page) -> None:
    page, text = opened(window, departure=7 * HOUR), "9:00 1; 8:00 2"
    write(page, "Rush hours", text)
    said = page.locator("#hours-fault")
    expect(said).to_contain_text("Rush hours must be times and factors in order, as 7:00 1;")
    page.get_by_role("button", name="Copy as curl").click()
    not_copied = "Mend this first, to copy it: Rush hours must be times and factors in order"
    expect(page.locator("#link-help")).to_contain_text(not_copied)
    write(page, "Latitude of order-1", "60.2")  # another edit
    expect(said).to_contain_text("Rush hours must be")
    expect(page.get_by_label("Rush hours")).to_have_value(text)
    write(page, "Rush hours", "9:00 2")
    expect(said).to_be_empty()
    assert asked(page) == {"departure": 7 * HOUR, "hours": [None, [[9 * HOUR, 2]]]}


def test_a_slider_takes_the_place_of_a_time_that_is_not_understood(window: Page) -> None:
    page = opened(window, departure=7 * HOUR)
    write(page, "Leaves at, or from", "soon")
    expect(page.locator("#departure-fault")).to_contain_text("Leaves at must be a time")
    page.get_by_label("Leaves at the latest").press("ArrowRight")
    expect(page.get_by_label("Leaves at, or from")).to_have_value("7:00")
    expect(page.locator("#departure-fault")).to_be_empty()


def test_visits_that_take_time_need_a_departure(window: Page) -> None:
    stops = [{**stop, "service": 60} for stop in REQUEST["stops"]]
    page = opened(window, stops=stops)
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#departure-fault")).to_contain_text("Say when tours leave")
    expect(page.get_by_label("Leaves at, or from")).to_be_focused()


def test_matrices_of_slices_are_drawn_and_stay_with_their_stops(window: Page) -> None:
    def matrix(cost: float) -> list[list[float]]:
        return [[cost] * 7 for _ in range(7)]

    slices = [{"from": 7 * HOUR, "matrix": matrix(2)}, {"from": 8 * HOUR, "matrix": matrix(3)}]
    objectives = [REQUEST["objectives"][0], {"name": "time", "unit": "s", "slices": slices}]
    page = opened(window, objectives=objectives, departure=7 * HOUR)
    expect(page.get_by_role("img", name="Times of travel over the day")).to_contain_text("1.5")
    expect(page.get_by_label("Rush hours")).to_be_disabled()
    page.get_by_label("Delete order-3").click()
    sent = curl_body(page)["objectives"][1]["slices"]
    assert [len(each["matrix"]) for each in sent] == [6, 6]


def test_the_rest_is_planned_from_the_time_at_which_the_vehicle_is_there(window: Page) -> None:
    stops = [{**stop, "service": 60} for stop in REQUEST["stops"]]
    page = opened(window, stops=stops, departure=7 * HOUR)
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    page.locator("#replanning > summary").click()
    write(page, "Visited up to", "order-0")
    page.get_by_role("button", name="Replan", exact=True).click()
    hours = page.locator("#comparison")
    expect(hours).to_contain_text(re.compile(r"Leaves at\s*7:01"))  # after the visit
    now = page.locator("#now")
    now.fill("later")
    page.get_by_role("button", name="Replan", exact=True).click()
    expect(page.locator("#replan-fault")).to_contain_text("The time now must be as 8:15")
    expect(now).to_be_focused()
    expect(now).to_have_attribute("aria-invalid", "true")
    expect(hours).to_contain_text(re.compile(r"Leaves at\s*7:01"))
    now.fill("10:20")
    page.get_by_role("button", name="Replan", exact=True).click()
    expect(hours).to_contain_text(re.compile(r"Leaves at\s*10:20"))
