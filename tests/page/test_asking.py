"""Help to choose on the page: three cards, one click each, until a tour or plan is selected."""

import json
from typing import Any

import httpx
import numpy as np
import pytest
from playwright.sync_api import Page, expect

from tests.helpers.accessibility import load_axe, violations
from tests.helpers.browsing import (
    DESK,
    PHONE,
    needs_chromium,
    number_in,
    open_files,
    wait_for_next_frame,
    wait_until_planned,
)

pytestmark = needs_chromium

N = 12
NAMES = ("way", "people passed", "climb")
ROUNDED = 0.006  # relative: what the page says to three digits


def stops() -> list[dict[str, Any]]:
    places = np.random.default_rng(2).random((N, 2)).tolist()
    return [
        {"id": f"s{k}", "location": [24.9 + x / 20, 60.15 + y / 30]}
        for k, (x, y) in enumerate(places)
    ]


def front(objectives: int) -> dict[str, Any]:
    costs = np.random.default_rng(3).random((objectives, N, N)).tolist()
    named = [{"name": name, "matrix": matrix} for name, matrix in zip(NAMES, costs, strict=False)]
    return {"stops": stops(), "objectives": named, "time_limit": 0.1}


def fleet() -> dict[str, Any]:
    first, *others = stops()
    return {
        "stops": [first, *({**each, "demand": [1]} for each in others)],
        "vehicles": [{"id": "van", "count": 4, "start": 0, "end": 0, "capacity": [6]}],
        "objectives": [
            {"name": "total", "from": "great_circle"},
            {"name": "longest", "from": "great_circle", "over": "max"},
        ],
        "time_limit": 0,  # the network finds several plans, however busy the machine
    }


@pytest.mark.parametrize(
    ("request_", "width", "by_keyboard"),
    [(front(2), DESK, True), (front(3), PHONE, False), (fleet(), PHONE, True)],
    ids=["two objectives", "three objectives", "a fleet"],
)
def test_three_picks_select_what_the_service_leads_to(
    window: Page, released: str, request_: dict[str, Any], width: int, by_keyboard: bool
) -> None:
    window.set_viewport_size({"width": width, "height": 900})
    open_files(window, {"request.json": json.dumps(request_)})
    with window.expect_response(lambda each: each.request.method == "POST"):
        window.get_by_role("button", name="Plan", exact=True).click()
    wait_until_planned(window)
    window.get_by_role("button", name="Help me choose").click()
    expect(window.locator("#options button").first).to_be_focused()
    load_axe(window)
    assert violations(window, ".front") == []
    if not by_keyboard:
        window.locator("#options button").nth(1).click()
        expect_question(window, 2)
        window.get_by_role("button", name="Back", exact=True).click()
        expect_question(window, 1)
    asked = pick_always_the_first(window, by_keyboard)
    found = httpx.get(f"{released}/front/{asked['front']}").json()["front"][asked["number"]]
    shown = window.locator("#comparison tbody:not(.measures) tr td:nth-child(2)").all_inner_texts()
    lengths = [number_in(cell) for cell in shown]
    np.testing.assert_allclose(lengths, found["lengths"], rtol=ROUNDED)


def pick_always_the_first(window: Page, by_keyboard: bool) -> dict[str, Any]:
    """Pick the first card each time, and return the service's last answer."""
    cards = window.locator("#options button")
    for number in range(1, 5):
        with window.expect_response(lambda each: "/questions" in each.url) as answer:
            if by_keyboard:
                window.keyboard.press("Enter")
            else:
                cards.first.click()
        asked: dict[str, Any] = answer.value.json()
        if not asked["left"]:
            break
        expect_question(window, number + 1)
        for option, card in zip(asked["options"], cards.all(), strict=True):
            count = option["within_reach"]
            assert count == 1 or f"{count} " in card.inner_text()
    expect(window.get_by_role("button", name="Help me choose")).to_be_focused()
    expect(window.locator("#question")).to_be_hidden()
    wait_for_next_frame(window)
    return asked


def expect_question(window: Page, number: int) -> None:
    expect(window.locator("#question-said")).to_contain_text(f"Question {number} of 3")


def test_a_front_that_the_service_no_longer_has_is_said(window: Page) -> None:
    window.route(
        "**/questions?*",
        lambda route: route.fulfill(
            status=410,
            content_type="application/problem+json",
            json={"code": "front-expired", "detail": "front 'x' is not kept any more"},
        ),
    )
    window.get_by_role("button", name="Help me choose").click()
    expect(window.locator("#ask-fault")).to_have_text("front 'x' is not kept any more")
