"""What a tab shows is there after a reload and the guide, and once a change is taken back."""

import pytest
from playwright.sync_api import Browser, Error, Page, expect

from tests.helpers.browsing import (
    FREE,
    needs_chromium,
    open_files,
    open_page,
    open_unplanned,
    running_first,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.sampled import few

pytestmark = needs_chromium

TOUR = "id,x,y,u,v\n" + "".join(f"order-{k},{k},{k % 3},{k % 4},{k % 5}\n" for k in range(9))
FLEET = "id,lat,lon,demand\ndepot,60.1,24.9,0\n" + "".join(
    f"order-{k},{60.1 + k / 100:.2f},{24.9 + k % 3 / 50:.2f},{k}\n" for k in range(1, 9)
)
NOTHING_KEPT = (
    "Object.defineProperty(window, 'sessionStorage', { get() { throw new Error('none'); } })"
)
# As many characters as a tab may keep.
FILL = """
let text = "x".repeat(8 << 20);
for (let at = 0; text; text = text.slice(text.length / 2 + 0.5)) {
  try { sessionStorage.setItem(at++, text); text = "x".repeat(text.length * 2); } catch {}
}
"""


@pytest.fixture(params=few(1, [FLEET, TOUR]), ids=few(1, ["fleet", "tour"]))
def own(request: pytest.FixtureRequest) -> str:
    """A file of nine stops that somebody brings."""
    text: str = request.param
    return text


def plan(page: Page) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)


def choice(page: Page) -> str:
    wait_for_next_frame(page)
    return page.locator("#choice").inner_text()


@pytest.fixture
def page(own: str, window: Page) -> Page:
    """The page with those stops planned."""
    open_files(window, {"orders.csv": own})
    plan(window)
    return window


def write(page: Page, text: str) -> str:
    """Write into the first number of the third stop, and return what was there."""
    cell = page.locator('#stops [data-row="2"][data-column="0"]')
    before = cell.input_value()
    cell.fill(text)
    cell.press("Tab")
    return before


def test_a_plan_is_there_after_a_reload(page: Page) -> None:
    write(page, "24.91")
    plan(page)
    chosen = choice(page)
    sent: list[str] = []
    page.on("request", lambda each: sent.append(each.method))
    page.reload()
    wait_until_planned(page)
    expect(page.locator("#count")).to_have_text("9 stops")
    assert write(page, "24.91") == "24.91"
    assert choice(page) == chosen
    assert "POST" not in sent


def test_stops_without_a_plan_are_there_after_the_guide(
    own: str, browser: Browser, released: str
) -> None:
    with open_unplanned(browser, released) as page:
        open_files(page, {"orders.csv": own})
        page.get_by_role("link", name="Guide", exact=True).click()
        page.wait_for_url("**/guide/")
        page.goto(released)
        expect(page.locator("#count")).to_have_text("9 stops")
        expect(page.get_by_role("button", name="Copy link")).to_be_disabled()


def test_a_tab_left_before_anything_is_shown_opens_an_example(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released) as page:
        page.goto(released, wait_until="commit")
        page.goto(released)
        expect(page.locator("#count")).to_have_text("60 stops")
        expect(page.locator("#example")).not_to_have_value("")


def test_leaving_asks_first_where_a_browser_cannot_keep_so_much(
    browser: Browser, released: str
) -> None:
    with open_unplanned(browser, released) as page:
        open_files(page, {"orders.csv": TOUR})
        page.evaluate(FILL)
        with page.expect_event("dialog") as asked:
            page.evaluate("setTimeout(() => location.reload())")
        assert asked.value.type == "beforeunload"
        asked.value.dismiss()
        expect(page.locator("#count")).to_have_text("9 stops")


def test_a_browser_that_keeps_nothing_shows_the_page_all_the_same(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released + FREE) as page:
        with running_first(page, NOTHING_KEPT):
            page.goto(released)
            wait_until_planned(page)
            with pytest.raises(Error, match="none"):
                page.evaluate("sessionStorage")
            page.reload()
            expect(page.locator("#count")).to_have_text("60 stops")
        page.goto(released + FREE)


def test_a_plan_stays_while_a_typo_is_mended_and_is_there_again_once_a_change_is_taken_back(
    page: Page,
) -> None:
    chosen, said = choice(page), page.locator("#status").inner_text()
    write(page, write(page, "25x"))
    expect(page.locator("#status")).to_have_text(said)
    assert choice(page) == chosen
    before = write(page, "25.5")
    expect(page.locator("#status")).not_to_have_text(said)
    expect(page.get_by_role("button", name="Copy link")).to_be_disabled()
    write(page, before)
    expect(page.locator("#status")).to_have_text(said)
    assert choice(page) == chosen
