"""The guide in a browser: its search, its list of pages, on a desk and on a phone."""

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.guide.pages import GUIDE
from tests.helpers.browsing import (
    CLIPBOARD,
    DESK,
    PHONE,
    needs_chromium,
    note_texts,
    noted_texts,
    open_page,
)

PAGES = [path.stem for path in GUIDE.glob("*.md") if path.stem != "index"]
WIDEST = ["plan-a-front", "errors", "how-the-code-is-laid-out"]
PROSE = 200  # pixels for a cell of many words
# By page, shown in place of the one that is open: its width, and that of its narrowest prose.
WIDTHS = """async names => {
  const widths = {};
  for (const name of names) {
    const html = await (await fetch(name)).text();
    document.body.replaceWith(new DOMParser().parseFromString(html, "text/html").body);
    const prose = [...document.querySelectorAll(".prose")].map(each => each.clientWidth);
    widths[name] = [document.documentElement.scrollWidth, Math.min(9999, ...prose)];
  }
  return widths;
}"""
WITHOUT_CLIPBOARD = "Object.defineProperty(navigator, 'clipboard', { value: undefined })"

pytestmark = needs_chromium


def test_the_search_finds_a_section_and_opens_it(browser: Browser, released: str) -> None:
    with open_page(browser, f"{released}/guide/") as page:
        page.keyboard.press("/")
        page.keyboard.type("repeat safely")
        first = page.locator("#found a").first
        expect(first).to_contain_text("Repeat a request safely")
        page.keyboard.press("ArrowDown")
        expect(first).to_be_focused()
        page.keyboard.press("Enter")
        expect(page.get_by_role("heading", name="Repeat a request safely")).to_be_in_viewport()
        expect(page.locator("nav [aria-current]")).to_have_text("How do I follow a long job?")


def test_words_that_no_page_has_are_answered_so(browser: Browser, released: str) -> None:
    with open_page(browser, f"{released}/guide/limits") as page:
        page.get_by_role("searchbox").fill("hippopotamus")
        expect(page.locator("#found")).to_have_text("No page has all of these words.")
        page.keyboard.press("Escape")
        expect(page.locator("#found")).to_be_hidden()


@pytest.mark.parametrize("width", [DESK, PHONE])
def test_all_pages_are_listed(browser: Browser, released: str, width: int) -> None:
    with open_page(browser, f"{released}/guide/errors", width) as page:
        assert page.evaluate("document.documentElement.scrollWidth") == width
        listed = page.get_by_role("navigation", name="Guide")
        if width == PHONE:
            page.get_by_text("All pages").click()
        expect(listed.get_by_role("link").first).to_be_visible()


@pytest.mark.parametrize(("width", "names"), [(DESK, WIDEST), (PHONE, PAGES)])
def test_no_page_scrolls_sideways(
    browser: Browser, released: str, width: int, names: list[str]
) -> None:
    with open_page(browser, f"{released}/guide/", width) as page:
        assert page.evaluate("document.documentElement.scrollWidth") == width  # of the index
        for name, (reached, narrowest) in page.evaluate(WIDTHS, names).items():
            assert reached == width, name
            assert width == DESK or narrowest >= PROSE, name


def test_a_wide_table_is_scrolled_by_keys_in_its_own_box(browser: Browser, released: str) -> None:
    with open_page(browser, f"{released}/guide/run-it-in-production", PHONE) as page:
        table = page.get_by_role("region", name="Table: Settings")
        table.focus()
        page.keyboard.press("ArrowRight")
        page.wait_for_function("table => table.scrollLeft > 0", arg=table.element_handle())
        assert page.evaluate("scrollX") == 0


@pytest.mark.parametrize("has_clipboard", [True, False])
def test_a_button_copies_a_block_of_code_by_keys(
    browser: Browser, released: str, has_clipboard: bool
) -> None:
    page = browser.new_page(
        viewport={"width": PHONE, "height": 900}, permissions=CLIPBOARD if has_clipboard else []
    )
    page.goto(f"{released}/guide/train-your-own-actor")
    if not has_clipboard:  # as where the connection is not safe
        page.evaluate(WITHOUT_CLIPBOARD)
    block = page.locator(".block").first
    button = block.get_by_role("button")
    assert not overlaps(page, ".block code", ".block button")
    said = page.locator("#copied")
    for part in (button, said):
        note_texts(part)
    button.focus()
    page.keyboard.press("Enter")
    page.wait_for_function("part => part.noted.length > 1", arg=said.element_handle())
    assert (noted_texts(button), noted_texts(said)) == (["Copied", "Copy"], ["Copied", ""])
    expect(button).to_be_focused()
    search = page.get_by_role("searchbox")
    search.focus()
    page.keyboard.press("Control+v")
    expect(search).to_have_value(block.locator("code").inner_text().strip())
    page.close()


def overlaps(page: Page, one: str, other: str) -> bool:
    """Return whether the first elements of two selectors cover each other."""
    first, second = (page.locator(each).first.bounding_box() for each in (one, other))
    assert first is not None
    assert second is not None
    return (
        first["y"] < second["y"] + second["height"] and second["y"] < first["y"] + first["height"]
    )
