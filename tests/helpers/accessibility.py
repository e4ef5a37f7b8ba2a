"""What axe finds on a page, and whether it fits a phone."""

from typing import Any

from axe_playwright_python.base import AXE_SCRIPT
from playwright.sync_api import Page

from tests.helpers.browsing import PHONE

ALSO = ("target-size",)  # rules that axe leaves out unless they are asked for


def load_axe(page: Page) -> None:
    """Load axe into a page, once."""
    page.evaluate(AXE_SCRIPT)


def violations(page: Page, part: str = "html") -> list[Any]:
    """Return the rules that a part of a page with axe violates, as it is shown now."""
    options = {"rules": {rule: {"enabled": True} for rule in ALSO}, "resultTypes": ["violations"]}
    found: list[Any] = page.evaluate(
        "given => axe.run(...given).then(({ violations }) => violations)", [part, options]
    )
    return found


def unfold(page: Page) -> None:
    """Open everything that is folded."""
    page.evaluate("for (const each of document.querySelectorAll('details')) each.open = true")


def check_on_a_phone(page: Page, part: str) -> None:
    """Check that nothing of an unfolded page sticks out of a phone, and a part of it with axe."""
    unfold(page)
    page.set_viewport_size({"width": PHONE, "height": 900})
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE
    load_axe(page)
    assert violations(page, part) == []
