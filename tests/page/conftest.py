"""One browser for all tests of the page."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from tests.helpers.browsing import chromium


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium, which ends with these tests, since others run event loops of their own."""
    with chromium() as browser:
        yield browser
