"""The page on a phone: Plan, the stops and the examples are one touch away."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    FREE,
    PHONE,
    needs_chromium,
    open_files,
    open_page,
    wait_until_planned,
)
from tests.helpers.touch import tap, touched

pytestmark = needs_chromium

RING = "document.querySelector('#plane-1 .ring.start').style.transform"  # its place on the map
SCROLLED = ["scrollTo(0, 0)", "scrollTo(0, 2000)", "scrollTo(0, document.body.scrollHeight)"]


@pytest.fixture(scope="module")
def phone(browser: Browser, released: str) -> Iterator[Page]:
    """The page as it opens on a phone."""
    with open_page(browser, released, PHONE) as page:
        wait_until_planned(page)
        yield page


def test_plan_stays_at_the_bottom_of_a_phone_and_covers_nothing(phone: Page) -> None:
    for scroll in SCROLLED:
        phone.evaluate(scroll)
        for name in ("Plan", "Stop", "Stops and examples"):
            button = phone.get_by_role("button", name=name, exact=True)
            expect(button).to_be_in_viewport(ratio=1)
    assert bottom(phone, "main") <= phone.evaluate("innerHeight") - height(phone, ".bar")
    phone.get_by_role("button", name="Stops and examples").click()
    example = phone.get_by_label("Example", exact=True)
    expect(example).to_be_focused()
    expect(example).to_be_in_viewport(ratio=1)
    phone.get_by_label("Seconds of planning").fill("soon")
    phone.get_by_role("button", name="Plan", exact=True).click()
    fault = phone.locator("#time_limit-fault")
    expect(fault).not_to_be_empty()
    shown = phone.evaluate("innerHeight") - height(phone, ".bar")
    assert bottom(phone, "#time_limit-fault") <= shown


def test_a_stop_is_added_on_the_map_without_scrolling_and_is_seen_in_the_table(
    phone: Page,
) -> None:
    rows = [f"order-{at},{60.1 + at / 100},{24.9 + at % 3 / 100}" for at in range(1, 27)]
    open_files(phone, {"stops.csv": "\n".join(["id,lat,lon", *rows])})
    button, board = phone.get_by_role("button", name="Add on the map"), phone.locator("#plane-1")
    button.click()
    expect(phone.locator("#place-help")).to_be_in_viewport(ratio=1)
    expect(board).to_be_in_viewport()
    box = board.bounding_box()
    assert box is not None
    phone.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.7)
    expect(phone.locator("#count")).to_have_text("27 stops")
    expect(phone.locator("#status")).to_have_text("Stop 27 was added.")
    expect(phone.get_by_label("Name of stop 27")).to_be_in_viewport(ratio=1)
    expect(button).to_be_in_viewport(ratio=1)
    expect(button).to_have_attribute("aria-pressed", "false")


def test_a_finger_shows_all_stops_again(browser: Browser, released: str) -> None:
    """Fingers zoom maps without buttons, and lose the stops as easily."""
    with open_page(browser, released + FREE, PHONE) as page, touched(page, is_phone=True):
        page.goto(released)
        wait_until_planned(page)
        check_button_for_fingers(page)


def check_button_for_fingers(page: Page) -> None:
    button = page.get_by_role("button", name="Show all stops").first
    expect(button).to_be_visible()
    expect(page.get_by_role("button", name="Zoom in")).to_have_count(0)
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE
    caption = page.locator("figcaption", has=button)
    box, room = button.bounding_box(), caption.bounding_box()
    assert box is not None
    assert room is not None
    assert room["x"] <= box["x"]
    assert box["x"] + box["width"] <= room["x"] + room["width"] + 1
    before = page.evaluate(RING)
    page.locator("#plane-1").focus()
    page.keyboard.press("Shift+=")
    assert page.evaluate(RING) != before
    button.scroll_into_view_if_needed()
    box = button.bounding_box()
    assert box is not None
    tap(page, (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2))
    page.wait_for_function(f"before => {RING} === before", arg=before)  # a tap is a click later


def test_a_desk_has_no_button_that_leads_to_the_stops(planned: Page) -> None:
    expect(planned.get_by_role("button", name="Stops and examples")).to_be_hidden()


def bottom(page: Page, place: str) -> float:
    box = page.locator(place).bounding_box()
    assert box is not None
    return box["y"] + box["height"]


def height(page: Page, place: str) -> float:
    box = page.locator(place).bounding_box()
    assert box is not None
    return box["height"]
