"""One browser for all tests of the page, and the page in it with an example in planes planned."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import DESK, chromium, open_page, wait_until_planned


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium, which ends with these tests, since others run event loops of their own."""
    with chromium() as browser:
        yield browser


@pytest.fixture
def width() -> int:
    """The width of the window in pixels; a test at several widths is parametrised by them."""
    return DESK


@pytest.fixture
def page(width: int, browser: Browser, released: str) -> Iterator[Page]:
    """The page with its example of two planes planned."""
    with open_page(browser, released, width) as page:
        # The example that the page opens with is left before it is planned, which takes seconds.
        page.get_by_label("Example").select_option("City deliveries")
        expect(page.locator("#count")).to_have_text("61 stops")
        wait_until_planned(page)
        yield page
