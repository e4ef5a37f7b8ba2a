"""How the page looks: on a phone and on a desk, in light and in dark, whatever is planned on it."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.accessibility import unfold
from tests.helpers.browsing import (
    DESK,
    FREE,
    PHONE,
    needs_chromium,
    open_page,
    running_first,
    stops_as_text,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.layout_shifts import WATCH, shifts_after_the_first_front
from tests.helpers.sampled import IS_WHOLE, few

EXAMPLES = few(2, ["City deliveries", "Warehouse cleaning", "Helsinki deliveries"])
LEGIBLE, SEEN = 4.5, 3.0  # contrasts that WCAG 2.2 demands of text, and of lines
OF_LINES = ("in straight lines", "along the streets")

pytestmark = needs_chromium

# Every piece of text that is seen, with its colour and what lies behind it.
TEXTS = """() => {
  const parts = (text) => text.match(/[\\d.]+/g).map(Number);
  const behind = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const [red, green, blue, alpha = 1] = parts(getComputedStyle(at).backgroundColor);
      if (alpha > 0) return [red, green, blue];
    }
  };
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const texts = [];
  while (walker.nextNode()) {
    const text = walker.currentNode.data.trim();
    const element = walker.currentNode.parentElement;
    if (!text || !element.checkVisibility() || element.closest(":disabled")) continue;
    texts.push([text, parts(getComputedStyle(element).color).slice(0, 3), behind(element)]);
  }
  return texts;
}"""
# The strongest colour on each canvas of a map, and what lies behind it.
LINES = """() => {
  const strongest = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    let best = 0;
    for (let at = 0; at < data.length; at += 4) if (data[at + 3] > data[best + 3]) best = at;
    return [...data.slice(best, best + 4)];
  };
  return [...document.querySelectorAll(".plane canvas:not([hidden])")].map((canvas) => {
    const ground = getComputedStyle(canvas.closest(".map")).backgroundColor;
    return [strongest(canvas), ground.match(/\\d+/g).slice(0, 3).map(Number)];
  });
}"""


def test_nothing_sticks_out_at_either_width(window: Page) -> None:
    seconds, fault = window.get_by_label("Seconds of planning"), window.locator("#time_limit-fault")
    window.set_viewport_size({"width": PHONE, "height": 900})
    for example in EXAMPLES:
        seconds.fill("0.1")
        window.get_by_label("Example").select_option(example)
        wait_until_planned(window)
        unfold(window)
        for width in (PHONE, DESK):
            assert_that_nothing_sticks_out(window, width, example)
        seconds.fill("as long as it takes, if that is not forever")
        window.get_by_role("button", name="Plan", exact=True).click()
        expect(fault).not_to_be_empty()
        for width in (DESK, PHONE):
            assert_that_nothing_sticks_out(window, width, example)


def assert_that_nothing_sticks_out(page: Page, width: int, example: str) -> None:
    page.set_viewport_size({"width": width, "height": 900})
    wait_for_next_frame(page)
    assert page.evaluate("document.documentElement.scrollWidth") == width, example


@pytest.mark.parametrize("width", few(1, [PHONE, DESK]))
def test_nothing_moves_by_itself_once_a_front_is_drawn(
    browser: Browser, released: str, width: int
) -> None:
    with open_page(browser, released + FREE, width) as page, running_first(page, WATCH):
        page.goto(released)
        wait_until_planned(page)
        expect(page.locator("#plane-1 canvas.streets")).to_be_visible()
        wait_for_next_frame(page)
        assert page.evaluate("firstFront") > 0
        assert shifts_after_the_first_front(page) == []


@pytest.fixture(scope="module")
def example(browser: Browser, released: str) -> Iterator[Page]:
    """The page as it opens, in the dark, with its first example planned."""
    with open_page(browser, released, scheme="dark") as page:
        wait_until_planned(page)
        yield page


def test_what_is_said_of_the_lines_stays_in_its_place(example: Page) -> None:
    place = "text => (lines.textContent = text, lines.getBoundingClientRect().toJSON())"
    for width in (PHONE, DESK):
        example.set_viewport_size({"width": width, "height": 900})
        wait_for_next_frame(example)
        straight, along = (example.evaluate(place, each) for each in OF_LINES)
        assert straight == along


def test_every_text_is_legible_against_what_lies_behind_it(example: Page) -> None:
    example.get_by_role("button", name="Keep to compare").click()
    example.get_by_label("Seconds of planning").fill("soon")
    example.get_by_role("button", name="Plan", exact=True).click()
    expect(example.locator("#time_limit-fault")).not_to_be_empty()
    unfold(example)
    assert_that_texts_are_legible(example, dark=True)
    example.emulate_media(color_scheme="light")
    wait_for_next_frame(example)
    assert_that_texts_are_legible(example, dark=False)


def assert_that_texts_are_legible(page: Page, dark: bool) -> None:
    texts = page.evaluate(TEXTS)
    assert {"Trade-offs", "Plan", "On the map", "To compare"} <= {text for text, _, _ in texts}
    assert [text for text, *colours in texts if contrast(*colours) < LEGIBLE] == []
    # The ground is what tells that the scheme was taken.
    ground = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (ground == "rgb(16, 21, 28)") == dark


def test_cities_and_tours_stand_out_from_the_maps_which_follow_when_it_turns_dark(
    page: Page,
) -> None:
    page.get_by_role("slider", name="Balance").press("Home")
    page.get_by_role("button", name="Keep to compare").click()
    page.get_by_role("slider", name="Balance").press("End")
    wait_for_next_frame(page)
    light = page.evaluate(LINES)
    page.emulate_media(color_scheme="dark")
    wait_for_next_frame(page)
    dark = page.evaluate(LINES)
    assert len(light) == len(dark) == 6  # cities, both tours, in either plane
    for (*colour, alpha), ground in light + dark:
        assert alpha == 255
        assert contrast(colour, ground) >= SEEN
    assert all(one[0] != other[0] for one, other in zip(light, dark, strict=True))


def front_of(cities: int, count: int) -> dict[str, Any]:
    """Return an answer with random tours: to plan those of many cities takes seconds."""
    tours = [np.random.default_rng(at).permutation(cities).tolist() for at in range(count)]
    shares = np.linspace(0, 1, count).tolist()
    return {
        **{"id": 32 * "c", "status": "done", "kind": "front", "cities": cities, "points": count},
        **{"hypervolume": 0.5, "hypervolume_bound": None, "reference_point": [900, 900]},
        **{"scale": [1, 1], "timings_ms": {"total": 200}, "terminated": "time_limit"},
        "front": [
            {"angle": 45, "balance": at, "lengths": [400 + 99 * at, 500 - 99 * at], "tour": tour}
            for at, tour in zip(shares, tours, strict=True)
        ],
        "actor": None,
    }


def test_many_cities_and_their_front_are_shown(page: Page) -> None:
    n, count = 1000 if IS_WHOLE else 300, 40
    cities = np.random.default_rng(0).random((n, 4)).round(4)
    stops_as_text(page).fill("\n".join(",".join(map(str, r)) for r in cities))
    expect(page.locator("#count")).to_have_text(f"{n:,} stops")
    page.route("**/front", lambda route: route.fulfill(json=front_of(n, count)))
    page.get_by_label("Seconds of planning").fill("0")
    page.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(page)
    slider = page.get_by_role("slider", name="Balance")
    shown = set()
    for key, place in {"Home": 1, "PageUp": 11, "End": count}.items():
        slider.press(key)
        expect(slider).to_have_attribute("aria-valuetext", re.compile(f"tour {place} of {count}"))
        wait_for_next_frame(page)
        shown.add(page.locator("#plane-1 canvas.selected").evaluate("c => c.toDataURL()"))
    assert len(shown) == 3


def contrast(one: list[float], other: list[float]) -> float:
    """Of two colours, as WCAG defines it: 1 of like ones, 21 of black and white."""
    darker, lighter = sorted([luminance(one), luminance(other)])
    return (lighter + 0.05) / (darker + 0.05)


def luminance(colour: list[float]) -> float:
    share = np.array(colour) / 255
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return float(linear @ [0.2126, 0.7152, 0.0722])
