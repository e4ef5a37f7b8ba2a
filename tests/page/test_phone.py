"""The page on a phone: Plan, the stops and the examples are one touch away."""

from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    PHONE,
    needs_chromium,
    new_window,
    open_files,
    open_page,
    wait_until_planned,
)

pytestmark = needs_chromium

RING = "document.querySelector('#plane-1 .ring.start').style.transform"  # its place on the map
SCROLLED = ["scrollTo(0, 0)", "scrollTo(0, 2000)", "scrollTo(0, document.body.scrollHeight)"]


def test_plan_stays_at_the_bottom_of_a_phone_and_covers_nothing(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released, PHONE) as page:
        wait_until_planned(page)
        for scroll in SCROLLED:
            page.evaluate(scroll)
            for name in ("Plan", "Stop", "Stops and examples"):
                button = page.get_by_role("button", name=name, exact=True)
                expect(button).to_be_in_viewport(ratio=1)
        assert bottom(page, "main") <= page.evaluate("innerHeight") - height(page, ".bar")
        page.get_by_role("button", name="Stops and examples").click()
        example = page.get_by_label("Example", exact=True)
        expect(example).to_be_focused()
        expect(example).to_be_in_viewport(ratio=1)
        page.get_by_label("Seconds of planning").fill("soon")
        page.get_by_role("button", name="Plan", exact=True).click()
        fault = page.locator("#time_limit-fault")
        expect(fault).not_to_be_empty()
        shown = page.evaluate("innerHeight") - height(page, ".bar")
        assert bottom(page, "#time_limit-fault") <= shown


def test_a_stop_is_added_on_the_map_without_scrolling_and_is_seen_in_the_table(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released, PHONE) as page:
        wait_until_planned(page)
        rows = [f"order-{at},{60.1 + at / 100},{24.9 + at % 3 / 100}" for at in range(1, 27)]
        open_files(page, {"stops.csv": "\n".join(["id,lat,lon", *rows])})
        button, board = page.get_by_role("button", name="Add on the map"), page.locator("#plane-1")
        button.click()
        expect(page.locator("#place-help")).to_be_in_viewport(ratio=1)
        expect(board).to_be_in_viewport()
        box = board.bounding_box()
        assert box is not None
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.7)
        expect(page.locator("#count")).to_have_text("27 stops")
        expect(page.locator("#status")).to_have_text("Stop 27 was added.")
        expect(page.get_by_label("Name of stop 27")).to_be_in_viewport(ratio=1)
        expect(button).to_be_in_viewport(ratio=1)
        expect(button).to_have_attribute("aria-pressed", "false")


def test_a_finger_shows_all_stops_again(browser: Browser, released: str) -> None:
    """Fingers zoom maps without buttons, and lose the stops as easily."""
    size = {"width": PHONE, "height": 812}
    page = new_window(browser, viewport=size, has_touch=True, is_mobile=True)
    page.goto(released)
    wait_until_planned(page)
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
    button.tap()
    assert page.evaluate(RING) == before
    page.close()


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
