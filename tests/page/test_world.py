"""The map of the world under stops of one's own, and the bar that says how long a kilometre is."""

import json

import numpy as np
import pytest
from playwright.sync_api import Browser, expect

from tests.helpers.browsing import needs_chromium, open_files, open_page, wait_until_planned
from tests.helpers.node import Node
from tests.helpers.world import encoded, encoded_towns, joined, varints, worth_of

STOPS = "id,lon,lat,risk\na,24.94,60.17,1\nb,25.95,60.18,2\nc,24.93,61.16,3"

PLANE = [[0, 0], [3, 1], [5, 2]]
IN_KILOMETRES = {
    "stops": [{"id": name} for name in "abc"],
    "objectives": [
        {"name": "distance", "unit": "km", "coordinates": PLANE},
        {"name": "risk", "coordinates": PLANE[::-1]},
    ],
}

# What the map has at a place, and the towns near it: rings that a ray from the place crosses.
AT = """async ([east, north]) => {
  const { readWorld } = await import("./page/map/world_file.js");
  const { readFileSync } = await import("node:fs");
  globalThis.world ??= readWorld(new Uint8Array(readFileSync("page/map/world.bin")).buffer);
  const crosses = ([x, y], [u, v]) =>
    y > north !== v > north && east < x + ((north - y) / (v - y)) * (u - x);
  const crossed = (ring) => ring.filter((at, i) => crosses(at, ring.at(i - 1)));
  const within = (rings) => rings.flatMap(crossed).length % 2 > 0;
  const { land, lakes, towns, borders } = globalThis.world;
  const near = towns.filter(({ at: [x, y] }) => Math.hypot(x - east, y - north) < 0.1);
  const border = borders.flat().some(([x, y]) => Math.hypot(x - east, y - north) < 0.3);
  const ground = within(lakes) ? "lake" : within(land) ? "land" : "sea";
  return [ground, near.map(({ name }) => name), border];
}"""


@pytest.mark.parametrize(
    ("place", "ground", "towns", "border"),
    [
        ([24.94, 60.19], "land", ["Helsinki"], False),
        ([24.94, 59.8], "sea", [], False),
        ([2.33, 48.86], "land", ["Paris"], False),
        ([-74.0, 40.75], "land", ["New York"], False),
        ([-30.0, 40.0], "sea", [], False),
        ([33.0, -1.5], "lake", [], False),  # Victoria
        ([51.0, 42.0], "sea", [], False),  # the Caspian, a hole in the land
        ([151.15, -33.85], "land", ["Sydney"], False),
        ([7.75, 48.58], "land", ["Strasbourg"], True),
        ([0.0, -89.0], "land", [], False),
    ],
)
def test_the_world_has_land_seas_lakes_borders_and_towns(
    node: Node, place: list[float], ground: str, towns: list[str], border: bool
) -> None:
    found, near, is_border = node.evaluate(AT, place)
    assert found == ground
    assert set(towns) <= set(near)
    assert is_border == border


def test_the_page_reads_what_the_command_writes(node: Node) -> None:
    lines = [np.array([[0.5, -0.25], [-170.0, 80.0], [179.999, 3.0]]), np.array([[1.0, 2.0]])]
    towns = encoded_towns(["Ürümqi", "x"], np.array([[87.573, 43.805], [-1.0, -2.0]]))
    written = encoded(lines) + varints(np.zeros(2, int)) + towns
    read = node.evaluate(
        """async (bytes) => {
          const { readWorld } = await import("./page/map/world_file.js");
          return readWorld(Uint8Array.from(bytes).buffer);
        }""",
        list(written),
    )
    assert [np.round(line, 6).tolist() for line in read["land"]] == [
        each.tolist() for each in lines
    ]
    assert read["lakes"] == read["borders"] == []
    assert [town["name"] for town in read["towns"]] == ["Ürümqi", "x"]
    assert np.round([town["at"] for town in read["towns"]], 6).tolist() == [
        [87.573, 43.805],
        [-1.0, -2.0],
    ]


def test_corners_that_change_a_line_most_are_worth_most() -> None:
    line = np.array([[0, 0], [1, 0.001], [2, 0], [3, 1], [4, 0]], float)
    worth = worth_of(line, False, np.ones(5))
    assert np.isinf(worth[[0, 4]]).all()
    assert np.argsort(worth[1:4]).tolist() == [0, 1, 2]


def test_lines_that_continue_each_other_become_one() -> None:
    parts = [
        np.array(part, float) for part in ([[2, 0], [1, 0]], [[0, 0], [1, 0]], [[5, 5], [6, 6]])
    ]
    assert sorted(len(line) for line in joined(parts)) == [2, 3]


@pytest.mark.parametrize(
    ("metres", "said", "pixels"),
    [
        (1, "100 m", 100),
        (40, "2 km", 50),
        (0.02, "2 m", 100),
        (0.001, "10 cm", 100),
        (9000, "500 km", 56),
    ],
)
def test_the_bar_is_a_round_length(node: Node, metres: float, said: str, pixels: int) -> None:
    assert node.call("map/scale.js", "barOf", metres) == {"said": said, "pixels": pixels}


@needs_chromium
def test_stops_of_ones_own_lie_on_the_world_and_those_of_an_example_on_its_streets(
    browser: Browser, released: str
) -> None:
    loaded: list[str] = []
    with open_page(browser, "about:blank") as page:
        page.on("request", lambda request: loaded.append(request.url))
        page.goto(released)
        wait_until_planned(page)
        expect(page.locator("#plane-1 canvas.streets")).to_be_visible()
        expect(page.locator("#plane-1 .scale")).to_have_text("200 m")
        assert not any("world.bin" in url for url in loaded)
        open_files(page, {"stops.csv": STOPS})
        expect(page.locator("#plane-1 canvas.world")).to_be_visible()
        expect(page.locator("#plane-1 .scale")).to_have_text("10 km")
        expect(page.locator("#credit")).to_contain_text("Natural Earth")
        way = page.locator("#credit").get_by_role("link", name="Draw streets").get_attribute("href")
        assert way == "guide/use-the-page#streets-under-your-stops"
        open_files(page, {"planes.csv": "0,0,5,5\n3,1,9,1\n5,2,2,8"})
        for part in ("canvas.world", ".scale"):
            expect(page.locator(f"#plane-1 {part}")).to_be_hidden()
        # In a plane there is a bar where its unit is a length.
        open_files(page, {"planes.json": json.dumps(IN_KILOMETRES)})
        expect(page.locator("#plane-1 .scale")).to_have_text("1 km")
        expect(page.locator("#plane-2 .scale")).to_be_hidden()
