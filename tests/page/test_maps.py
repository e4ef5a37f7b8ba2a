"""The maps of the page: streets under stops, and which way a tour goes."""

import math
import re
from urllib.parse import parse_qs, urlsplit
from xml.etree import ElementTree

from playwright.sync_api import Browser, FloatRect, Page, Route, expect

from tests.helpers.browsing import (
    FREE,
    SETTINGS,
    SVG,
    know,
    needs_chromium,
    open_files,
    open_page,
    saved,
    shown_front,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium

# Whether a canvas has anything in its outermost pixels.
DRAWN_AT_EDGE = """canvas => {
  const context = canvas.getContext("2d");
  const drawn = (...box) => context.getImageData(...box).data.some(part => part > 0);
  const { width, height } = canvas;
  return drawn(0, 0, width, 1) || drawn(0, height - 1, width, 1) ||
    drawn(0, 0, 1, height) || drawn(width - 1, 0, 1, height);
}"""

TILE = re.compile(r"z=(\d+)&x=(-?\d+)&y=(-?\d+)")
# The colours that a canvas has, where nothing shines through.
COLOURS = """(canvas) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  const colours = new Set();
  for (let at = 0; at < data.length; at += 4)
    if (data[at + 3] === 255) colours.add(data.slice(at, at + 3).join());
  return [...colours];
}"""


def test_stops_lie_on_the_tiles_of_their_place(browser: Browser, released: str) -> None:
    tiles = f"{released}/page/icon.svg?z={{z}}&x={{x}}&y={{y}}"
    told = {"tiles": tiles, "credit": "© somebody", "roads": False, "seconds": 60}
    with open_page(browser, released + FREE) as page:
        know(page, {SETTINGS: told})
        page.goto(released)
        wait_until_planned(page)
        expect(page.locator("#credit")).to_have_text("© somebody")
        expect(page.locator("#plane-1 canvas.streets")).to_be_hidden()
        centre = page.locator("#plane-1").bounding_box()
        assert centre is not None
        middle = (centre["x"] + centre["width"] / 2, centre["y"] + centre["height"] / 2)
        shown = []
        for tile in page.locator("#plane-1 img.leaflet-tile").all():
            box = tile.bounding_box()
            if (
                box
                and 0 <= middle[0] - box["x"] < box["width"]
                and 0 <= middle[1] - box["y"] < box["height"]
            ):
                shown.append(tile.get_attribute("src") or "")
        zoom, x, y = max([int(part) for part in TILE.search(source).groups()] for source in shown)  # type: ignore[union-attr]
        assert zoom > 10
        assert (x, y) == tile_of(24.944, 60.1705, zoom)
        open_files(page, {"planes.csv": "0,0,5,5\n3,1,9,1\n5,2,2,8"})
        expect(page.locator("#plane-1 img.leaflet-tile")).to_have_count(0)
        expect(page.locator("#credit")).to_be_empty()


def test_without_tiles_an_example_has_its_own_streets_and_the_places_of_its_story(
    window: Page,
) -> None:
    page = window
    page.get_by_label("Example").select_option("Helsinki deliveries")
    wait_until_planned(page)
    streets = page.locator("#plane-1 canvas.streets")
    expect(streets).to_be_visible()
    expect(page.locator("#lines")).to_have_text("along the streets")
    assert page.locator("#plane-1 canvas.selected").evaluate(DRAWN_AT_EDGE) is False
    light = streets.evaluate(COLOURS)
    assert len(light) >= 2  # main streets stand out from paths
    expect(page.locator("#credit")).to_contain_text("© OpenStreetMap contributors (ODbL)")
    for name in ("railway station", "Erottaja", "Senate Square", "Kamppi"):
        expect(page.locator("#plane-1").get_by_text(name, exact=True)).to_be_visible()
    page.emulate_media(color_scheme="dark")
    wait_for_next_frame(page)
    assert not set(light) & set(streets.evaluate(COLOURS))
    page.get_by_label("Example").select_option("City deliveries")
    expect(page.locator("#plane-1").get_by_text("icy hill", exact=True)).to_be_visible()
    expect(page.locator("#plane-1").get_by_text("Kamppi", exact=True)).to_have_count(0)
    expect(streets).to_be_hidden()
    expect(page.locator("#credit")).to_be_empty()
    page.get_by_role("button", name="Clear").click()
    expect(page.locator(".place-name")).to_have_count(0)


def test_tours_of_the_example_follow_its_streets_and_those_of_a_routing_engine(
    browser: Browser, released: str
) -> None:
    asked = []

    def lead(route: Route) -> None:
        asked.append(parse_qs(urlsplit(route.request.url).query))
        line = {"type": "LineString", "coordinates": [[24.94, 60.17], [24.95, 60.17]]}
        route.fulfill(json={"features": [{"geometry": line}]})

    told = {"tiles": None, "credit": "", "roads": True, "seconds": 60}
    with open_page(browser, released + FREE) as page:
        know(page, {SETTINGS: told})
        page.goto(released)
        page.route("**/tour?*", lead)
        wait_until_planned(page)
        expect(page.locator("#lines")).to_have_text("along the streets")
        drawing = ElementTree.fromstring(saved(page, "SVG"))
        line = [path.get("d") or "" for path in drawing.iter(f"{SVG}path")][-1]
        assert line.count("L") > 500  # places along the streets between 60 stops
        assert asked == []  # the example's streets are known
        stops = "id,lon,lat,risk\na,24.94,60.17,1\nb,24.95,60.18,2\nc,24.93,60.16,3"
        open_files(page, {"stops.csv": stops})
        page.get_by_role("button", name="Plan", exact=True).click()
        wait_until_planned(page)
        expect(page.locator("#lines")).to_have_text("along the streets")
        front = shown_front(page)
        most = str(front["front"][0]["lengths"][0])
        assert asked == [{"front": [front["id"]], "first_at_most": [most], "geometry": ["roads"]}]
        open_files(page, {"stops.csv": stops})
        page.route("**/tour?*", lambda route: route.fulfill(status=503))
        page.get_by_role("button", name="Plan", exact=True).click()
        with page.expect_response("**/tour?*"):
            wait_until_planned(page)
        expect(page.locator("#lines")).to_have_text("in straight lines")


def test_a_stop_that_is_pointed_at_is_named_on_both_maps(planned: Page) -> None:
    start = planned.locator("#plane-2 .ring.start").bounding_box()
    assert start is not None
    planned.mouse.move(start["x"] + start["width"] / 2, start["y"] + start["height"] / 2)
    for plane in ("#plane-1", "#plane-2"):
        expect(planned.locator(f"{plane} .leaflet-tooltip")).to_have_text("stop 1: 1st on the tour")
    planned.mouse.move(0, 0)
    expect(planned.locator(".leaflet-tooltip")).to_have_count(0)


def test_a_button_shows_all_stops_again(page: Page) -> None:
    start = page.locator("#plane-2 .ring.start")
    before = start.bounding_box()
    for _ in range(3):
        page.get_by_role("button", name="Zoom in").last.click()
    assert start.bounding_box() != before
    page.get_by_role("button", name="Zoom out").last.press("Tab")
    expect(page.get_by_role("button", name="Show all stops").last).to_be_focused()
    page.keyboard.press("Enter")
    assert start.bounding_box() == before


def test_an_open_route_has_a_start_and_an_end_on_each_map(page: Page) -> None:
    expect(page.locator("#plane-2 .ring.start")).to_be_visible()
    expect(page.locator("#plane-2 .ring.end")).to_have_count(0)
    page.get_by_label("End elsewhere").fill("5")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    for plane in ("#plane-1", "#plane-2"):
        expect(page.locator(f"{plane} .ring.end")).to_be_visible()


def holds(box: FloatRect, place: tuple[float, float]) -> bool:
    across, down = place[0] - box["x"], place[1] - box["y"]
    return 0 <= across < box["width"] and 0 <= down < box["height"]


def tile_of(longitude: float, latitude: float, zoom: int) -> tuple[int, int]:
    """Return the tile that a place lies on: OpenStreetMap's wiki, "Slippy map tilenames"."""
    north = math.radians(latitude)
    across = (longitude + 180) / 360
    down = (1 - math.asinh(math.tan(north)) / math.pi) / 2
    return int(across * 2**zoom), int(down * 2**zoom)
