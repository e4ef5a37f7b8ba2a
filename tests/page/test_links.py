"""Links that the page copies: they open the same front in another window."""

import json
import re

import numpy as np
from playwright.sync_api import Browser, Page, expect

from tests.helpers.browsing import (
    copied,
    needs_chromium,
    open_files,
    open_page,
    wait_until_planned,
)

pytestmark = needs_chromium


def test_a_link_opens_the_same_front_with_its_cities(planned: Page, browser: Browser) -> None:
    link = copied(planned, "link")
    front = planned.locator("#front-chart").get_attribute("aria-label")
    with open_page(browser, link) as other:
        expect(other.locator("#count")).to_have_text("61 stops")
        expect(other.locator("#front-chart")).to_have_attribute("aria-label", front or "")
        other.get_by_text("Details", exact=True).click()
        expect(other.get_by_text("is drawn here while a search runs")).to_be_visible()
        other.goto(planned.url.partition("#")[0] + "#front=none")
        for told in ("#request-fault", "#waiting"):
            expect(other.locator(told)).to_contain_text("no longer has the front of this link")
        assert other.get_by_label("Example").evaluate("choice => choice.selectedIndex") == 0


def test_a_copy_button_says_for_a_moment_that_it_copied_however_often_it_is_pressed(
    planned: Page,
) -> None:
    button = planned.get_by_role("button", name="Copy link")
    label = button.inner_text()
    assert copied(planned, "link") == copied(planned, "link")
    expect(button).to_have_text("Copied")
    expect(button).to_have_text(label)


def test_a_link_to_a_front_of_an_example_names_the_example(browser: Browser, released: str) -> None:
    with open_page(browser, released) as page:
        wait_until_planned(page)
        slider = page.get_by_role("slider", name="Balance")
        slider.press("Home")
        slider.press("ArrowRight")
        selected = slider.get_attribute("aria-valuetext") or ""
        link = copied(page, "link")
        assert link.endswith("&example=helsinki-deliveries.json")
        with open_page(browser, link) as other:
            wait_until_planned(other)
            expect(other.locator("#count")).to_have_text("60 stops")
            expect(other.get_by_label("Example")).to_have_value("helsinki-deliveries.json")
            expect(other.locator("#plane-1 canvas.streets")).to_be_visible()
            expect(other.get_by_role("slider", name="Balance")).to_have_attribute(
                "aria-valuetext", selected
            )
        page.get_by_label("Seconds of planning").fill("0")
        copied(page, "link")
        expect(page).to_have_url(re.compile("&asked="))


def test_a_link_to_the_networks_front_calls_it_that(page: Page, browser: Browser) -> None:
    page.get_by_label("Seconds of planning").fill("0")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    with open_page(browser, copied(page, "link")) as other:
        wait_until_planned(other)
        for shown in (page, other):
            expect(shown.locator("#legend .alone")).to_be_visible()
            expect(shown.locator("#legend .improved")).to_be_hidden()


def test_a_link_that_would_be_too_long_opens_the_front_without_its_maps(
    page: Page, browser: Browser
) -> None:
    matrices = np.random.default_rng(0).random((2, 60, 60)).tolist()
    open_files(page, {"costs.json": json.dumps({"matrices": matrices, "time_limit": 0})})
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    link = copied(page, "link")
    expect(page.get_by_text("This link opens the front without its maps")).to_be_visible()
    assert len(link) < 100
    with open_page(browser, link) as other:
        wait_until_planned(other)
        expect(other.get_by_text("The link only names a front")).to_be_visible()
        expect(other.locator("#plane-1")).to_be_hidden()
        expect(other.get_by_label("A front of")).to_be_visible()
