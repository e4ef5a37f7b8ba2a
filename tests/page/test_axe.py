"""Accessibility by axe: the page, the guide and the reference, on phone, tablet and desk."""

import re
from collections.abc import Callable
from itertools import cycle
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.accessibility import Scheme, load_axe, look, unfold, violations
from tests.helpers.browsing import (
    DESK,
    PHONE,
    needs_chromium,
    open_files,
    open_page,
)
from tests.helpers.sampled import IS_WHOLE, few

TABLET, WIDE = 768, 1920

Looks = tuple[tuple[int, Scheme], ...]

# One layout is that of phones and tablets, and one that of desks: by night each in both schemes.
TWO_LOOKS: Looks = ((PHONE, "dark"), (DESK, "light"))
LOOKS: Looks = (*TWO_LOOKS, (TABLET, "light"), (WIDE, "dark")) if IS_WHOLE else TWO_LOOKS

pytestmark = needs_chromium


def test_axe_finds_nothing_on_the_page(page: Page) -> None:
    page.get_by_role("button", name="Keep to compare").click()
    unfold(page)
    assert findings(page) == []


@pytest.mark.parametrize("name", few(1, ["limits", "plan-a-front", "errors"]))
def test_axe_finds_nothing_in_the_guide(browser: Browser, released: str, name: str) -> None:
    with open_page(browser, f"{released}/guide/{name}") as page:
        assert findings(page, TWO_LOOKS) == []


def test_the_reference_needs_nothing_from_elsewhere_and_axe_finds_nothing_serious(
    browser: Browser, released: str
) -> None:
    with open_page(browser, f"{released}/docs") as page:
        plan = "POST /front Plan the front of tours through the cities given"
        expect(page.get_by_role("button", name=plan)).to_be_visible()
        expect(page.get_by_role("button", name="Authorize")).to_be_hidden()
        expect(page.locator(".authorization__btn").first).to_be_hidden()
        looks = TWO_LOOKS if IS_WHOLE else TWO_LOOKS[:1]
        found = findings(page, looks)
        assert [each for each in found if each[0] in ("serious", "critical")] == []
        page.emulate_media(color_scheme="dark")
        expect(page.locator("html.dark-mode")).to_be_visible()


def replanned(page: Page) -> None:
    page.locator("#order > summary").click()
    page.locator("#replanning > summary").click()
    page.get_by_label("Visited up to").fill(page.locator("#order li").nth(9).inner_text())
    page.get_by_role("button", name="Replan", exact=True).click()
    expect(page.locator("#legend .before")).to_be_visible()


def refused_replanning(page: Page) -> None:
    page.locator("#replanning").evaluate("details => details.open = true")
    page.get_by_label("Visited up to").fill("nowhere")
    page.get_by_role("button", name="Replan", exact=True).click()
    expect(page.locator("#replan-fault")).to_be_visible()


def refused_file(page: Page) -> None:
    table = {"name": "orders.csv", "mimeType": "text/csv", "buffer": b"name,street\nA,Mill Lane\n"}
    page.get_by_label("Open files").set_input_files([table])  # type: ignore[list-item]
    expect(page.locator("#file-fault")).to_be_in_viewport()


def opened(page: Page) -> None:
    rows = "".join(f"order-{k},24.9{k},60.1{k},{k}\n" for k in range(9))
    open_files(page, {"orders.csv": f"id,lon,lat,risk\n{rows}"})
    expect(page.locator("#count")).to_have_text("9 stops")
    expect(page.locator("#order")).to_be_hidden()


def refused_request(page: Page) -> None:
    opened(page)
    page.get_by_label("Start", exact=True).fill("nowhere")
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#start-fault")).to_be_in_viewport(ratio=1)


def service_away(page: Page) -> None:
    page.route(re.compile("/front$"), lambda route: route.abort())
    page.get_by_role("button", name="Plan", exact=True).click()
    expect(page.locator("#request-fault")).to_have_text("The service does not answer.")


# What a state changes on the page, the rest of which is that of the test above.
# Files that were opened are in the state of a request that is refused.
STATES: dict[Callable[[Page], None], str] = {
    replanned: "#result",
    refused_replanning: "#replanning",
    refused_file: "#request",
    refused_request: "#request",
    service_away: "#request",
}


def test_axe_finds_nothing_in_any_state_of_the_page(page: Page) -> None:
    for (reach, part), one in zip(STATES.items(), cycle(TWO_LOOKS), strict=False):
        page.set_viewport_size({"width": DESK, "height": 900})
        reach(page)
        looks = TWO_LOOKS if IS_WHOLE else (one,)
        assert findings(page, looks, part) == [], reach.__name__


def findings(page: Page, looks: Looks = LOOKS, part: str = "html") -> list[Any]:
    """Return what axe finds in a part of the page: impact, rule, where first, and how it looked."""
    load_axe(page)
    found = []
    for at, (width, scheme) in enumerate(looks):
        look(page, width, scheme)
        for rule in violations(page, part, seen_before=at > 0):
            where = rule["nodes"][0]["target"]
            found.append((rule["impact"], rule["id"], where, width, scheme))
    return found
