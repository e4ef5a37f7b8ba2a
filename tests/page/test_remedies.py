"""What would help a fleet without a plan, one click each on the page."""

import json
from typing import Any

import pytest
from playwright.sync_api import Page, Route, expect

from tests.helpers.accessibility import check_on_a_phone
from tests.helpers.browsing import (
    DESK,
    PHONE,
    curl_body,
    needs_chromium,
    open_files,
    wait_until_planned,
)
from tests.helpers.node import Node

HOME = {"id": "depot", "location": [24.93, 60.17]}
ORDERS = [
    {"id": f"order-{k}", "location": [24.93 + k / 100, 60.18], "demand": [2]} for k in range(1, 5)
]
VAN = {"id": "van", "start": "depot", "end": "depot", "capacity": [4]}
FLEET: dict[str, Any] = {
    "stops": [HOME, *ORDERS],
    "vehicles": [VAN],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "longest route", "from": "great_circle", "over": "max"},
    ],
}
# As the service has tried them on this request: see `tests/remedies`.
REMEDIES: list[dict[str, Any]] = [
    {
        "code": "leave-out",
        "detail": "visit as many stops as the vehicles can, at least 2 of 4",
        "patch": [{"op": "add", "path": f"/stops/{k}/prize", "value": 9000.0} for k in range(1, 5)],
    },
    {
        "code": "more-vehicles",
        "detail": "use 2 vehicles like 'van' instead of 1",
        "patch": [{"op": "add", "path": "/vehicles/0/count", "value": 2}],
    },
]
FAULT = {
    "code": "over-all-vehicles",
    "detail": "the demands sum to 8, and all vehicles together hold 4",
    "pointer": "/vehicles",
    "remedies": REMEDIES,
}
REFUSAL = {"code": "no-plan", "detail": FAULT["detail"], "errors": [FAULT]}


@pytest.mark.parametrize(
    ("patch", "changed"),
    [
        (REMEDIES[0]["patch"], {"stops": [HOME, *({**each, "prize": 9000.0} for each in ORDERS)]}),
        (REMEDIES[1]["patch"], {"vehicles": [{**VAN, "count": 2}]}),
        ([{"op": "add", "path": "/time_limit", "value": 1.0}], {"time_limit": 1.0}),
        (
            [
                {"op": "remove", "path": "/vehicles/0/capacity"},
                {"op": "add", "path": "/vehicles/0/end", "value": None},
            ],
            {"vehicles": [{"id": "van", "start": "depot"}]},
        ),
    ],
)
def test_a_patch_changes_a_copy_of_a_request(
    node: Node, patch: list[dict[str, Any]], changed: dict[str, Any]
) -> None:
    both = """async ([request, patch]) => {
      const { patched } = await import("./page/planning/remedies.js");
      return [patched(request, patch), request];
    }"""
    assert node.evaluate(both, [FLEET, patch]) == [{**FLEET, **changed}, FLEET]


@needs_chromium
def test_a_click_on_what_would_help_plans_with_it_and_undo_takes_it_back(window: Page) -> None:
    def refuse(route: Route) -> None:
        body = json.loads(route.request.post_data or "{}")
        is_changed = "prize" in body["stops"][1] or "count" in body["vehicles"][0]
        if is_changed:
            route.continue_()
        else:
            route.fulfill(status=422, json=REFUSAL, content_type="application/problem+json")

    window.route("**/fleet", refuse)
    open_files(window, {"fleet.json": json.dumps(FLEET)})
    window.set_viewport_size({"width": PHONE, "height": 900})
    window.get_by_role("button", name="Plan", exact=True).click()
    remedies = window.get_by_role("group", name="What would help").get_by_role("button")
    expect(remedies).to_have_text(
        [f"{each['detail'][0].upper()}{each['detail'][1:]}" for each in REMEDIES]
    )
    expect(remedies.last).to_be_in_viewport()
    check_on_a_phone(window, "main")
    window.set_viewport_size({"width": DESK, "height": 900})
    remedies.last.click()
    wait_until_planned(window)
    expect(remedies).to_have_count(0)
    expect(window.get_by_label("Count of van")).to_have_value("2")
    assert curl_body(window, "fleet")["vehicles"] == [{**VAN, "count": 2}]
    window.get_by_role("button", name="Undo").click()
    expect(window.get_by_label("Count of van")).to_have_value("")
    # The other one stands there again. Its plan visits as many as can be.
    remedies.first.click()
    wait_until_planned(window)
    expect(window.get_by_label("Prize of order-1")).to_have_value("9000")
    expect(window.locator("#fleet-left-out-title")).to_contain_text("2 stops are left out")
    expect(window.locator("#comparison")).to_contain_text("18 km of it for stops left out")
