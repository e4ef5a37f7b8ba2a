"""Changes of stops and vehicles are taken back, and made again."""

import pytest
from playwright.sync_api import Page, expect

from tests.helpers.browsing import (
    needs_chromium,
    open_files,
    wait_until_planned,
)

pytestmark = needs_chromium

FLEET = "id,lat,lon,demand\ndepot,60.1,24.9,0\n" + "".join(
    f"order-{k},{60.1 + k / 100},{24.9 + k % 3 / 50},{k}\n" for k in range(1, 6)
)


@pytest.fixture
def page(window: Page) -> Page:
    """The page with a depot and five orders."""
    open_files(window, {"orders.csv": FLEET})
    expect(window.get_by_label("Demand of order-2", exact=True)).to_have_value("2")
    return window


def undo(page: Page) -> None:
    page.get_by_role("button", name="Undo").click()


def write(page: Page, label: str, text: str) -> None:
    field = page.get_by_label(label, exact=True)
    field.fill(text)
    field.press("Tab")


def test_each_change_of_stops_is_taken_back_and_made_again(page: Page) -> None:
    count = page.locator("#count")
    write(page, "Demand of order-2", "7")
    page.get_by_role("button", name="Delete order-4").click()
    expect(count).to_have_text("5 stops")
    page.get_by_role("button", name="Clear").click()
    expect(count).to_have_text("0 stops")
    undo(page)
    expect(count).to_have_text("5 stops")
    page.keyboard.press("Control+z")
    expect(count).to_have_text("6 stops")
    page.keyboard.press("Control+Shift+Z")
    expect(count).to_have_text("5 stops")
    undo(page)
    undo(page)
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("2")
    page.keyboard.press("Control+y")
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("7")


def test_the_settings_of_now_stay_when_a_change_is_taken_back(page: Page) -> None:
    write(page, "Demand of order-2", "7")
    write(page, "Seconds of planning", "4")
    undo(page)
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("2")
    expect(page.get_by_label("Seconds of planning")).to_have_value("4")


def test_text_that_is_being_typed_is_taken_back_by_the_browser(page: Page) -> None:
    write(page, "Demand of order-2", "7")
    field = page.get_by_label("Demand of order-3", exact=True)
    field.press_sequentially("5")
    field.press("Control+z")
    expect(field).to_have_value("3")
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("7")


def test_a_plan_is_shown_again_with_its_stops(page: Page) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    said = page.locator("#status").inner_text()
    page.get_by_role("button", name="Delete order-4").click()
    expect(page.locator("#status")).not_to_have_text(said)
    page.keyboard.press("Control+z")
    expect(page.locator("#status")).to_have_text(said)
    expect(page.locator("#count")).to_have_text("6 stops")


def test_opening_a_file_or_an_example_is_taken_back(page: Page) -> None:
    write(page, "Demand of order-2", "7")
    open_files(page, {"others.csv": FLEET.replace("order", "other")})
    expect(page.get_by_label("Demand of other-2", exact=True)).to_have_value("2")
    undo(page)
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("7")
    expect(page.locator("#file-notes")).to_be_empty()
    page.get_by_label("Example", exact=True).select_option("City deliveries")
    expect(page.locator("#count")).to_have_text("61 stops")
    undo(page)
    expect(page.get_by_label("Demand of order-2", exact=True)).to_have_value("7")
    expect(page.get_by_label("Example", exact=True)).to_have_value("")
    page.keyboard.press("Control+y")
    expect(page.get_by_label("Example", exact=True)).not_to_have_value("")
