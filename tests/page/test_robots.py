"""Robots on the page: the front of plans, and the paths of the selected one on the map."""

import csv
import io
import json
import re
from contextlib import redirect_stdout
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    DRAWN,
    SVG,
    copied,
    curl_body,
    metres,
    needs_chromium,
    number_in,
    open_files,
    open_link,
    plan_by_network_alone,
    saved,
    select_last,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium

COLOURS = {"north-west": "#0072b2", "north-east": "#e69f00", "south": "#009e73"}
# Of two robots, that which stands beside the places visits all where the sum is least.
CORRIDOR = {
    "grid": [[0, 0, 0, 0, 0, 0, 0]],
    "cell_size": 1,
    "places": [[0, 0], [0, 1], [0, 6]],
    "robots": [{"id": "far, left", "start": 0}, {"id": "right", "start": 2}],
    "paths": True,
    "time_limit": 0,
    "closed": False,
}


def rows_of(table: Locator) -> list[list[str]]:
    """Return the texts of the cells of a table's rows."""
    return [row.locator("th, td").all_inner_texts() for row in table.locator("tbody tr").all()]


def check_pictures(page: Page) -> None:
    """Assert that SVG and PNG have the map and the path of each of the three robots."""
    drawing = ElementTree.fromstring(saved(page, "SVG"))
    assert len(list(drawing.iter(f"{SVG}image"))) == 1
    strokes = [path.get("stroke") for path in drawing.iter(f"{SVG}path")]
    # The path of each on the map, and a piece of it beside its name.
    assert [strokes.count(colour) for colour in COLOURS.values()] == [2, 2, 2]
    assert set(COLOURS) <= {text.text for text in drawing.iter(f"{SVG}text")}
    picture = Image.open(io.BytesIO(saved(page, "PNG"))).convert("RGB")
    drawn = {f"#{r:02x}{g:02x}{b:02x}" for _, (r, g, b) in picture.getcolors(1_000_000) or []}
    blocked = "#4a5563"
    assert {*COLOURS.values(), blocked} <= drawn


def test_three_robots_have_a_path_and_a_row_each(window: Page) -> None:
    plan_by_network_alone(window, "coverage")
    window.get_by_label("Example").select_option("Warehouse, three robots")
    expect(window.locator("#brought")).to_contain_text(
        "3 robots on a grid 64 cells wide and 40 high"
    )
    wait_until_planned(window)
    expect(
        window.get_by_label(re.compile(r"A choice of \d+ plans: total distance"))
    ).to_be_visible()
    plan = select_last(window)
    assert {route["robot"] for route in plan["routes"]} == set(COLOURS)
    expect(window.get_by_role("heading", name="Robots")).to_be_visible()
    assert rows_of(window.locator("#fleet-legend")) == [
        [
            route["robot"],
            str(len(route["tour"]) - 2),
            *(metres(float(f"{length:.3g}")) for length in route["lengths"]),
        ]
        for route in plan["routes"]
    ]
    routes = window.locator("#grid canvas.routes")
    assert set(COLOURS.values()) <= set(routes.evaluate(DRAWN))
    listed = window.locator("#fleet-stops > li").first
    assert listed.locator("b").text_content() == plan["routes"][0]["robot"]
    places = [str(place + 1) for place in plan["routes"][0]["tour"]]
    assert listed.locator("ol li").all_text_contents() == places
    check_pictures(window)
    for hidden in ("Replan on the way", "Order of the stops", "End elsewhere", "left out"):
        expect(window.get_by_text(hidden)).to_be_hidden()
    # Where fewer robots leave, each keeps its colour.
    window.get_by_role("slider", name="Balance").press("Home")
    wait_for_next_frame(window)
    [[alone, *_]] = rows_of(window.locator("#fleet-legend"))
    assert set(COLOURS.values()) & set(routes.evaluate(DRAWN)) == {COLOURS[alone]}
    check_on_a_phone(window, "#result")
    window.unroute_all()


def test_a_request_for_robots_is_opened_and_taken_along(window: Page, other: Page) -> None:
    open_files(window, {"robots.json": json.dumps(CORRIDOR)})
    expect(window.locator("#brought")).to_contain_text("2 robots on a grid 7 cells wide and 1 high")
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    plan = select_last(window)
    assert curl_body(window, "coverage") == {**CORRIDOR, "size": 100, "seed": 0}
    [head, *rows] = csv.reader(io.StringIO(saved(window, "CSV").decode()))
    assert head[4:] == [
        "robot",
        "route total distance (m)",
        "route longest route (m)",
        "places",
        "selected",
    ]
    last = [row[4:] for row in rows if row[0] == rows[-1][0]]
    assert last == [
        [
            route["robot"],
            *map("{:g}".format, route["lengths"]),
            " ".join(map(str, route["tour"])),
            "yes",
        ]
        for route in plan["routes"]
    ]
    output = io.StringIO()
    with redirect_stdout(output):
        exec(copied(window, "as Python"), {})
    routes = [(route["robot"], route["tour"]) for route in plan["routes"]]
    assert output.getvalue().endswith(f"{routes}\n")
    open_link(other, copied(window, "link"))
    expect(other.locator("#brought")).to_contain_text("2 robots")
    assert rows_of(other.locator("#fleet-legend")) == rows_of(window.locator("#fleet-legend"))
    # What robots cannot have is refused where it is seen.
    open_files(window, {"wrong.json": json.dumps({**CORRIDOR, "start": 1})})
    window.get_by_role("button", name="Plan", exact=True).click()
    expect(window.locator("#request-fault")).to_contain_text("must be left out with robots")


def test_each_cost_layer_of_a_robot_has_a_limit_of_its_own(window: Page) -> None:
    layers = [
        {
            "name": name,
            "layer": (9.0 * (np.random.default_rng(seed).random((9, 14)) > 0.6)).tolist(),
        }
        for seed, name in enumerate(("people", "dust"))
    ]
    spread = {"grid": [[0] * 14] * 9, "cell_size": 0.5, "spacing": 1.2, "time_limit": 0.5}
    open_files(window, {"robot.json": json.dumps({**spread, "cost_layers": layers})})
    expect(window.locator("#ground li")).to_have_text(["obstacle", "more people"])
    expect(window.locator("#named")).to_be_hidden()
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    for name in ("Distance", "People", "Dust"):
        expect(window.get_by_role("slider", name=name, exact=True)).to_be_visible()
    window.get_by_role("slider", name="Dust", exact=True).press("Home")
    expect(window.locator("#caps-said")).to_contain_text("are within the limits")
    least = min(item["lengths"][2] for item in json.loads(saved(window, "json"))["front"])
    wait_for_next_frame(window)
    shown = window.locator("#comparison tbody td:nth-child(2)").nth(2).inner_text()
    assert number_in(shown) == pytest.approx(least, rel=1e-3)


def test_a_picture_of_one_robot_has_its_map_and_path(window: Page) -> None:
    alone = {name: value for name, value in CORRIDOR.items() if name != "robots"}
    open_files(window, {"robot.json": json.dumps({**alone, "cost_layer": [[1] * 7]})})
    expect(window.locator("#brought")).to_contain_text("A grid 7 cells wide and 1 high; 3 places.")
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    drawing = ElementTree.fromstring(saved(window, "SVG"))
    assert len(list(drawing.iter(f"{SVG}image"))) == 1
    front, path = drawing.iter(f"{SVG}path")
    assert (front.get("stroke"), path.get("stroke")) == ("#1e5bb8", "#c2410c")
