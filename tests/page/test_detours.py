"""Paths over a map that give up metres for cost, chosen in the form of the page."""

from playwright.sync_api import Browser, expect

from tests.helpers.browsing import (
    curl_body,
    needs_chromium,
    open_files,
    open_page,
    shown_front,
    wait_until_planned,
    wait_until_read,
)

pytestmark = needs_chromium

LABEL = "Longer paths where they cost less"


def test_paths_are_the_shortest_unless_longer_ones_are_wanted(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released) as page:
        wait_until_planned(page)
        page.get_by_label("Example").select_option("Warehouse cleaning")
        wait_until_planned(page)
        box = page.get_by_label(LABEL)
        expect(box).to_be_checked()
        assert curl_body(page, "coverage")["detours"]
        with_detours = shown_front(page)["front"]
        box.uncheck()
        assert "detours" not in curl_body(page, "coverage")
        page.get_by_role("button", name="Plan").click()
        wait_until_planned(page)
        assert shown_front(page)["front"] != with_detours


def test_a_map_without_costs_of_cells_has_no_such_choice(browser: Browser, released: str) -> None:
    with open_page(browser, released) as page:
        wait_until_planned(page)
        expect(page.get_by_label(LABEL)).to_be_hidden()
        map_of_places = (
            '{"grid": [[0, 0, 0]], "cell_size": 1, "places": [[0, 0], [0, 2]],'
            ' "second_coordinates": [[0, 0], [1, 1]]}'
        )
        open_files(page, {"map.json": map_of_places})
        wait_until_read(page)
        expect(page.get_by_text("A grid 3 cells wide and 1 high")).to_be_visible()
        expect(page.get_by_label(LABEL)).to_be_hidden()
        assert "detours" not in curl_body(page, "coverage")
