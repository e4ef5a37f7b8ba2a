"""The guide in a browser: its search, its list of pages, on a desk and on a phone."""

import pytest
from playwright.sync_api import Browser, expect

from tests.helpers.browsing import DESK, PHONE, needs_chromium, open_page

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
@pytest.mark.parametrize("name", ["", "plan-a-front", "errors", "how-the-code-is-laid-out"])
def test_nothing_sticks_out(browser: Browser, released: str, width: int, name: str) -> None:
    with open_page(browser, f"{released}/guide/{name}", width) as page:
        assert page.evaluate("document.documentElement.scrollWidth") == width
        listed = page.get_by_role("navigation", name="Guide")
        if width == PHONE:
            page.get_by_text("All pages").click()
        expect(listed.get_by_role("link").first).to_be_visible()
