"""Stops and objectives on the page: CSV, a table that can be typed in, names and units."""

import csv
import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    FREE,
    SETTINGS,
    curl_body,
    know,
    needs_chromium,
    open_files,
    open_page,
    open_unplanned,
    saved,
    show_unplanned,
    stops_as_text,
    wait_until_planned,
)

pytestmark = needs_chromium

PLANES = "name,x,y,u,v\ndepot,0,0,5,5\nshop,3,1,9,1\nschool,5,2,2,8\n"


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all of these tests, each of which opens its own stops."""
    with open_unplanned(browser, released) as page:
        yield page


LOCATED = [[24.94, 60.17], [24.95, 60.18], [24.93, 60.16]]


@pytest.mark.parametrize(
    "text",
    [
        "id,lon,lat\ndepot,24.94,60.17\na,24.95,60.18\nb,24.93,60.16\n",
        "Latitude;ID;Longitude\n60,17;depot;24,94\n60,18;a;24,95\n60,16;b;24,93\n",
        "name\tlng\tlat\ndepot\t24.94\t60.17\na\t24.95\t60.18\nb\t24.93\t60.16\n",
        '"id","lat","lon","note"\n"depot",60.17,24.94,"1, north"\na,60.18,24.95,\nb,60.16,24.93,',
    ],
    ids=["commas", "semicolons", "tabs", "quotation marks"],
)
def test_tables_with_longitude_and_latitude_are_stops(opened: Page, text: str) -> None:
    open_files(opened, {"stops.csv": text})
    expect(opened.locator("#count")).to_have_text("3 stops")
    body = curl_body(opened)
    assert [stop["id"] for stop in body["stops"]] == ["depot", "a", "b"]
    assert [stop["location"] for stop in body["stops"]] == LOCATED
    assert [each["from"] for each in body["objectives"]] == ["great_circle", "great_circle"]


def test_a_column_of_numbers_says_what_a_metre_costs(opened: Page) -> None:
    rows = "id,lon,lat,risk\na,0,0,2\nb,1,0,4\nc,0,1,0\n"
    open_files(opened, {"stops.csv": rows})
    expect(opened.get_by_label("Second objective", exact=True)).to_have_value("risk")
    costs = curl_body(opened)["objectives"][1]["matrix"]
    degree = 6371008.8 * 3.141592653589793 / 180
    assert costs[0][1] == pytest.approx(3 * degree, rel=1e-6)
    assert costs[2][0] == pytest.approx(degree, rel=1e-6)


MATRICES: list[list[list[float]]] = [
    [[0, 1, 2], [3, 0, 4], [5, 6, 0]],
    [[0, 9, 8], [7, 0, 6], [5, 4, 0]],
]


def test_two_tables_are_planes_or_costs(opened: Page) -> None:
    one, other = ("\n".join(",".join(map(str, row)) for row in costs) for costs in MATRICES)
    open_files(opened, {"a.csv": one, "b.csv": other})
    expect(opened.get_by_text("Two matrices of 3 stops.")).to_be_visible()
    assert curl_body(opened)["matrices"] == MATRICES
    open_files(opened, {"a.csv": "x,y\n1,2\n3,4\n5,6", "b.csv": "1;2\n3,5;4\n5;6"})
    expect(opened.locator("#count")).to_have_text("3 stops")
    assert curl_body(opened)["coordinates"] == [[1, 2, 1, 2], [3, 4, 3.5, 4], [5, 6, 5, 6]]
    open_files(opened, {"b.csv": other, "a.csv": "lon,lat\n0,0\n1,0\n0,1"})
    expect(opened.get_by_label("Second objective", exact=True)).to_have_value("b")
    assert curl_body(opened)["objectives"][1]["matrix"] == MATRICES[1]
    open_files(opened, {"b.csv": other, "a.csv": "lon,lat\n0,0\n1,0"})
    expect(opened.locator("#file-fault")).to_contain_text("got 2 of a.csv and 3 of b.csv")


def test_the_table_renames_moves_adds_and_deletes_stops(opened: Page) -> None:
    open_files(opened, {"stops.csv": PLANES})
    table = opened.locator("#stops")
    assert "coordinates" not in curl_body(opened)
    expect(stops_as_text(opened)).to_have_value("0, 0, 5, 5\n3, 1, 9, 1\n5, 2, 2, 8")
    commit(opened, "Name of stop 2", "market")
    commit(opened, "x₁ of market", "3,5")
    table.get_by_role("button", name="Delete school").click()
    opened.get_by_role("button", name="Add", exact=True).click()
    expect(opened.get_by_label("Name of stop 3")).to_be_focused()
    body = curl_body(opened)
    assert [stop["id"] for stop in body["stops"]] == ["depot", "market", "3"]
    assert body["objectives"][0]["coordinates"] == [[0, 0], [3.5, 1], [1.75, 0.5]]
    assert body["start"] == "depot"


def test_stops_with_costs_keep_them_when_one_is_deleted(opened: Page) -> None:
    request = {
        "stops": [
            {"id": name, "location": place} for name, place in zip("abc", LOCATED, strict=True)
        ],
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "risk", "matrix": MATRICES[0]},
        ],
    }
    open_files(opened, {"stops.json": json.dumps(request)})
    expect(opened.get_by_role("button", name="Add", exact=True)).to_be_disabled()
    opened.get_by_role("button", name="Delete a").click()
    body = curl_body(opened)
    assert body["objectives"][1]["matrix"] == [[0, 4], [6, 0]]
    measure = opened.get_by_label("What the second objective is measured by")
    measure.select_option("Straight lines, m")
    assert curl_body(opened)["objectives"][1] == {"name": "risk", "from": "great_circle"}


def test_both_objectives_have_names_and_units_of_the_user(opened: Page) -> None:
    open_files(
        opened,
        {
            "stops.csv": PLANES.replace("name,", "")
            .replace("depot,", "")
            .replace("shop,", "")
            .replace("school,", "")
        },
    )
    assert "coordinates" in curl_body(opened)
    commit(opened, "First objective", "way")
    commit(opened, "Unit of the first objective", "km")
    commit(opened, "Second objective", "noise")
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#comparison")).to_contain_text("Way, km")
    expect(opened.locator("#less-2")).to_have_text("less noise")
    head = next(csv.reader(saved(opened, "CSV").decode().splitlines()))
    assert head == ["angle", "way (km)", "noise", "tour", "selected"]


def test_roads_that_the_service_has_not_are_refused_at_their_objective(opened: Page) -> None:
    objectives = [{"name": "way", "from": "great_circle"}, {"name": "time", "from": "road_time"}]
    stops = [{"id": "a", "location": [0, 0]}, {"id": "b", "location": [1, 0]}]
    open_files(opened, {"stops.json": json.dumps({"stops": stops, "objectives": objectives})})
    source: Any = opened.get_by_label("What the second objective is measured by")
    expect(source).to_have_value("road_time")
    opened.get_by_role("button", name="Plan", exact=True).click()
    expect(opened.locator("#objectives-fault")).to_contain_text("routing engine")
    expect(source).to_be_focused()


def test_straight_lines_are_times_at_a_speed_that_is_typed(opened: Page) -> None:
    open_files(opened, {"stops.csv": "id,lon,lat,risk\na,0,0,2\nb,1,0,4\nc,0,1,0\n"})
    speed = opened.get_by_label("Speed of the first objective, km/h", exact=True)
    expect(speed).to_be_hidden()
    measure = opened.get_by_label("What the first objective is measured by")
    measure.select_option("Time in straight lines, s")
    expect(speed).to_have_value("30")
    timed = {"name": "distance", "from": "great_circle", "speed": 30}
    assert curl_body(opened)["objectives"][0] == timed
    commit(opened, speed.get_attribute("aria-label") or "", "0")
    opened.get_by_role("button", name="Plan", exact=True).click()
    fault = opened.locator("#objectives-fault")
    expect(fault).to_have_text("The speed of the first objective must be at least 0.001, got 0.")
    expect(speed).to_be_focused()
    commit(opened, "Speed of the first objective, km/h", "4,5")
    assert curl_body(opened)["objectives"][0] == {**timed, "speed": 4.5}
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#comparison")).to_contain_text(re.compile(r"Distance\d+ (min|h)"))
    measure.select_option("Straight lines, m")
    expect(speed).to_be_hidden()
    assert curl_body(opened)["objectives"][0] == {"name": "distance", "from": "great_circle"}
    request = {
        "stops": [{"id": f"{i}", "location": place} for i, place in enumerate(LOCATED)],
        "objectives": [timed, {"name": "risk", "matrix": MATRICES[0]}],
    }
    open_files(opened, {"stops.json": json.dumps(request)})
    expect(measure).to_have_value("speed")
    expect(speed).to_have_value("30")


def test_places_alone_are_measured_by_road_where_the_service_has_roads(
    browser: Browser, released: str
) -> None:
    told = {"tiles": None, "credit": "", "roads": True, "seconds": 60}
    with open_page(browser, released + FREE) as page:
        know(page, {SETTINGS: told})
        show_unplanned(page, released)
        open_files(page, {"stops.csv": "lon,lat\n0,0\n1,0\n0,1"})
        expect(page.locator("#file-notes")).to_contain_text("time by road")
        assert curl_body(page)["objectives"][1] == {"name": "time", "from": "road_time"}


def commit(page: Page, label: str, text: str) -> None:
    """Type into a field, and leave it."""
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Tab")


def test_a_cell_shows_a_tenth_of_a_metre_and_is_sent_in_full(opened: Page) -> None:
    longitude = 24.919999999999998
    text = f"id,lat,lon,demand\ndepot,60.1,24.9,0\na,60.2,{longitude},3\nb,60.3,25,3\n"
    for table, path in ((text, "fleet"), (text.replace(",demand", ",risk"), "front")):
        open_files(opened, {"orders.csv": table})
        expect(opened.get_by_label("Longitude of a", exact=True)).to_have_value("24.92")
        assert curl_body(opened, path)["stops"][1]["location"][0] == longitude
