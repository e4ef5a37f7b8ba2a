"""Refusals of the service on the page: in its words, without the places of members in a request."""

import json
import re
from typing import Any

import httpx
import pytest
from playwright.sync_api import Page

from tests.helpers.browsing import needs_chromium, shown_front

pytestmark = needs_chromium

PATH = re.compile(r"[a-z_]+/\d")
ROWS = [[0, 0, 1, 1], [1, 1, 0, 0], [2, 0, 2, 2]]
STOPS = [{"id": f"s{k}", "location": [24.9 + k / 100, 60.1]} for k in range(3)]
WAY: dict[str, Any] = {"name": "way", "from": "great_circle"}
TIME = {"name": "time", "from": "great_circle", "speed": 30}
FRONT = {"stops": STOPS, "objectives": [WAY, TIME]}
COSTS = {"name": "costs", "matrix": [[0, 1, 2], [1, 0, -1], [2, 1, 0]]}
PLACES = {"name": "plane", "coordinates": [[0, 0], [1, 1], [2, "a"]]}
VAN = {"id": "van", "start": "s0", "end": "s0", "capacity": [3]}
LONGEST = {**TIME, "over": "max"}
FLEET = {"stops": STOPS, "vehicles": [VAN], "objectives": [WAY, LONGEST]}
BAD = [
    ("front", {"coordinates": [*ROWS, [1, 2, 3]]}),
    ("front", {"coordinates": [*ROWS, [1, 2, 3, "a"]]}),
    ("front", {"matrices": [[[0, 1], [1, 0]], [[0, 1], ["a", 0]]]}),
    ("front", {"coordinates": ROWS, "initial_tours": [[0, 1, 1]]}),
    ("front", {**FRONT, "stops": [*STOPS, STOPS[0]]}),
    ("front", {**FRONT, "stops": [*STOPS, {"id": "x", "location": [200, 1]}]}),
    ("front", {**FRONT, "stops": [*STOPS, {"id": "x"}]}),
    ("front", {**FRONT, "objectives": [WAY, COSTS]}),
    ("front", {**FRONT, "objectives": [WAY, PLACES]}),
    ("front", {**FRONT, "objectives": [WAY, {**TIME, "speed": -1}]}),
    ("front", {**FRONT, "objectives": [WAY, {"name": "way", "from": "great_circle"}]}),
    ("front", {**FRONT, "objectives": [WAY, {"name": "none"}]}),
    ("fleet", {**FLEET, "vehicles": [VAN, VAN]}),
    ("fleet", {**FLEET, "vehicles": [{**VAN, "start": "nowhere"}]}),
    ("fleet", {**FLEET, "vehicles": [{**VAN, "shift": [5, 1]}]}),
    ("fleet", {**FLEET, "vehicles": [{**VAN, "capacity": [-1]}]}),
    ("fleet", {**FLEET, "stops": [*STOPS[:2], {**STOPS[2], "demand": ["a"]}]}),
    ("fleet", {**FLEET, "stops": [*STOPS[:2], {**STOPS[2], "window": [0, 1]}]}),
    ("fleet", {**FLEET, "stops": [*STOPS[:2], {**STOPS[2], "demand": [1, 2]}]}),
    ("fleet", {**FLEET, "shipments": [{"pickup": "s1", "delivery": "s1"}]}),
    ("fleet", {**FLEET, "shipments": [{"pickup": "s1", "delivery": "gone"}]}),
]
REST = [
    {"done": [0, 0]},
    {"done": [0], "remove": [0]},
    {"remove": [99]},
    {"remove": [3, 3]},
    {"add": [{"id": "new"}]},
    {"add": [{"id": "new", "coordinates": [[0, 0], [1, "a"]]}]},
]


def said(page: Page, refusal: dict[str, Any]) -> list[str]:
    """What the page says of a refusal."""
    texts: list[str] = page.evaluate(
        """async ({ detail, ...others }) => {
          const { showFaults, clearFaults } = await import("./page/planning/faults.js");
          showFaults({ message: detail, ...others });
          const said = [...document.querySelectorAll(".fault")].map((each) => each.textContent);
          clearFaults();
          return said.filter(Boolean);
        }""",
        refusal,
    )
    assert texts
    return texts


def without_details(refusal: dict[str, Any]) -> dict[str, Any]:
    """The refusal with other sentences, but for what is demanded: the page must not read them."""
    errors = [{**fault, "detail": "-"} for fault in refusal["errors"]]
    return {**refusal, "detail": "-", "errors": errors}


@pytest.mark.parametrize(("path", "request_body"), BAD, ids=lambda each: json.dumps(each)[-60:])
def test_a_refusal_says_no_place_in_a_request(
    planned: Page, released: str, path: str, request_body: dict[str, Any]
) -> None:
    answer = httpx.post(f"{released}/{path}", json=request_body)
    assert answer.status_code == 422, answer.text
    refusal = answer.json()
    texts = said(planned, refusal)
    assert not [text for text in texts if PATH.search(text)]
    assert said(planned, without_details(refusal)) == texts


@pytest.mark.parametrize("changes", REST, ids=json.dumps)
def test_a_refusal_to_replan_says_no_place_in_a_request(
    planned: Page, released: str, changes: dict[str, Any]
) -> None:
    front = shown_front(planned)
    body = {"tour": front["front"][0]["tour"], "done": [], **changes}
    answer = httpx.post(f"{released}/front/{front['id']}/replan", json=body)
    assert answer.status_code == 422, answer.text
    assert not [text for text in said(planned, answer.json()) if PATH.search(text)]


def test_a_stop_of_a_rest_is_counted_as_on_the_page(planned: Page) -> None:
    fault = {"pointer": "/remove/1", "code": "visited", "demand": "-", "values": {"came": 4}}
    refusal = {"detail": "-", "errors": [fault]}
    planned.locator("#replanning").evaluate("details => details.open = true")
    assert said(planned, refusal) == ["A stop to drop must not be visited yet, got 5."]
