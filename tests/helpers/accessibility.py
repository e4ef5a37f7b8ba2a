"""What axe finds on a page, and whether it fits a phone."""

from typing import Any, Literal

from axe_playwright_python.base import AXE_SCRIPT
from playwright.sync_api import Page

from tests.helpers.browsing import PHONE, wait_for_next_frame
from tests.helpers.sampled import IS_WHOLE

Scheme = Literal["light", "dark"]

ALSO = ("target-size",)  # rules that axe leaves out unless they are asked for
# What depends on width and colours. The other rules, which take as long again, are of the elements
# that there are: of several looks at the same state only the first has them, but by night.
OF_LOOKS = ["color-contrast", "link-in-text-block", "scrollable-region-focusable", "target-size"]
# What stands behind others of its kind in tables, lists and lanes, which is looked at by night.
BEHIND = (
    "#stops tr:nth-child(n+5)",
    "#vehicles tr:nth-child(n+5)",
    "#fleet-lanes .visit:nth-child(n+9)",
    "li:nth-child(n+9)",
)
ALIKE = [] if IS_WHOLE else [[selector] for selector in BEHIND]
# Ends once colours have faded into one another.
SETTLED = """() => Promise.all(document.getAnimations()
  .filter(({ effect }) => effect.getComputedTiming().endTime < Infinity)
  .map(({ finished }) => finished.catch(() => {})))"""

UNFOLD = """for (const each of document.querySelectorAll("details:not([open])"))
  Object.assign(each, { open: true }).dataset.unfolded = "";"""
FOLD = """for (const each of document.querySelectorAll("[data-unfolded]")) {
  each.open = false;
  delete each.dataset.unfolded;
}"""


def load_axe(page: Page) -> None:
    """Load axe into a page, once."""
    page.evaluate(AXE_SCRIPT)


def violations(page: Page, *parts: str, seen_before: bool = False) -> list[Any]:
    """Return the rules that a page with axe, or parts of it, violate as they are shown now.

    Of rows that are alike, only the first are looked at, but for the whole suite by night. Where
    the same was seen at another width or in other colours, the rules that depend on these are left.
    """
    context = {"include": [[part] for part in parts or ("html",)], "exclude": ALIKE}
    # No rule needs the text of style sheets, which axe would fetch once more.
    options: dict[str, Any] = {"resultTypes": ["violations"], "preload": False}
    if seen_before and not IS_WHOLE:
        options["runOnly"] = {"type": "rule", "values": OF_LOOKS}
    else:
        options["rules"] = {rule: {"enabled": True} for rule in ALSO}
    found: list[Any] = page.evaluate(
        "given => axe.run(...given).then(({ violations }) => violations)", [context, options]
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
    for at, (width, scheme) in enumerate(looks):
        look(page, width, scheme)
        found += [each["id"] for each in violations(page, *parts, seen_before=at > 0)]
    page.emulate_media(color_scheme="light")
    page.set_viewport_size(size)
    return found


def unfold(page: Page) -> None:
    """Open everything that is folded."""
    page.evaluate(UNFOLD)


def fold(page: Page) -> None:
    """Fold again what was unfolded."""
    page.evaluate(FOLD)


def check_on_a_phone(page: Page, part: str) -> None:
    """Check that nothing of an unfolded page sticks out of a phone, and a part of it with axe."""
    size = page.viewport_size
    assert size is not None
    unfold(page)
    page.set_viewport_size({"width": PHONE, "height": 900})
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE
    load_axe(page)
    assert violations(page, part) == []
    fold(page)
    page.set_viewport_size(size)
