"""The composition of the page: what is seen without scrolling, no holes, and no collisions."""

import re
from collections.abc import Iterator
from typing import Any

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.helpers.accessibility import load_axe, violations
from tests.helpers.browsing import (
    CUT_OFF,
    needs_chromium,
    open_unplanned,
    plan_by_network_alone,
    wait_for_next_frame,
    wait_until_planned,
)
from tests.helpers.sampled import IS_WHOLE

EXAMPLES = ["Helsinki, three costs", "Helsinki, six vans", "Warehouse, three robots"]
if IS_WHOLE:
    EXAMPLES += ["Helsinki deliveries", "Helsinki, rush hour", "City deliveries"]
    EXAMPLES += ["Warehouse cleaning"]
DESK, TABLET = (1440, 900), (1024, 768)  # windows: width and height in pixels
WIDTHS = [320, 375, 768, 861, 1024, 1200, 1440, 1920] if IS_WHOLE else [320, 768, 1024, 1440]
FILLED = 0.85  # of the place of front, numbers and map: the share that cards cover
DRAWN = (0.8, 0.4)  # of a map's sides: how far a tour reaches, along the longer and the shorter one
# What is seen without scrolling.
AT_ONCE = "#choice, .front .chart, .slider, .caps, #will-plan, #plan, #status"

pytestmark = needs_chromium

# Whatever is visible of these elements, as left, top, right and bottom in the page.
BOXES = """selector => [...document.querySelectorAll(selector)]
  .filter(each => each.checkVisibility())
  .map(each => each.getBoundingClientRect())
  .map(({ left, top, right, bottom }) => [left, top + scrollY, right, bottom + scrollY])"""
# The share of the first screen's results that cards cover, as points every ten pixels see it.
COVERED = """() => {
  const boxes = [".front", ".numbers", ".stuck"]
    .map(name => document.querySelector(name).getBoundingClientRect());
  const [left, top] = ["left", "top"].map(side => Math.min(...boxes.map(box => box[side])));
  const [right, bottom] = ["right", "bottom"].map(side => Math.max(...boxes.map(box => box[side])));
  let [all, covered] = [0, 0];
  for (let x = left + 5; x < right; x += 10)
    for (let y = top + 5; y < Math.min(bottom, innerHeight); y += 10) {
      all += 1;
      covered += Boolean(document.elementFromPoint(x, y)?.closest(".card, #handling"));
    }
  return covered / all;
}"""
# The sides of the box in which a canvas has colour, as shares of the map's.
REACH = """canvas => {
  const { width, height } = canvas;
  const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
  let [left, top, right, bottom] = [width, height, 0, 0];
  for (let at = 3; at < data.length; at += 4) {
    if (!data[at]) continue;
    const [x, y] = [((at - 3) / 4) % width, Math.floor((at - 3) / 4 / width)];
    [left, top] = [Math.min(left, x), Math.min(top, y)];
    [right, bottom] = [Math.max(right, x), Math.max(bottom, y)];
  }
  const map = canvas.closest(".map").getBoundingClientRect();
  return [(right - left) / map.width, (bottom - top) / map.height];
}"""
# The names of tours on the chart below which the line of the front is drawn.
CROSSED = """() => {
  const line = document.querySelector("#front-chart .line");
  const { left: x, top: y } = line.ownerSVGElement.getBoundingClientRect();
  const points = Array.from({ length: line.getTotalLength() }, (_, at) => {
    const point = line.getPointAtLength(at);
    return [point.x + x, point.y + y];
  });
  const labels = [...document.querySelectorAll(".label")].filter(each => each.checkVisibility());
  return labels.filter(each => {
    const { left, top, right, bottom } = each.getBoundingClientRect();
    return points.some(([x, y]) => x > left && x < right && y > top && y < bottom);
  }).map(each => each.textContent);
}"""


@pytest.fixture(scope="module", params=EXAMPLES)
def example(request: pytest.FixtureRequest, browser: Browser, released: str) -> Iterator[Page]:
    """The page with an example planned, for tests that only look."""
    with open_unplanned(browser, released) as page:
        plan_by_network_alone(page, "(front|fleet|coverage)")  # which finds several, however busy
        page.get_by_label("Example").select_option(request.param)
        wait_until_planned(page)
        page.evaluate("document.fonts.ready")
        yield page


def test_a_newcomer_sees_the_choice_and_the_plan_button_at_once(example: Page) -> None:
    for (width, height), selector in ((DESK, f"{AT_ONCE}, .map"), (TABLET, AT_ONCE)):
        resize(example, width, height)
        boxes = example.evaluate(BOXES, selector)
        assert len(boxes) >= 5
        assert max(bottom for *_, bottom in boxes) <= height
    assert example.evaluate(BOXES, ".map")[0][1] < height  # the map begins there


def test_the_first_screen_says_what_every_colour_means(example: Page) -> None:
    resize(example, *DESK)
    keys = example.evaluate(BOXES, ".key:not(:empty), .shades")
    assert all(bottom <= DESK[1] for *_, bottom in keys)
    routes = example.locator("#fleet:not([hidden]) #fleet-legend tbody th").all_inner_texts()
    named = example.locator(":is(#vehicles-key, #robots-key):not([hidden]) li").all_inner_texts()
    assert [name for name in named if name != "all start here"] == routes
    if example.locator("#several").is_visible():
        expect(example.locator(".shades i")).to_have_count(5)
        assert re.match(r"[\d,]+ m\s*[\d,]+ m$", example.locator(".shades").inner_text())


def test_change_leads_to_what_will_be_planned(example: Page) -> None:
    heads = example.locator("#comparison tbody:first-of-type th").all_inner_texts()
    first, second = (re.split("[,\n]", head)[0] for head in heads[:2])
    said = re.compile(rf"^{first} against {second.lower()}.*, \d s of planning\. Change$")
    expect(example.locator("#will-plan")).to_have_text(said)
    example.get_by_role("button", name="Change", exact=True).click()
    assert example.evaluate("Boolean(document.activeElement.closest('.asked'))")
    assert example.evaluate("document.activeElement.matches('input, select')")


def test_cards_leave_no_hole(example: Page) -> None:
    resize(example, *DESK)
    assert example.evaluate(COVERED) >= FILLED


def test_tours_fill_their_maps(example: Page) -> None:
    drawn = example.locator(".map canvas:is(.selected, .routes):visible")
    for width, height in (DESK, TABLET):
        resize(example, width, height)
        for canvas in drawn.all():
            shorter, longer = sorted(canvas.evaluate(REACH))
            assert longer >= DRAWN[0]
            assert shorter >= DRAWN[1]


def test_nothing_on_the_chart_collides(example: Page) -> None:
    for width, height in (DESK, TABLET, (375, 812)):
        resize(example, width, height)
        boxes = example.evaluate(BOXES, ".label, .budget")
        assert not [(a, b) for at, a in enumerate(boxes) for b in boxes[:at] if overlap(a, b)]
        assert example.evaluate(CROSSED) == []
        for axis, *_ in example.evaluate(BOXES, "#front-chart .within"):
            assert all(left >= axis for left, *_ in example.evaluate(BOXES, ".label"))


def test_nothing_sticks_out_of_its_card(example: Page) -> None:
    wider = "cards => cards.filter(card => card.scrollWidth > card.clientWidth).length"
    for width, height in (DESK, TABLET, (375, 812)):
        resize(example, width, height)
        assert example.locator(".card").evaluate_all(wider) == 0


def test_no_number_is_cut_off_at_any_width(example: Page) -> None:
    for name in ("Keep to compare", "Stop comparing"):
        for width in WIDTHS:
            resize(example, width, 900)
            assert example.evaluate(CUT_OFF) == [], width
        example.get_by_role("button", name=name).click()


# Each shows parts that no other has: sliders of limits, lanes of vehicles, a map of cells.
@pytest.mark.parametrize(
    "example",
    ["Helsinki, three costs", "Helsinki, six vans", "Warehouse, three robots"],
    indirect=True,
)
def test_axe_finds_nothing_on_an_example(example: Page) -> None:
    load_axe(example)
    for width, height in (DESK, (375, 812)) if IS_WHOLE else (DESK,):
        resize(example, width, height)
        assert violations(example) == []


def resize(page: Page, width: int, height: int) -> None:
    page.set_viewport_size({"width": width, "height": height})
    page.evaluate("scrollTo(0, 0)")
    wait_for_next_frame(page)
    wait_for_next_frame(page)


def overlap(one: Any, other: Any) -> bool:
    return all(one[side] < other[side + 2] and other[side] < one[side + 2] for side in (0, 1))
