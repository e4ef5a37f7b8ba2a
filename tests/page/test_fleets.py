"""Fleets on the page: the front of plans, and the routes of the selected one."""

import json
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from playwright.sync_api import Browser, Page, expect

from service.api.app import Edge
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from service.settings import Settings
from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    CUT_OFF,
    DRAWN,
    SVG,
    needs_chromium,
    open_files,
    open_unplanned,
    plan_by_network_alone,
    saved,
    select_last,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.fake_router import fake_osrm
from tests.helpers.serving import app_of, serving

pytestmark = needs_chromium

EXAMPLES = Path(__file__).parents[2] / "service/examples"
VANS = json.loads((EXAMPLES / "helsinki-vans.json").read_text())
# Okabe and Ito (2008), as far as six vans need them.
COLOURS = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00"]
# The van must bring a parcel from "shop" to "home" and may leave "far" out, whose prize is small.
SHIPMENT: dict[str, Any] = {
    "stops": [
        {"id": "depot"},
        {"id": "shop", "demand": [1], "window": [60, 90]},
        {"id": "home", "service": 5},
        {"id": "far", "prize": 10},
    ],
    "vehicles": [{"id": "van", "start": "depot", "end": "depot", "capacity": [1]}],
    "shipments": [{"pickup": "shop", "delivery": "home"}],
    "objectives": [
        {"name": "distance", "unit": "km", "coordinates": [[0, 0], [1, 0], [1, 1], [90, 90]]},
        {
            "name": "time",
            "unit": "min",
            "matrix": [[0, 9, 9, 99], [9, 0, 7, 99], [9, 7, 0, 99], [99, 99, 99, 0]],
            "over": "max",
        },
    ],
    "clock": "time",
    "time_limit": 10,
}

# The values of fields that have no room for them.
CUT = "fields => fields.filter(f => f.scrollWidth > f.clientWidth).map(f => f.value)"


def dashes(page: Page, place: str) -> list[bool]:
    """Return whether the line of each vehicle in a key of colours is dashed."""
    lines = page.locator(f"{place} .swatch path:last-child")
    return [bool(each.get_attribute("stroke-dasharray")) for each in lines.all()]


def test_six_vans_have_a_route_a_lane_a_row_and_a_look_each(window: Page) -> None:
    plan_by_network_alone(window, "fleet")
    window.get_by_label("Example").select_option("Helsinki, six vans")
    expect(window.locator("#brought")).to_contain_text("A fleet: 6 vehicles and 60 stops.")
    wait_until_planned(window)
    chart = window.get_by_label(re.compile(r"A choice of \d+ plans: driving from"))
    expect(chart).to_be_visible()
    plan = select_last(window)
    routes = plan["routes"]
    expect(window.locator("#choice")).to_contain_text(", and the longest route is ")
    demands = {each["id"]: each.get("demand", [0])[0] for each in VANS["stops"]}
    [capacity] = VANS["vehicles"][0]["capacity"]
    rows = window.locator("#fleet-legend tbody tr")
    shown = [row.inner_text().split("\t") for row in rows.all()]
    for number, (route, [name, stops_of, load, _, _, *times]) in enumerate(
        zip(routes, shown, strict=True), 1
    ):
        assert (name, stops_of) == (f"van {number}", str(len(route["stops"]) - 2))
        assert load == f"{sum(map(demands.__getitem__, route['stops']))} of {capacity}"
        assert [seconds(said) for said in times] == pytest.approx(route["lengths"], abs=60)
    assert set(COLOURS[: len(routes)]) <= set(
        window.locator("#plane-1 canvas.routes").evaluate(DRAWN)
    )
    stops = sum(len(route["stops"]) for route in routes)
    expect(window.locator("#fleet-lanes .visit")).to_have_count(stops)
    expect(window.locator("#fleet-left-out-title")).to_have_text("No stop is left out.")
    for hidden in ("Replan on the way", "Order of the stops", "End elsewhere", "Open route"):
        expect(window.get_by_text(hidden)).to_be_hidden()
    drawing = ElementTree.fromstring(saved(window, "SVG"))
    strokes = [path.get("stroke") for path in drawing.iter(f"{SVG}path")]
    # Each route on the map, and beside its name.
    assert [strokes.count(colour) for colour in COLOURS] == [2] * len(routes) + [0] * (
        len(COLOURS) - len(routes)
    )
    assert {"van 1", f"van {len(routes)}"} <= {text.text for text in drawing.iter(f"{SVG}text")}
    check_looks(window, len(routes))
    window.unroute_all()


def check_looks(page: Page, vans: int) -> None:
    """Check that vans look different, that no cell is cut off, and how it looks on a phone."""
    for place in ("#vehicles-key", "#fleet-legend"):
        assert dashes(page, place) == [False] * 4 + [True] * (vans - 4)
    assert page.locator("#stops input").evaluate_all(CUT) == []
    table = page.locator("#stops").bounding_box()
    demand = page.get_by_role("columnheader", name="Demand").bounding_box()
    assert table is not None
    assert demand is not None
    assert demand["x"] + demand["width"] <= table["x"] + table["width"]
    check_on_a_phone(page, "#result")


def test_the_search_plans_what_the_network_cannot(window: Page) -> None:
    open_files(window, {"fleet.json": json.dumps(SHIPMENT)})
    expect(window.locator("#brought")).to_contain_text("A fleet: 1 vehicle and 4 stops.")
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    plan = select_last(window)
    assert [route["stops"] for route in plan["routes"]] == [["depot", "shop", "home", "depot"]]
    assert plan["unassigned"] == ["far"]
    expect(window.locator("#fleet-left-out-title")).to_have_text(
        "1 stop is left out: stops with a prize may be. Their prizes are added to distance:"
    )
    expect(window.locator("#fleet-left-out li")).to_have_text(["far: prize 10 km"])
    expect(window.locator("#fleet-stops b")).to_have_text("van")
    expect(window.locator("#fleet-stops ol li")).to_have_text(
        ["depot 0:51", "shop 1:00, window 1:00 to 1:30", "home 1:07", "depot 1:21"]
    )
    # One map, of the only objective that has a plane.
    expect(window.locator("#plane-1 canvas.routes")).to_be_visible()
    expect(window.locator("#plane-2")).to_be_hidden()
    window.get_by_label("Example").select_option("City deliveries")
    wait_until_planned(window)
    expect(window.locator("#fleet")).to_be_hidden()
    expect(window.get_by_label("End elsewhere")).to_be_visible()


def test_long_numbers_are_never_cut_off(window: Page) -> None:
    far = [[0, 0], [123_456, 0], [123_456, 654_321], [90, 90]]
    distance, time = SHIPMENT["objectives"]
    slow = [[37 * cell for cell in row] for row in time["matrix"]]
    van = {"id": "refrigerated-van", "start": "depot", "end": "depot", "capacity": [1]}
    stops = [{"id": "depot"}, {"id": "shop", "demand": [1]}, {"id": "home"}, {"id": "far"}]
    asked = {
        **SHIPMENT,
        "stops": stops,
        "vehicles": [van],
        "objectives": [{**distance, "coordinates": far}, {**time, "matrix": slow}],
    }
    open_files(window, {"fleet.json": json.dumps({**asked, "time_limit": 0.1})})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    for name in ("Keep to compare", "Stop comparing"):
        for width in (320, 375, 768, 861, 1024, 1440):
            window.set_viewport_size({"width": width, "height": 900})
            wait_for_next_frame(window)
            assert window.evaluate(CUT_OFF) == [], width
        window.get_by_role("button", name=name).click()


def test_the_list_of_stops_says_until_when_a_vehicle_waits(window: Page) -> None:
    asked = {
        "stops": [
            {"id": "depot"},
            {"id": "early", "window": [0, 10]},
            {"id": "late", "window": [300, 360]},
        ],
        "vehicles": [{"id": "van", "start": "depot", "end": "depot"}],
        "objectives": [
            {"name": "distance", "unit": "km", "coordinates": [[0, 0], [1, 0], [1, 1]]},
            {"name": "time", "unit": "min", "matrix": [[7] * 3] * 3, "over": "max"},
        ],
        "clock": "time",
        "time_limit": 0.1,
    }
    open_files(window, {"fleet.json": json.dumps(asked)})
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    second, third = window.locator("#fleet-stops ol li").all_text_contents()[1:3]
    closing = r"(less than 1|[1-5]) min before its window closes"
    assert re.fullmatch(rf"early 0:\d\d, window 0:00 to 0:10(, {closing})?", second)
    assert re.fullmatch(r"late 0:1\d, waits until 5:00, window 5:00 to \d:\d\d", third)


def test_routes_follow_the_streets_of_a_routing_engine(browser: Browser) -> None:
    places = [[24.941, 60.171], [24.952, 60.169], [24.933, 60.165], [24.925, 60.18], [24.96, 60.17]]
    request = {
        "stops": [
            {"id": f"s{at}", "location": place, **({"demand": [1]} if at else {})}
            for at, place in enumerate(places)
        ],
        "vehicles": [{"id": "van", "count": 2, "capacity": [2], "start": "s0", "end": "s0"}],
        "objectives": [
            {"name": "distance", "from": "great_circle"},
            {"name": "time", "unit": "min", "matrix": [[7] * 5] * 5, "over": "max"},
        ],
    }
    with fake_osrm() as engine:
        settings = RouterSettings(url=engine.url, router="osrm", profile="driving")
        app = app_of(edge=Edge(streets=RoadClient(settings)), limits=Settings().limits)
        with serving(app) as address, open_unplanned(browser, address) as page:
            open_files(page, {"fleet.json": json.dumps(request)})
            page.get_by_role("button", name="Plan", exact=True).click()
            wait_until_planned(page)
            plan = select_last(page)
            assert len(plan["routes"]) == 2
            expect(page.locator("#lines")).to_have_text("along the streets")
            legs = sum(len(route["stops"]) - 1 for route in plan["routes"])
            drawing = ElementTree.fromstring(saved(page, "SVG"))
            # Each leg of the engine has a corner, and each route is drawn, and cased, and named.
            lines = [path.get("d") or "" for path in drawing.iter(f"{SVG}path")][1:]
            assert sum(line.count("L") for line in lines) == 2 * 2 * legs + 2 * 2
            collection = json.loads(saved(page, "GeoJSON"))
            routes = [each for each in collection["features"] if "plan" in each["properties"]]
            chosen = {
                each["properties"]["plan"] for each in routes if each["properties"]["selected"]
            }
            assert chosen == {routes[-1]["properties"]["plan"]}
            places_of_last = [
                len(each["geometry"]["coordinates"])
                for each in routes
                if each["properties"]["plan"] == routes[-1]["properties"]["plan"]
            ]
            assert sum(places_of_last) == 2 * legs + 2
            # Where streets are too many for one file, it has straight lines, and that is said.
            page.route("**/front/*?geometry=roads", lambda route: route.fulfill(status=503))
            straight = json.loads(saved(page, "GeoJSON"))
            assert len(straight["features"]) == len(collection["features"])
            assert straight != collection
            expect(page.locator("#link-help")).to_contain_text("straight from stop to stop")


def seconds(said: str) -> float:
    """Return a time such as "1 h 5 min" in seconds."""
    units = {"h": 3600, "min": 60, "s": 1}
    return sum(int(number) * units[unit] for number, unit in re.findall(r"(\d+) (h|min|s)", said))
