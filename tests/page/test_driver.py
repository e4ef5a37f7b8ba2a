"""The selected tour or plan for those who drive it: rows of stops, GPX, and a list to print."""

import csv
import io
import json
import re
from typing import Any
from xml.etree import ElementTree

from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    needs_chromium,
    open_files,
    shown_front,
    wait_until_planned,
)

pytestmark = needs_chromium

GPX = "{http://www.topografix.com/GPX/1/1}"
FLEET = """id,lat,lon,qty,from,to,vehicle
depot,60.17,24.94,0,,,
"A, at the back",60.18,24.95,3,09:00,10:30,van 1
B,60.16,24.93,2,,,van 2
C,60.15,24.92,1,,,van 2
"""


def planned(page: Page, files: dict[str, str]) -> dict[str, Any]:
    """Open and plan files; return the front."""
    open_files(page, files)
    page.get_by_label("Seconds of planning").fill("0.05")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    front: dict[str, Any] = shown_front(page)
    return front


def given(page: Page, name: str) -> str:
    """Return the text of the file that a button saves."""
    with page.expect_download() as download:
        page.get_by_role("button", name=name).click()
    return download.value.path().read_text()


def check_sheets(window: Page) -> None:
    """Check that each vehicle has a page, with title, date and totals."""
    window.evaluate("window.print = () => {}")
    window.get_by_role("button", name="Print the stops of the selected tour").click()
    sheet = window.locator("#sheet")
    expect(sheet).to_be_hidden()
    window.emulate_media(media="print")
    expect(sheet).to_be_visible()
    expect(window.locator("main")).to_be_hidden()
    expect(sheet.get_by_role("heading", level=2)).to_have_text(["van 1", "van 2"])
    expect(sheet.get_by_role("heading", level=1)).to_have_text(["orders.csv", "orders.csv"])
    for at, part in enumerate(sheet.locator("section").all()):
        expect(part.locator("header p")).to_have_text(
            re.compile(r"^Printed on .*, \d{4} at \d\d:\d\d\. 2 vehicles, ")
        )
        expect(part.locator("p").nth(1)).to_contain_text(re.compile(r"^\d stops?, load \d"))
        assert part.evaluate("part => getComputedStyle(part).breakBefore") == (
            "page" if at else "auto"
        )
    assert sheet.get_by_text("Start: depot").count() == sheet.get_by_text("End: depot").count() == 2
    place = sheet.get_by_role("link", name="A, at the back")
    expect(place).to_have_attribute("href", re.compile(r"^geo:60\.18,24\.95\?q="))
    window.emulate_media(media="screen")


def test_a_plan_is_a_row_for_each_stop_a_route_of_gpx_and_a_list(window: Page) -> None:
    front = planned(window, {"orders.csv": FLEET})
    rows = list(csv.DictReader(io.StringIO(given(window, "Save the stops of the selected tour"))))
    visited = [row for row in rows if row["stop"] != "depot"]
    assert {row["stop"]: row["load"] for row in visited} == {
        "A, at the back": "3",
        "B": "2",
        "C": "1",
    }
    assert {row["vehicle"] for row in visited if row["stop"] != "A, at the back"} == {"van 2"}
    [late] = [row for row in visited if row["vehicle"] == "van 1"]
    assert (late["latitude"], late["longitude"], late["position"]) == ("60.18", "24.95", "2")
    assert late["window"] == "9:00 to 10:30"
    assert re.fullmatch(r"\d{1,2}:\d\d", late["arrives"])
    gpx = ElementTree.fromstring(given(window, "Save the selected tour as GPX"))
    routes = gpx.findall(f"{GPX}rte")
    assert len(routes) == len(front["front"][0]["routes"]) == 2
    points = [
        [point.find(f"{GPX}name").text for point in route.findall(f"{GPX}rtept")]  # type: ignore[union-attr]
        for route in routes
    ]
    assert ["depot", "A, at the back", "depot"] in points
    alone = json.loads(given(window, "Save the selected tour alone as JSON"))
    assert alone["front"] == [front["front"][0]]
    for member in ("id", "kind", "objectives", "stops"):
        assert alone[member] == front[member]
    check_sheets(window)


def test_a_tour_over_the_day_has_its_hours(window: Page) -> None:
    places = [[24.94, 60.17], [24.95, 60.18], [24.93, 60.16]]
    request = {
        "stops": [{"id": f"s{k}", "location": place} for k, place in enumerate(places)],
        "objectives": [
            {"name": "time", "from": "great_circle", "speed": 30},
            {"name": "way", "from": "great_circle"},
        ],
        "departure": 27_000,
    }
    planned(window, {"stops.json": json.dumps(request)})
    rows = list(csv.DictReader(io.StringIO(given(window, "Save the stops of the selected tour"))))
    assert [row["position"] for row in rows] == ["1", "2", "3", "4"]
    assert rows[0]["stop"] == rows[-1]["stop"] == "s0"
    assert rows[0]["leaves"].startswith("7:30")
    assert [row["arrives"] != "" for row in rows] == [False, True, True, True]
    assert [row["leaves"] for row in rows[1:]] == ["", "", ""]
    assert "vehicle" not in rows[0]
    [alone] = json.loads(given(window, "Save the selected tour alone as JSON"))["front"]
    assert [row["stop"] for row in rows] == [*alone["stops"], "s0"]


def test_stops_without_places_have_no_gpx(window: Page) -> None:
    planned(window, {"rows.csv": "x1,y1,x2,y2\n0,0,1,1\n1,1,0,0\n2,0,2,2\n"})
    expect(window.get_by_role("button", name="Save the selected tour as GPX")).to_be_disabled()
    text = given(window, "Save the stops of the selected tour")
    assert text.splitlines()[0] == "position,stop"
    assert len(text.splitlines()) == 1 + 3 + 1


def test_places_of_robots_are_counted_from_1_as_on_the_page(window: Page) -> None:
    robots = [{"id": "left", "start": 0}, {"id": "right", "start": 2}]
    places = [[0, 0], [0, 1], [0, 6]]
    request = {"grid": [[0] * 7], "cell_size": 1, "places": places, "robots": robots}
    front = planned(window, {"robots.json": json.dumps(request)})
    rows = list(csv.DictReader(io.StringIO(given(window, "Save the stops of the selected tour"))))
    assert [(row["vehicle"], row["stop"]) for row in rows] == [
        (route["robot"], str(place + 1))
        for route in front["front"][0]["routes"]
        for place in route["tour"]
    ]
