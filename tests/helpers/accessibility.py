"""What axe finds on a page, and whether it fits a phone."""

from collections.abc import Collection
from typing import Any

from axe_playwright_python.base import AXE_SCRIPT
from playwright.sync_api import Page

from tests.helpers.browsing import PHONE

COLOURS = ("color-contrast", "link-in-text-block")  # rules that take axe most of its time
ALSO = ("target-size",)  # rules that axe leaves out unless they are asked for


def load_axe(page: Page) -> None:
    """Load axe into a page, once."""
    page.evaluate(AXE_SCRIPT)


def violations(page: Page, without: Collection[str] = ()) -> list[Any]:
    """Return the rules that a page with axe violates, as it is shown now, without some of them."""
    rules = {rule: {"enabled": rule not in without} for rule in (*ALSO, *without)}
    found: list[Any] = page.evaluate(
        "rules => axe.run({ rules }).then(({ violations }) => violations)", rules
    )
    return found


def unfold(page: Page) -> None:
    """Open everything that is folded."""
    page.evaluate("for (const each of document.querySelectorAll('details')) each.open = true")


def check_on_a_phone(page: Page) -> None:
    """Check that nothing of an unfolded page sticks out of a phone, and that axe finds nothing."""
    unfold(page)
    page.set_viewport_size({"width": PHONE, "height": 900})
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE
    load_axe(page)
    assert violations(page) == []
