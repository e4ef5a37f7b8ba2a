"""The page before a service that is not ready, or wants to know who calls."""

import time
from pathlib import Path

from playwright.sync_api import Browser, Page, Route, expect

from service.api.app import Edge
from service.api.auth import Access
from service.api.keys import KeyHash, new_key
from service.settings import Settings
from tests.helpers.browsing import (
    FREE,
    SECOND,
    know,
    needs_chromium,
    open_files,
    open_page,
    wait_until_planned,
)
from tests.helpers.serving import app_of, runner_of, serving, workers_of

LIMITS = Settings().limits
STOPS = {"stops.csv": "id,lon,lat\na,24.9,60.1\nb,24.8,60.2\n"}

pytestmark = needs_chromium


def late(route: Route) -> None:
    """Let a request come as late as on a busy machine: the page looks at the job meanwhile."""
    time.sleep(0.7)
    route.continue_()


def test_the_page_asks_for_a_key_and_says_that_the_service_warms_up(
    browser: Browser, tmp_path: Path
) -> None:
    """It uses the key for files as well, and goes on by itself."""
    warm = tmp_path / "warm"
    workers = workers_of(runner_of(limits=LIMITS, warm=warm))
    key, digest = new_key()
    access = Access([KeyHash(caller="dispatch", digest=digest)])
    app = app_of(workers=workers, limits=LIMITS, edge=Edge(access=access))
    with serving(app, warm=False) as address, open_page(browser, "about:blank") as page:
        page.route("**/events", late)
        page.goto(address)
        enter_a_key(page, key)
        status = page.locator("#status")
        expect(status).to_contain_text("The search is being compiled")
        page.wait_for_timeout(SECOND)
        expect(status).to_contain_text("The search is being compiled")
        expect(page.get_by_role("button", name="Stop", exact=True)).to_be_enabled()
        warm.touch()
        wait_until_planned(page)
        expect(page.locator("#key-fault")).to_be_empty()
        expect(page.get_by_label("A choice of")).to_be_visible()
        open_files(page, STOPS)
        expect(page.locator("#count")).to_have_text("2 stops")


def enter_a_key(page: Page, key: str) -> None:
    """Enter none, a wrong one, and the one that the service knows."""
    field = page.get_by_label("API key")
    expect(page.locator("#key-fault")).to_contain_text("key")
    expect(field).to_be_focused()
    with page.expect_response("**/files") as answered:
        open_files(page, STOPS)
    assert answered.value.status == 401
    expect(page.locator("#key-fault")).to_contain_text("key")
    field.fill("nobody's")
    field.press("Enter")
    expect(page.locator("#key-fault")).to_contain_text("key")
    expect(page.locator("#status")).to_be_empty()
    field.fill(key)
    field.press("Enter")


def test_the_page_says_that_the_service_is_away_when_it_opens(
    browser: Browser, released: str
) -> None:
    with open_page(browser, released + FREE) as page:
        know(page, {"examples/index.json": None})
        page.goto(released)
        expect(page.locator("#request-fault")).to_have_text("The service does not answer.")
        expect(page.locator("#status")).to_be_empty()
