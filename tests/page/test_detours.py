"""Paths over a map that give up metres for cost, chosen in the form of the page."""

from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    curl_body,
    needs_chromium,
    open_files,
    shown_front,
    wait_until_planned,
)

pytestmark = needs_chromium

LABEL = "Longer paths where they cost less"


def test_paths_are_the_shortest_unless_longer_ones_are_wanted(window: Page) -> None:
    window.get_by_label("Example").select_option("Warehouse cleaning")
    wait_until_planned(window)
    box = window.get_by_label(LABEL)
    expect(box).to_be_checked()
    assert curl_body(window, "coverage")["detours"]
    with_detours = shown_front(window)["front"]
    box.uncheck()
    assert "detours" not in curl_body(window, "coverage")
    window.get_by_role("button", name="Plan").click()
    wait_until_planned(window)
    assert shown_front(window)["front"] != with_detours


def test_a_map_without_costs_of_cells_has_no_such_choice(window: Page) -> None:
    map_of_places = (
        '{"grid": [[0, 0, 0]], "cell_size": 1, "places": [[0, 0], [0, 2]],'
        ' "second_coordinates": [[0, 0], [1, 1]]}'
    )
    open_files(window, {"map.json": map_of_places})
    expect(window.get_by_text("A grid 3 cells wide and 1 high")).to_be_visible()
    expect(window.get_by_label(LABEL)).to_be_hidden()
    assert "detours" not in curl_body(window, "coverage")
