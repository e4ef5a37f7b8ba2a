"""Maps of robots on the page: read as the service reads them, drawn with names and ends."""

import json
from collections.abc import Iterator
from io import BytesIO
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page, Route, expect

from service.requests.maps.fields import MapRequest
from tests.helpers.browsing import (
    Held,
    curl_body,
    needs_chromium,
    open_unplanned,
    shown_front,
    wait_until_planned,
    wait_until_read,
)
from tests.helpers.sampled import few

pytestmark = needs_chromium

MOST_CELLS = 10_000
ORIGIN = [-2.0, -1.5, 0.25]
THRESHOLDS: dict[str, Any] = {"occupied_thresh": 0.65, "free_thresh": 0.25}
HOW: list[dict[str, Any]] = [
    {"mode": "trinary", "negate": False, **THRESHOLDS},
    {"mode": "trinary", "negate": True, **THRESHOLDS},
    {"mode": "scale", "negate": False, **THRESHOLDS},
    {"mode": "raw", "negate": False, **THRESHOLDS},
]


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all of these tests, each of which opens its own map."""
    with open_unplanned(browser, released) as page:
        yield page


def open_map(page: Page, files: dict[str, bytes]) -> None:
    """Open files on the page, of no type that a browser knows."""
    payloads = [
        {"name": name, "mimeType": "", "buffer": content} for name, content in files.items()
    ]
    page.get_by_label("Open files").set_input_files(payloads)  # type: ignore[arg-type]
    wait_until_read(page)
    expect(page.get_by_text("A grid 16 cells wide and 18 high")).to_be_visible()


def grid_of(picture: bytes | None, **fields: Any) -> Any:
    """Return the grid that the service makes of a map."""
    request = MapRequest.model_validate({"cell_size": 0.5, **fields})
    return request.with_map(picture, MOST_CELLS).grid.tolist()


def yaml_of(how: dict[str, Any], origin: str) -> bytes:
    """Return a map.yaml of a map of half a metre a cell."""
    keys = {**how, "negate": int(how["negate"]), "image": "'office.pgm'", "resolution": 5e-1}
    lines = "".join(f"{name}: {value}  # as saved\n" for name, value in keys.items())
    return f"# a map\n{lines}{origin}\n".encode()


def shades(white: int = 255) -> NDArray[np.uint8]:
    """Return a picture of all shades, 18 rows of 16; the last two rows are of grey 205."""
    all_shades = np.append(np.arange(256), np.full(32, 205)).reshape(18, 16)
    return np.minimum(all_shades, white).astype(np.uint8)


def pgm(cells: NDArray[np.uint8], white: int = 255, plain: bool = False) -> bytes:
    """Return a PGM file, binary or plain."""
    header = f"{'P2' if plain else 'P5'}\n# CREATOR: map_saver\n16 18\n{white}\n".encode()
    return header + (" ".join(map(str, cells.ravel())).encode() if plain else cells.tobytes())


@pytest.mark.parametrize("how", few(1, HOW), ids=lambda how: f"{how['mode']}-{how['negate']}")
def test_a_map_of_ros_is_read_as_the_service_reads_it(opened: Page, how: dict[str, Any]) -> None:
    picture = pgm(shades())
    inline = f"origin: {ORIGIN}"
    open_map(opened, {"office.pgm": picture, "office.yaml": yaml_of(how, inline)})
    body = curl_body(opened, "coverage")
    assert body["grid"] == grid_of(picture, **how)
    assert (body["cell_size"], body["origin"]) == (0.5, ORIGIN)
    listed = "origin:\n" + "".join(f"- {value}\n" for value in ORIGIN)
    open_map(opened, {"a.yml": yaml_of(how, listed), "z.pgm": pgm(shades(), plain=True)})
    assert curl_body(opened, "coverage") == body


def test_a_picture_alone_is_read_as_the_service_reads_it(opened: Page) -> None:
    pictures = [pgm(shades()), pgm(shades(10), white=10), pgm(shades(10), white=10, plain=True)]
    colours = np.stack([shades(), shades().T.reshape(18, 16), shades()[::-1]], axis=2)
    for array in (shades(), colours):
        with BytesIO() as file:
            Image.fromarray(array).save(file, "PNG")
            pictures.append(file.getvalue())
    for picture in few(2, pictures[::-1]):
        open_map(opened, {"map.pgm": picture})
        assert curl_body(opened, "coverage")["grid"] == grid_of(picture)


def test_a_message_of_ros_is_read_as_the_service_reads_it(opened: Page) -> None:
    data = np.resize(np.arange(-1, 101), 18 * 16).tolist()
    turned = {"x": 0, "y": 0, "z": float(np.sin(0.3)), "w": float(np.cos(0.3))}
    place = {"position": {"x": -2, "y": 3.5, "z": 0}, "orientation": turned}
    info = {"resolution": 0.5, "width": 16, "height": 18, "origin": place}
    message = {"header": {"frame_id": "map"}, "info": info, "data": data}
    open_map(opened, {"message.json": json.dumps(message).encode()})
    body = curl_body(opened, "coverage")
    request = MapRequest.model_validate({"occupancy_grid": message})
    expected = request.with_map(None, MOST_CELLS)
    assert body["grid"] == expected.grid.tolist()
    assert body["cell_size"] == expected.cell_size
    assert body["origin"] == pytest.approx(expected.origin)
    fields = {"obstacle_from": 20, "unknown": "free"}
    asked = {"occupancy_grid": message, **fields, "spacing": 2, "cost_layer": [[1] * 16] * 18}
    open_map(opened, {"request.json": json.dumps(asked).encode()})
    body = curl_body(opened, "coverage")
    request = MapRequest.model_validate({"occupancy_grid": message, **fields})
    assert body["grid"] == request.with_map(None, MOST_CELLS).grid.tolist()
    assert (body["spacing"], body["cost_layer"]) == (2, asked["cost_layer"])
    assert not body.keys() & {"occupancy_grid", *fields}


@pytest.mark.parametrize(
    ("files", "said"),
    [
        ({"a.yaml": yaml_of(HOW[0], "origin: [0, 0, 0]")}, "open both together"),
        ({"a.yaml": b"image: a.pgm\n", "a.pgm": pgm(shades())}, "must have resolution"),
        ({"a.pgm": b"P5\n4 4\n255\nshort"}, "must be a PGM file with 16 bytes"),
        ({"a.pgm": b"P5\n4 4\n70000\n"}, "must be a PGM file with white as 1 to 65535"),
        ({"a.pgm": pgm(shades()), "b.pgm": pgm(shades())}, "open both together, got 2 files"),
        (
            {"a.yaml": yaml_of(HOW[0], "origin: [0, 0]"), "a.pgm": pgm(shades())},
            "origin must be x, y and yaw",
        ),
        (
            {"a.json": b'{"info": {"resolution": 1, "width": 2, "height": 2}, "data": [0]}'},
            "occupancy_grid/info/origin is required",
        ),
    ],
)
def test_a_map_that_cannot_be_read_is_refused_in_a_sentence(
    opened: Page, files: dict[str, bytes], said: str
) -> None:
    payloads = [{"name": name, "mimeType": "", "buffer": text} for name, text in files.items()]
    opened.get_by_label("Open files").set_input_files(payloads)  # type: ignore[arg-type]
    expect(opened.locator("#file-fault")).to_contain_text(said, ignore_case=True)


def open_request(page: Page, asked: dict[str, Any]) -> None:
    payload = {"name": "office.json", "mimeType": "", "buffer": json.dumps(asked).encode()}
    page.get_by_label("Open files").set_input_files([payload])  # type: ignore[list-item]
    wait_until_read(page)


@pytest.mark.parametrize(
    "kind",
    [{"cost_layer": [[1] * 9] * 3}, {"robots": [{"id": "left"}, {"id": "right", "start": 1}]}],
    ids=["tours", "plans"],
)
def test_what_no_path_leads_to_is_told_and_outlined(opened: Page, kind: dict[str, Any]) -> None:
    grid = [[int(column in (4, 7)) for column in range(9)] for _ in range(3)]
    places = [[0, 0], [2, 3], [0, 3]]
    office = {"grid": grid, "cell_size": 0.5, "places": places, "time_limit": 0.1, **kind}
    open_request(opened, office)
    said, boxes = opened.locator("#uncovered"), opened.locator("#grid path.unreached")
    expect(said).to_be_empty()
    chart = opened.locator("#front-chart")
    expect(chart).to_have_accessible_name("Nothing planned yet. Press Plan.")
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(said).to_have_text(
        "2.25 m² (9 cells) in 2 regions cannot be reached:"
        " A, 1.5 m² in rows 1 to 3, columns 6 to 7; B, 0.75 m² in rows 1 to 3, column 9."
    )
    expect(opened.locator("#grid .unreached-name")).to_have_text(["A", "B"])
    expect(opened.locator("#grid-legend .unreached")).to_be_visible()
    expect(boxes).to_have_count(2)
    open_request(opened, {**office, "grid": [[0] * 9] * 3})
    expect(said).to_be_empty()
    expect(boxes).to_have_count(0)
    expect(opened.locator("#grid-legend .unreached")).to_be_hidden()
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(said).to_be_empty()


def test_each_of_many_regions_that_cannot_be_reached_is_listed(opened: Page) -> None:
    grid = [[column % 2 for column in range(9)], [1] * 9]
    office = {"grid": [[0] * 9, [1] * 9, *grid], "cell_size": 2, "places": [[0, 0], [0, 8]]}
    open_request(opened, {**office, "cost_layer": [[1] * 9] * 4, "time_limit": 0.1})
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#uncovered")).to_have_text(
        "20 m² (5 cells) in 5 regions cannot be reached, the largest:"
        " A, 4 m² in row 3, column 1; B, 4 m² in row 3, column 3."
    )
    opened.get_by_text("Where that is").click()
    listed = [f"4 m² in row 3, column {column}" for column in (1, 3, 5, 7, 9)]
    expect(opened.locator("#unreached-list li")).to_have_text(listed)
    expect(opened.locator("#grid .unreached-name")).to_have_text(["A", "B", "C", "D", "E"])
    expect(opened.locator("#unreached-list")).to_have_attribute("type", "A")


def test_a_robots_map_names_its_places_and_marks_both_ends(opened: Page) -> None:
    office = {
        "grid": [[0] * 7] * 3,
        "cell_size": 1,
        "places": [[0, 0], [2, 6], [0, 6], [2, 0]],
        "cost_layer": [[1] * 7] * 3,
        "closed": False,
        "start": 0,
        "end": 3,
        "time_limit": 0.1,
    }
    payload = {"name": "office.json", "mimeType": "", "buffer": json.dumps(office).encode()}
    opened.get_by_label("Open files").set_input_files([payload])  # type: ignore[list-item]
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    for end in (".ring.start", ".ring.end"):
        expect(opened.locator(f"#grid {end}")).to_be_visible()
    [tour] = [item["tour"] for item in shown_front(opened)["front"]]
    box = opened.locator("#grid .ring.end").bounding_box()
    assert box
    opened.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    expect(opened.locator("#grid .leaflet-tooltip")).to_have_text("place 4: 4th on the tour")
    assert tour[-1] == 3
    opened.mouse.move(0, 0)
    expect(opened.locator("#grid .leaflet-tooltip")).to_have_count(0)
    opened.get_by_label("End elsewhere").fill("")
    opened.get_by_label("Open route").uncheck()
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#grid .ring.end")).to_have_count(0)
    expect(opened.locator("#grid .ring.start")).to_be_visible()


def test_costs_beside_a_map_are_its_objective_and_unknown_cells_are_told(opened: Page) -> None:
    shade = np.where(np.arange(16) > 13, 205, 254).astype(np.uint8)
    picture = pgm(np.tile(shade, (18, 1)))
    costs = "\n".join(",".join(["1", "9"] * 8) for _ in range(18)).encode()
    files = {
        "office.pgm": picture,
        "office.yaml": yaml_of(HOW[0], "origin: [0, 0, 0]"),
        "noise.csv": costs,
    }
    opened.get_by_label("Open files").set_input_files(
        [{"name": name, "mimeType": "", "buffer": data} for name, data in files.items()]
    )
    wait_until_read(opened)
    colours = opened.get_by_role("list", name="Colours of the map").get_by_role("listitem")
    expect(colours).to_have_text(["obstacle", "unknown", "more noise"])
    body = curl_body(opened, "coverage")
    assert body["cost_layers"][0]["name"] == "noise"
    assert "unknownCells" not in body
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    assert shown_front(opened)["objectives"][1]["name"] == "noise"


def test_a_map_that_takes_too_long_is_refused_in_the_words_of_the_page(opened: Page) -> None:
    refused = {"code": "survey-too-long", "detail": "the paths take longer: give about 40 places"}
    headers = {"Content-Type": "application/problem+json"}
    asked: list[float] = []

    def refuse(route: Route) -> None:
        asked.append(json.loads(route.request.post_data or "{}")["time_limit"])
        route.fulfill(status=422, headers=headers, body=json.dumps({"status": 422, **refused}))

    office = {"grid": [[0] * 9] * 4, "cell_size": 2, "spacing": 4, "cost_layer": [[1] * 9] * 4}
    open_request(opened, {**office, "time_limit": 5})
    opened.route("**/coverage", refuse)
    opened.get_by_role("button", name="Plan", exact=True).click()
    expect(opened.locator("#request-fault")).to_contain_text("give about 40 places")
    assert asked == [5]  # a longer time limit admits larger maps
    opened.unroute("**/coverage")


@pytest.mark.parametrize(
    ("kind", "seconds"),
    [
        ({"cost_layer": [[1] * 9] * 3}, 0.3),
        ({"robots": [{"id": "left"}, {"id": "right", "start": 1}]}, 0),
    ],
    ids=["tours", "plans"],
)
def test_a_map_is_surveyed_once(opened: Page, kind: dict[str, Any], seconds: float) -> None:
    places = [[0, 0], [2, 3], [0, 8]]
    office = {"grid": [[0] * 9] * 3, "cell_size": 0.5, "places": places, **kind}
    open_request(opened, {**office, "time_limit": seconds})
    asked: list[float] = []

    def note(route: Route) -> None:
        asked.append(json.loads(route.request.post_data or "{}")["time_limit"])
        route.continue_()

    opened.route("**/coverage", note)
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    assert asked == [seconds]
    assert shown_front(opened)["places"] == places
    opened.unroute("**/coverage")


def test_the_page_says_that_the_paths_of_a_map_are_being_found(opened: Page) -> None:
    office = {"grid": [[0] * 9] * 3, "cell_size": 0.5, "places": [[0, 0], [0, 8]]}
    open_request(opened, {**office, "cost_layer": [[1] * 9] * 3, "time_limit": 0.3})
    held = Held(opened, "**/coverage")
    opened.get_by_role("button", name="Plan", exact=True).click()
    expect(opened.locator("#status")).to_have_text(
        "The paths between the places of the map are being found."
    )
    held.release()
    wait_until_planned(opened)
    opened.unroute("**/coverage")
