"""Files opened on the page: lists of cities, JSON, TSPLIB, pictures of maps."""

import csv
import json
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from service.cli.inputs import read_request
from service.files.reader import read_files
from service.files.reading import Bounds, NamedFile
from tests.helpers.browsing import (
    copied,
    curl_body,
    needs_chromium,
    open_files,
    open_link,
    saved,
    shown_front,
    stops_as_text,
    wait_until_planned,
)
from tests.helpers.command import paretour
from tests.helpers.sampled import few

pytestmark = needs_chromium


@pytest.fixture
def opened(window: Page) -> Page:
    """The page with two stops from a file."""
    open_files(window, {"two.csv": "0,0,5,5\n3,1,9,1\n"})
    expect(window.locator("#count")).to_have_text("2 stops")
    expect(window.locator("#file-fault")).to_be_empty()
    expect(window.locator("#status")).not_to_contain_text("Done")
    return window


def test_a_picture_of_a_map_is_covered(opened: Page) -> None:
    walls = np.full((20, 30), 255, dtype=np.uint8)
    walls[5:15, 12:14] = 0
    picture = BytesIO()
    Image.fromarray(walls).save(picture, "PNG")
    given = {"name": "map.png", "mimeType": "image/png", "buffer": picture.getvalue()}
    opened.get_by_label("Open files").set_input_files([given])
    expect(opened.get_by_text("A grid 30 cells wide and 20 high")).to_be_visible()
    expect(opened.get_by_label("Metres a cell")).to_have_value("0.05")
    opened.get_by_label("Seconds of planning").fill("0.1")
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#grid")).to_be_visible()
    expect(opened.locator("#plane-1")).to_be_hidden()


def test_stops_are_planned_under_their_names_and_ids(opened: Page) -> None:
    costs = np.random.default_rng(0).random((4, 4)).tolist()
    names = ["depot", 'order "1"', "c", "d"]
    request = {
        "stops": [{"id": name, "location": [i / 9, i**2 / 9]} for i, name in enumerate(names)],
        "objectives": [
            {"name": "way", "from": "great_circle"},
            {"name": "risk, all", "matrix": costs},
        ],
        "start": 'order "1"',
        "time_limit": 0.1,
    }
    open_files(opened, {"stops.json": json.dumps(request)})
    expect(opened.locator("#count")).to_have_text("4 stops")
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#order li").first).to_have_text('order "1"')
    expect(opened.locator("#comparison")).to_contain_text("Way")
    rows = list(csv.DictReader(saved(opened, "CSV").decode().splitlines()))
    assert rows[0].keys() == {"angle", "way (m)", "risk, all", "tour", "selected"}
    assert all(row["tour"].startswith('"order ""1""" ') for row in rows)


OBJECTIVES = [
    {"name": "way", "from": "great_circle"},
    {"name": "risk", "matrix": [[0, 4, 5], [1, 0, 5], [2, 2, 0]]},
]


def collection(**members: Any) -> str:
    """Return three points as GeoJSON, with other members of the collection."""
    points: list[dict[str, Any]] = [
        {"geometry": {"type": "Point", "coordinates": [24.941 + k / 100, 60.171 - k**2 / 500]}}
        for k in range(3)
    ]
    named = [{"id": "depot"}, {"properties": {"name": "order-17"}}, {"properties": {"id": 18}}]
    features = [{"type": "Feature", **one, **two} for one, two in zip(points, named, strict=True)]
    return json.dumps({"type": "FeatureCollection", "features": features, **members})


@pytest.mark.parametrize("pasted", [False, True], ids=["opened", "pasted"])
def test_points_of_geojson_are_stops_as_on_the_command_line(
    opened: Page, tmp_path: Path, pasted: bool
) -> None:
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}
    text = collection(name="stops", crs=crs, objectives=OBJECTIVES, time_limit=0.2)
    if pasted:
        stops_as_text(opened).focus()
        opened.evaluate("text => navigator.clipboard.writeText(text)", text)
        opened.keyboard.press("Control+V")
    else:
        open_files(opened, {"stops.geojson": text})
    expect(opened.locator("#count")).to_have_text("3 stops")
    (tmp_path / "stops.geojson").write_text(text)
    request, ids, *_ = read_request([tmp_path / "stops.geojson"], "front")
    body = curl_body(opened)
    assert ids == ("depot", "order-17", "18")
    assert {name: body[name] for name in request} == request
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.locator("#order li").first).to_have_text("depot")


def test_rows_that_are_pasted_go_into_their_box(opened: Page) -> None:
    box = stops_as_text(opened)
    box.fill("")
    opened.evaluate("text => navigator.clipboard.writeText(text)", "1, 2, 3, 4")
    box.focus()
    opened.keyboard.press("Control+V")
    expect(opened.locator("#count")).to_have_text("1 stop")


@pytest.mark.parametrize(
    ("name", "text", "said"),
    few(
        4,
        [
            (
                "stops.csv",
                "x,y,u,v\n1,2,3,4\n5,6,7\n",
                "stops.csv: row 3, column 'v' must be a number",
            ),
            ("stops.json", '{"coordinates": [', "stops.json: must be JSON"),
            ("stops.json", '{"coordinates": [1, 2]}', "coordinates must be a list of rows"),
            ("stops.json", '{"stops": 7}', "stops must be a list of objects"),
            (
                "stops.csv",
                "id,lon,lat\na,24.9,60.1\nb,east,60.2\n",
                "row 3, column 'lon' must be a number, got 'east'",
            ),
            (
                "list.csv",
                "Customer\nAnna\nBob\n",
                "must say where each stop is: in columns named lat and lon, or in 4, 6 or 8",
            ),
            ("stops.csv", "id;lon;lat\na;24,9;60\na;25;60\n", "row 3, column 'id' must be an id"),
            (
                "points.geojson",
                collection(objectives=OBJECTIVES, features=[{"geometry": None}]),
                "features/0 must be a Point",
            ),
            ("points.geojson", collection(objectives=5), "objectives must be a list of objects"),
            ("map.json", '{"grid": []}', "grid must have a cell or more"),
            ("kroA.tsp", "EDGE_WEIGHT_TYPE: EUC_2D\n", "name another for the other one"),
        ],
    ),
)
def test_a_bad_file_is_refused_in_a_sentence(opened: Page, name: str, text: str, said: str) -> None:
    open_files(opened, {name: text})
    expect(opened.locator("#file-fault")).to_contain_text(said, ignore_case=True)
    expect(opened.locator("#count")).to_have_text("2 stops")


def tsplib(places: str) -> str:
    cities = len(places.splitlines())
    head = f"DIMENSION: {cities}\nEDGE_WEIGHT_TYPE: EUC_2D\nNODE_COORD_SECTION"
    return f"{head}\n{places}\nEOF\n"


@pytest.mark.parametrize(
    "files",
    [
        {"cities.csv": "x,y,u,v\n0,0,5,5\n3,1,9,1\n5,2,2,8\n"},
        {"cities.json": '{"coordinates": [[0, 0, 5, 5], [3, 1, 9, 1], [5, 2, 2, 8]]}'},
        {
            "a.tsp": tsplib("1 0 0\n2 3 1\n3 5 2"),
            "b.tsp": tsplib("1 5 5\n2 9 1\n3 2 8"),
        },
    ],
    ids=["csv", "json", "tsplib"],
)
def test_a_file_of_cities_is_planned(opened: Page, files: dict[str, str]) -> None:
    open_files(opened, files)
    expect(stops_as_text(opened)).to_have_value("0, 0, 5, 5\n3, 1, 9, 1\n5, 2, 2, 8")
    opened.get_by_role("button", name="Plan", exact=True).click()
    expect(opened.locator("#status")).to_have_text("Done: 1 tour found.")


@pytest.fixture
def tsplib_files(tmp_path: Path) -> list[Path]:
    """Two files of TSPLIB; halves of whole numbers, so that many distances are halves as well."""
    halves = np.random.default_rng(4).integers(0, 20, (2, 12, 2)) / 2
    files = [tmp_path / "a.tsp", tmp_path / "b.tsp"]
    for file, places in zip(files, halves, strict=True):
        file.write_text(tsplib("\n".join(f"{i} {x} {y}" for i, (x, y) in enumerate(places, 1))))
    return files


def test_two_files_of_tsplib_give_the_front_of_the_command_line(
    page: Page, tsplib_files: list[Path]
) -> None:
    ended = paretour("front", *tsplib_files, "--json", "--time-limit", 50, "--seed", 3)
    expected = json.loads(ended.stdout)
    assert expected["terminated"] == "converged"
    page.get_by_label("Open files").set_input_files(tsplib_files)
    page.locator("#more").evaluate("details => details.open = true")
    page.get_by_label("Seed").fill("3")
    page.get_by_label("Seconds of planning").fill("50")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    found = shown_front(page)
    for name in ("front", "points", "hypervolume", "reference_point", "terminated", "actor"):
        assert found[name] == expected[name]


def test_a_link_to_rounded_distances_has_the_maps_and_curl_the_matrices(
    opened: Page, other: Page, tsplib_files: list[Path]
) -> None:
    opened.get_by_label("Open files").set_input_files(tsplib_files)
    expect(opened.get_by_label("Distances rounded")).to_be_checked()
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    files = [NamedFile(file.name, file.read_bytes()) for file in tsplib_files]
    assert curl_body(opened)["matrices"] == read_files(files, Bounds()).request["matrices"]
    open_link(other, copied(opened, "link"))
    expect(other.get_by_label("Distances rounded")).to_be_checked()
    expect(other.locator("#plane-1 canvas.selected")).to_be_visible()
    stops_as_text(other)
    other.get_by_label("Distances rounded").uncheck()
    expect(other.get_by_label("Nothing planned yet")).to_be_visible()
    assert len(curl_body(other)["coordinates"]) == 12


def test_a_list_of_angles_in_a_file_is_asked_for(opened: Page) -> None:
    open_files(opened, {"few.json": '{"coordinates": [[0, 0, 5, 5]], "preferences": [10, 80]}'})
    assert curl_body(opened)["preferences"] == [10, 80]
    opened.locator("#more").evaluate("details => details.open = true")
    opened.get_by_label("Trade-offs for the network").fill("7")
    assert curl_body(opened)["preferences"] == 7


def test_settings_of_a_file_go_with_it_and_those_typed_stay(opened: Page) -> None:
    cities = {"coordinates": [[0, 0, 5, 5], [3, 1, 9, 1]]}
    settings = {"seed": 7, "size": 8, "time_limit": 2}
    open_files(opened, {"set.json": json.dumps({**cities, **settings})})
    assert curl_body(opened).items() >= settings.items()
    opened.get_by_label("Tours", exact=True).fill("9")
    open_files(opened, {"plain.json": json.dumps(cities)})
    assert curl_body(opened).items() >= {"seed": 0, "size": 9, "time_limit": 3}.items()
    opened.get_by_label("Tours", exact=True).fill("100")
