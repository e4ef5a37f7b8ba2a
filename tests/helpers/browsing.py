"""Debian's Chromium, and the page in it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal

from playwright.sync_api import Browser, Page, expect, sync_playwright

WITHOUT = "these need Debian's Chromium: apt-get install chromium"
CHROMIUM = Path("/usr/bin/chromium")
DESK, PHONE = 1440, 375
SECOND = 1000.0  # in milliseconds, as the browser counts


@contextmanager
def chromium() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        yield playwright.chromium.launch(executable_path=CHROMIUM)


@contextmanager
def opened(
    browser: Browser,
    address: str,
    width: int = DESK,
    scheme: Literal["light", "dark"] = "light",
) -> Iterator[Page]:
    """The page in a window; whatever the browser complains of is a failure."""
    page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
    page.goto(address)
    yield page
    page.close()
    # Chromium writes a line for each refusal of the service, which the page has shown.
    assert [each for each in complaints if "server responded with a status of" not in each] == []


def done(page: Page) -> None:
    """Waits until what is being planned is planned."""
    expect(page.locator("#status")).to_contain_text("Done", timeout=60 * SECOND)


def drawn(page: Page) -> None:
    """Waits for the next frame, in which the page draws what was asked of it in this one."""
    page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
