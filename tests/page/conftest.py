"""One browser for all tests of the page, and the page in it with an example in planes planned."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    DESK,
    FEW_THREADS,
    chromium,
    copied,
    open_link,
    open_unplanned,
    plan_city_deliveries,
)
from tests.helpers.node import Node, node_process


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium, which ends with these tests, since others run event loops of their own."""
    with chromium(*FEW_THREADS) as browser:
        yield browser


@pytest.fixture(scope="package")
def node() -> Iterator[Node]:
    """A process of Node for modules of the page that need no document."""
    with node_process() as node:
        yield node


@pytest.fixture(scope="package")
def planned(browser: Browser, released: str) -> Iterator[Page]:
    """The page with its example of two planes planned, in one window for all tests that only look.

    They may select tours; stops, fields and front stay as they are.
    """
    with open_unplanned(browser, released) as page:
        plan_city_deliveries(page)
        yield page


@pytest.fixture(scope="package")
def link(planned: Page) -> str:
    """The link to that front with its stops, by which a page shows it without planning it again."""
    return copied(planned, "link")


@pytest.fixture(scope="package")
def other(browser: Browser, released: str) -> Iterator[Page]:
    """A window in which others have opened links, for tests that open one of theirs there."""
    with open_unplanned(browser, released) as page:
        yield page


@pytest.fixture(scope="module")
def window(browser: Browser, released: str) -> Iterator[Page]:
    """A page for all tests of a module, each of which opens its own stops."""
    with open_unplanned(browser, released) as page:
        yield page


@pytest.fixture
def page(window: Page, link: str) -> Iterator[Page]:
    """The page with its example of two planes planned, to do anything with."""
    window.set_viewport_size({"width": DESK, "height": 900})
    window.emulate_media(color_scheme="light")
    open_link(window, link)
    expect(window.locator("#count")).to_have_text("61 stops")
    yield window
    window.unroute_all()
