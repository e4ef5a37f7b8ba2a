"""Cost layers of a robot's map on the page: told apart, named, taken away, and what they hold."""

import json
from typing import Any

from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    copied,
    curl_body,
    needs_chromium,
    open_files,
    saved,
    shown_front,
    wait_until_planned,
)

pytestmark = needs_chromium

ROWS, COLUMNS = 6, 9
GRID = [[int(row == 0) for _ in range(COLUMNS)] for row in range(ROWS)]
NOISE = [[row * column for column in range(COLUMNS)] for row in range(ROWS)]
# Outside of obstacles it is the same everywhere.
DUST = [[7 if row == 0 else 2 for _ in range(COLUMNS)] for row in range(ROWS)]
NOTHING = [[0] * COLUMNS] * ROWS
LAYERS = [
    {"name": "noise", "layer": NOISE},
    {"name": "dust", "unit": "g", "layer": DUST},
    {"name": "people", "layer": NOTHING},
]
OFFICE: dict[str, Any] = {"grid": GRID, "cell_size": 0.5, "spacing": 1.5, "time_limit": 0.1}


def open_office(page: Page, **members: Any) -> None:
    open_files(page, {"office.json": json.dumps({**OFFICE, **members})})


def layers_of(page: Page) -> list[tuple[str, str]]:
    """Return the name of each layer in the list, and what it holds."""
    rows = page.locator("#layers-list li").all()
    named = [row.locator("input:not([type=radio]), b").first for row in rows]
    names = [each.evaluate("(shown) => shown.value ?? shown.textContent") for each in named]
    held = [row.locator(".help").inner_text() for row in rows]
    return list(zip(names, held, strict=True))


def shading(page: Page) -> str:
    address = page.locator("#grid img.cells").get_attribute("src")
    assert address
    return address


def test_each_layer_says_what_it_holds_and_whether_it_decides_nothing(window: Page) -> None:
    open_office(window, cost_layers=LAYERS)
    assert layers_of(window) == [
        ("noise", "0 to 40 a metre, 0 on 5 free cells"),
        ("dust", "2 on every free cell: it only repeats the distance"),
        ("people", "0 on every free cell: it decides nothing"),
    ]


def test_the_layer_that_shades_the_map_is_chosen_and_sent_nowhere(window: Page) -> None:
    open_office(window, cost_layers=LAYERS)
    expect(window.locator("#ground .dear")).to_have_text("more noise")
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    before, front = shading(window), shown_front(window)["id"]
    window.get_by_label("Shade the map by dust").check()
    expect(window.locator("#ground .dear")).to_have_text("more dust")
    assert shading(window) != before
    assert shown_front(window)["id"] == front  # it stays
    assert "shaded" not in curl_body(window, "coverage")


def test_axis_and_table_say_what_is_counted_of_a_layer(window: Page) -> None:
    open_office(window, cost_layers=LAYERS[:1])
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    name = "Noise \N{MULTIPLICATION SIGN} m"
    assert f">{name}<" in saved(window, "SVG").decode()
    heading = window.locator("#comparison tbody:first-of-type th").last
    expect(heading).to_have_text(f"{name}what each metre costs, added up along the way")


def test_the_compromise_has_a_line_to_its_point(window: Page) -> None:
    open_office(window, cost_layers=LAYERS[:1])
    label = window.locator(".label.knee")
    line = label.evaluate("label => getComputedStyle(label, '::after').borderRightWidth")
    assert line == "1px"


def test_a_layer_is_named(window: Page) -> None:
    open_office(window, cost_layers=LAYERS[:2])
    window.get_by_label("Name of cost layer 2").fill("dirt")
    window.get_by_label("Name of cost layer 2").press("Tab")
    assert curl_body(window, "coverage")["cost_layers"][1] == {**LAYERS[1], "name": "dirt"}
    assert '"name": "dirt"' in copied(window, "as Python")
    window.get_by_label("Name of cost layer 2").fill(" ")
    window.get_by_label("Name of cost layer 2").press("Tab")
    assert [name for name, _ in layers_of(window)] == ["noise", "dirt"]
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    expect(window.get_by_role("slider", name="Dirt")).to_be_visible()
    window.get_by_label("Name of cost layer 2").fill("noise")
    window.get_by_role("button", name="Plan", exact=True).click()
    expect(window.locator("#cost_layers-fault")).to_contain_text("noise")


def test_layers_are_taken_away_until_only_walls_are_left(window: Page) -> None:
    open_office(window, cost_layers=LAYERS, seed=7, start=1)
    window.get_by_role("button", name="Take noise away").click()
    assert [name for name, _ in layers_of(window)] == ["dust", "people"]
    body = curl_body(window, "coverage")
    assert [layer["name"] for layer in body["cost_layers"]] == ["dust", "people"]
    assert {name: body[name] for name in ("spacing", "seed", "start")} == {
        "spacing": 1.5,
        "seed": 7,
        "start": 1,
    }
    window.get_by_role("button", name="Take people away").click()
    window.get_by_role("button", name="Take dust away").click()
    body = curl_body(window, "coverage")
    assert "cost_layers" not in body
    assert [name for name, _ in layers_of(window)] == ["nearness to walls"]
    expect(window.get_by_role("button", name="Take nearness to walls away")).to_be_hidden()
    window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)


def test_robots_may_do_without_a_layer(window: Page) -> None:
    open_office(window, cost_layer=NOISE, robots=[{"id": "one"}, {"id": "two"}])
    window.locator("#layers-list .remove").click()
    expect(window.locator("#layers")).to_be_hidden()
    body = curl_body(window, "coverage")
    assert "cost_layer" not in body
    assert len(body["robots"]) == 2
    open_files(window, {"stops.csv": "id,lon,lat\na,24.9,60.1\nb,24.8,60.2\nc,24.7,60\n"})
    expect(window.locator("#layers")).to_be_hidden()
