"""`python -m tests.helpers.screenshot`: write tests/page.png, the page as the README shows it.

With a folder, which must not lie in the repository, it writes every state of the page there
instead, on a phone and on a desk, in light and in dark, for somebody to look at.
"""

import argparse
import re
from collections.abc import Callable
from io import BytesIO
from itertools import product
from pathlib import Path

from PIL import Image
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    DESK,
    PHONE,
    chromium,
    open_page,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.serving import serving_released

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "tests/page.png"
COLOURS = 128  # enough for a page, in a third of the bytes


def compare_two_tours(page: Page) -> None:
    """Pin the fastest tour of the front of the first example, and select its knee."""
    wait_until_planned(page)
    page.get_by_role("slider", name="Balance").press("Home")
    page.get_by_role("button", name="Keep to compare").click()
    page.get_by_role("button", name="compromise").click()
    page.evaluate("document.activeElement.blur()")
    page.mouse.move(0, 0)


def plan_for_long(page: Page) -> None:
    """Have a search under way."""
    page.get_by_label("Seconds of planning").fill("50")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#status")).to_contain_text("improving")
    expect(page.get_by_label(re.compile("A choice of"))).to_be_visible()


def ask_for_nonsense(page: Page) -> None:
    """Have a request refused."""
    page.get_by_label("Seconds of planning").fill("soon")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#time_limit-fault")).not_to_be_empty()


def clear(page: Page) -> None:
    """Take all stops away."""
    page.get_by_role("button", name="Clear").click()
    expect(page.locator("#count")).to_have_text("0 stops")


def open_an_expired_link(page: Page) -> None:
    """Open a link to a front that the service has no more."""
    page.evaluate("location.hash = '#front=gone'")
    expect(page.locator("#request-fault")).not_to_be_empty()


# In the order in which one page passes through them.
STATES: dict[str, Callable[[Page], None]] = {
    "done": compare_two_tours,
    "error": ask_for_nonsense,
    "planning": plan_for_long,
    "empty": clear,
    "expired": open_an_expired_link,
}


def write_picture(browser: Browser, address: str) -> None:
    """Write the README's picture."""
    with open_page(browser, address) as page:
        compare_two_tours(page)
        expect(page.locator("#plane-1 canvas.streets")).to_be_visible()
        picture(page, whole=False).quantize(COLOURS).save(PICTURE, optimize=True)


def write_states(browser: Browser, address: str, folder: Path) -> None:
    """Write a picture of every state, at both widths and in both schemes."""
    for width, scheme in product((DESK, PHONE), ("light", "dark")):
        with open_page(browser, address, width, scheme) as page:  # type: ignore[arg-type]
            for name, reach in STATES.items():
                reach(page)
                picture(page).save(folder / f"{name}-{width}-{scheme}.png")


def picture(page: Page, whole: bool = True) -> Image.Image:
    """Return the page as it looks in the next frame: the whole, or what is seen at first."""
    wait_for_next_frame(page)
    return Image.open(BytesIO(page.screenshot(full_page=whole))).convert("RGB")


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser("python -m tests.helpers.screenshot", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, help="for pictures of every state")
    folder = parser.parse_args().folder
    if folder and folder.resolve().is_relative_to(ROOT):
        parser.error(f"the folder must lie outside of {ROOT}")
    with serving_released() as address, chromium() as browser:
        if folder:
            folder.mkdir(parents=True, exist_ok=True)
            write_states(browser, address, folder)
        else:
            write_picture(browser, address)


if __name__ == "__main__":
    main()
