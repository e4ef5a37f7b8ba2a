"""Cost layers of a robot's map on the page: told apart, named, taken away, and what they hold."""

import json
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    copied,
    curl_body,
    needs_chromium,
    open_files,
    open_page,
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


@pytest.fixture(scope="module")
def opened(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all of these tests, each of which opens its own request."""
    with open_page(browser, released) as page:
        wait_until_planned(page)
        yield page


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


def test_each_layer_says_what_it_holds_and_whether_it_decides_nothing(opened: Page) -> None:
    open_office(opened, cost_layers=LAYERS)
    assert layers_of(opened) == [
        ("noise", "0 to 40 a metre, 0 on 5 free cells"),
        ("dust", "2 on every free cell: it only repeats the distance"),
        ("people", "0 on every free cell: it decides nothing"),
    ]


def test_the_layer_that_shades_the_map_is_chosen_and_sent_nowhere(opened: Page) -> None:
    open_office(opened, cost_layers=LAYERS)
    expect(opened.locator("#ground .dear")).to_have_text("more noise")
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    before, front = shading(opened), shown_front(opened)["id"]
    opened.get_by_label("Shade the map by dust").check()
    expect(opened.locator("#ground .dear")).to_have_text("more dust")
    assert shading(opened) != before
    assert shown_front(opened)["id"] == front  # it stays
    assert "shaded" not in curl_body(opened, "coverage")


def test_a_layer_is_named(opened: Page) -> None:
    open_office(opened, cost_layers=LAYERS[:2])
    opened.get_by_label("Name of cost layer 2").fill("dirt")
    opened.get_by_label("Name of cost layer 2").press("Tab")
    assert curl_body(opened, "coverage")["cost_layers"][1] == {**LAYERS[1], "name": "dirt"}
    assert '"name": "dirt"' in copied(opened, "as Python")
    opened.get_by_label("Name of cost layer 2").fill(" ")
    opened.get_by_label("Name of cost layer 2").press("Tab")
    assert [name for name, _ in layers_of(opened)] == ["noise", "dirt"]
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)
    expect(opened.get_by_role("slider", name="Dirt")).to_be_visible()
    opened.get_by_label("Name of cost layer 2").fill("noise")
    opened.get_by_role("button", name="Plan", exact=True).click()
    expect(opened.locator("#cost_layers-fault")).to_contain_text("noise")


def test_layers_are_taken_away_until_only_walls_are_left(opened: Page) -> None:
    open_office(opened, cost_layers=LAYERS, seed=7, start=1)
    opened.get_by_role("button", name="Take noise away").click()
    assert [name for name, _ in layers_of(opened)] == ["dust", "people"]
    body = curl_body(opened, "coverage")
    assert [layer["name"] for layer in body["cost_layers"]] == ["dust", "people"]
    assert {name: body[name] for name in ("spacing", "seed", "start")} == {
        "spacing": 1.5,
        "seed": 7,
        "start": 1,
    }
    opened.get_by_role("button", name="Take people away").click()
    opened.get_by_role("button", name="Take dust away").click()
    body = curl_body(opened, "coverage")
    assert "cost_layers" not in body
    assert [name for name, _ in layers_of(opened)] == ["nearness to walls"]
    expect(opened.get_by_role("button", name="Take nearness to walls away")).to_be_hidden()
    opened.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(opened)


def test_robots_may_do_without_a_layer(opened: Page) -> None:
    open_office(opened, cost_layer=NOISE, robots=[{"id": "one"}, {"id": "two"}])
    opened.locator("#layers-list .remove").click()
    expect(opened.locator("#layers")).to_be_hidden()
    body = curl_body(opened, "coverage")
    assert "cost_layer" not in body
    assert len(body["robots"]) == 2
    open_files(opened, {"stops.csv": "id,lon,lat\na,24.9,60.1\nb,24.8,60.2\nc,24.7,60\n"})
    expect(opened.locator("#layers")).to_be_hidden()
