"""What axe finds on a page, and whether it fits a phone."""

from typing import Any, Literal

from axe_playwright_python.base import AXE_SCRIPT
from playwright.sync_api import Page

from tests.helpers.browsing import PHONE, wait_for_next_frame

Scheme = Literal["light", "dark"]

ALSO = ("target-size",)  # rules that axe leaves out unless they are asked for
# Ends once colours have faded into one another.
SETTLED = """() => Promise.all(document.getAnimations()
  .filter(({ effect }) => effect.getComputedTiming().endTime < Infinity)
  .map(({ finished }) => finished.catch(() => {})))"""


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


def look(page: Page, width: int, scheme: Scheme) -> None:
    """Show a page at a width of the window and in a colour scheme, and wait until it is shown."""
    page.set_viewport_size({"width": width, "height": 900})
    page.emulate_media(color_scheme=scheme)
    wait_for_next_frame(page)
    page.evaluate(SETTLED)


def found_on_desk_and_phone(page: Page, *parts: str) -> list[str]:
    """Return the rules that parts of a page violate, on a desk and in the dark on a phone."""
    load_axe(page)
    size = page.viewport_size
    assert size is not None
    found = []
    looks: tuple[tuple[int, Scheme], ...] = ((size["width"], "light"), (PHONE, "dark"))
    for width, scheme in looks:
        look(page, width, scheme)
        found += [each["id"] for part in parts for each in violations(page, part)]
    page.emulate_media(color_scheme="light")
    page.set_viewport_size(size)
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
