"""Accessibility by axe: the page, the guide and the reference, on phone, tablet and desk."""

from typing import Any, Literal

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.accessibility import load_axe, unfold, violations
from tests.helpers.browsing import DESK, PHONE, needs_chromium, open_page, wait_until_planned

TABLET, WIDE = 768, 1920
SETTLED = 500  # ms after a change of the scheme
WIDTHS = (PHONE, TABLET, DESK, WIDE)
SCHEMES: tuple[Literal["light", "dark"], ...] = ("light", "dark")

pytestmark = needs_chromium


def test_axe_finds_nothing_on_the_page(browser: Browser, released: str) -> None:
    with open_page(browser, released) as page:
        wait_until_planned(page)
        page.get_by_role("button", name="Pin to compare").click()
        unfold(page)
        assert findings(page) == []


@pytest.mark.parametrize("name", ["errors", "plan-a-front"])
def test_axe_finds_nothing_in_the_guide(browser: Browser, released: str, name: str) -> None:
    with open_page(browser, f"{released}/guide/{name}") as page:
        assert findings(page) == []


def test_axe_finds_nothing_serious_in_the_reference(browser: Browser, released: str) -> None:
    with open_page(browser, f"{released}/docs") as page:
        expect(page.locator(".opblock").first).to_be_visible()
        assert [found for found in findings(page) if found[0] in ("serious", "critical")] == []
        page.emulate_media(color_scheme="dark")
        expect(page.locator("html.dark-mode")).to_be_visible()


def findings(page: Page) -> list[Any]:
    """Return what axe finds at each width, light and dark: impact, rule, and where first."""
    load_axe(page)
    found = []
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 900})
        for scheme in SCHEMES:
            page.emulate_media(color_scheme=scheme)
            page.wait_for_timeout(SETTLED)  # colours fade into one another
            for rule in violations(page):
                where = rule["nodes"][0]["target"]
                found.append((rule["impact"], rule["id"], where, width, scheme))
    return found
