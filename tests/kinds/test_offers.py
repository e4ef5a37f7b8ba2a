"""Offers of slots from JSON to JSON: prices, requests that take them, the day so far, refusals."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.fleet.evaluation import plan_lengths, violations
from service.fleet.plans import Plan, Route
from service.kinds.offers import answer_offers, parse_offers
from service.kinds.parsing import parse_replan, parse_task
from service.requests.replan.way import ReplanSource
from service.requests.task import TaskSource
from service.requests.task_codec import encode_task
from tests.helpers.actors import info_of
from tests.helpers.offers import (
    FIVE,
    HOUR,
    LIMITS,
    NEW_PLACE,
    NINE,
    as_stored,
    fleet_request,
    stored_fleet,
)

ORDER = {"id": "new", "location": NEW_PLACE, "demand": [1], "service": 300}
HOURS = {"from": NINE, "to": FIVE, "length": HOUR}
FRONT = as_stored(stored_fleet(fleet_request()))
WAITS = [{"first": ["order-1"], "then": ["order-7"], "vehicles": "any", "gap": HOUR}]
WAITING = as_stored(stored_fleet({**fleet_request(), "before": WAITS}))


def ask(front: Any = FRONT, **members: Any) -> dict[str, Any]:
    body = json.dumps({"order": ORDER, **members}).encode()
    asked = parse_offers(ReplanSource(body, front), LIMITS, {})
    answer: dict[str, Any] = json.loads(answer_offers(asked, LIMITS, {}))
    return answer


def promised(offer: dict[str, Any], choice: dict[str, Any], front: Any = FRONT) -> tuple[Plan, Any]:
    """Return the plan that is promised, and the fleet that the request of an offer makes."""
    task = parse_replan(ReplanSource(json.dumps(offer["replan"]).encode(), front), LIMITS, {})
    fleet, labels = task.subject, task.labels
    ids = [stop.id for stop in labels.stops]
    order, routes = ids.index("new"), list(fleet.driven)
    kind = next(n for n, name in enumerate(fleet.vehicles) if name.id == choice["vehicle"])
    if "route" not in choice:
        return Plan((*routes, Route(kind, (order,)))), fleet.fleet()
    after, route = ids.index(choice["after"]), routes[choice["route"]]
    at = 0 if after in fleet.rules.depots else route.stops.index(after) + 1
    stops = (*route.stops[:at], order, *route.stops[at:])
    routes[choice["route"]] = Route(route.vehicle, stops)
    return Plan(tuple(routes)), fleet.fleet()


def test_each_slot_has_its_price_and_its_request_makes_it_true() -> None:
    # "Which slot can I promise?" of VROOM's issues 800 and 951: every hour of the day.
    answer = ask(every=HOURS)
    assert answer["lengths"] == pytest.approx(json.loads(FRONT.found.split()[0])["lengths"])
    slots = [[NINE + i * HOUR, NINE + (i + 1) * HOUR] for i in range(8)]
    assert [each["slot"] for each in answer["offers"]] == slots
    assert any(each["possible"] for each in answer["offers"])
    for offer in answer["offers"]:
        choices = offer.get("choices", [])
        assert bool(choices) == offer["possible"] == ("reasons" not in offer)
        for choice in choices:
            assert (np.array(choice["rise"]) >= offer["rise"]).all()
            assert choice["arrival"] <= offer["slot"][1]
            plan, fleet = promised(offer, choice)
            assert not violations(fleet, plan)
            rise = np.subtract(plan_lengths(fleet, plan), answer["lengths"])
            assert rise == pytest.approx(choice["rise"], abs=1e-6)


def test_during_the_day_vans_bring_what_they_carry_and_nothing_new() -> None:
    routes = json.loads(FRONT.found.split()[0])["routes"]
    now = max(route["arrivals"][1] for route in routes) + 600
    ways = [{"route": number, "done": [each["stops"][1]]} for number, each in enumerate(routes)]
    changes = {"plan": 0, "now": now, "routes": ways, "every": HOURS}
    brought = ask(**changes)
    assert brought["lengths"][0] < routes[0]["lengths"][0] + routes[1]["lengths"][0]
    for offer in brought["offers"]:
        assert not offer["possible"] or offer["slot"][1] >= now
        assert all("route" not in choice for choice in offer.get("choices", ()))
    visit = {"id": "new", "location": NEW_PLACE}
    visited = ask(**changes, order=visit)["offers"]
    assert any("route" in choice for offer in visited for choice in offer.get("choices", ()))


def test_an_order_may_delay_a_visit_that_others_wait_for_as_long_as_all_are_in_time() -> None:
    """The price counts what the other van loses, too."""
    answer = ask(WAITING, every=HOURS)
    assert [each["possible"] for each in answer["offers"]].count(True) > 1
    for offer in answer["offers"]:
        for choice in offer.get("choices", ()):
            plan, fleet = promised(offer, choice, WAITING)
            assert fleet.rules.groups.waiting
            assert not violations(fleet, plan)
            rise = np.subtract(plan_lengths(fleet, plan), answer["lengths"])
            assert rise == pytest.approx(choice["rise"], abs=1e-6)


@pytest.mark.parametrize("front", [FRONT, WAITING])
def test_a_late_van_keeps_no_other_one_from_taking_an_order(front: Any) -> None:
    ways = [{"route": number, "done": []} for number in (0, 1)]
    late = {"plan": 0, "now": 11.5 * HOUR, "routes": ways}
    offers = ask(front, every=HOURS, **late)["offers"]
    choices = [choice for offer in offers for choice in offer.get("choices", ())]
    assert choices
    assert all("route" not in choice for choice in choices)


def test_an_order_that_no_vehicle_can_bring_has_reasons() -> None:
    night, morning = ask(slots=[[0, HOUR], [NINE, 12 * HOUR]])["offers"]
    assert not night["possible"]
    assert [(each["vehicle"], each["rule"]) for each in night["reasons"]] == [("van", "window")]
    assert morning["possible"]
    (cold,) = ask(order={**ORDER, "skills": ["cold"]}, slots=[[NINE, FIVE]])["offers"]
    assert [each["detail"] for each in cold["reasons"]] == ["lacks the skill cold"]


def test_other_orders_are_added_before_the_one_that_is_offered() -> None:
    other = {"id": "other", "location": NEW_PLACE, "demand": [1]}
    alone, both = (ask(slots=[[NINE, FIVE]], **more) for more in ({}, {"add": [other]}))
    assert both["lengths"][0] > alone["lengths"][0]
    added = both["offers"][0]["replan"]["add"]
    assert added == [other, {**ORDER, "window": [NINE, FIVE]}]
    assert both["unassigned"] == []


def test_without_time_an_offer_says_that_places_were_not_tried() -> None:
    (offer,) = ask(slots=[[NINE, FIVE]], time_limit=0)["offers"]
    assert offer == {"slot": [NINE, FIVE], "possible": False, "complete": False, "reasons": []}


WRONG = [
    ({}, "/slots", "one of slots and every is required, got none"),
    ({"slots": [[1, 2]], "every": HOURS}, "/slots", "one of slots and every is required, got both"),
    (
        {"slots": [[2, 1]]},
        "/slots/0",
        "slots/0 must be a begin and then an end that is not before it, got 2 and 1",
    ),
    (
        {"every": {**HOURS, "to": NINE}},
        "/every/to",
        "every/to must be at least 36000, when the first slot ends, got 32400",
    ),
    (
        {"every": {**HOURS, "length": 60}},
        "/every/length",
        "every/length must make at most 200 slots, got 480",
    ),
    ({"slots": [[1, 2]], "order": {**ORDER, "window": [1, 2]}}, "/order/window", None),
    ({"slots": [[1, 2]], "order": {**ORDER, "prize": 2}}, "/order/prize", None),
    ({"slots": [[1, 2]], "order": {**ORDER, "demand": [1, 2]}}, "/order/demand", None),
    ({"slots": [[1, 2]], "order": {**ORDER, "id": "depot"}}, "/order/id", None),
    ({"slots": [[1, 2]], "order": {"id": "new"}}, "/order/location", None),
    ({"slots": [[1, 2]], "order": {**ORDER, "vehicle": "bike"}}, "/order/vehicle", None),
    ({"slots": [[1, 2]], "add": [{"id": "other"}]}, "/add/0/location", None),
    ({"slots": [[1, 2]], "plan": 99}, "/plan", None),
    ({"slots": [[1, 2]], "size": 3}, "/size", None),
]  # fmt: skip


@pytest.mark.parametrize(("members", "pointer", "detail"), WRONG)
def test_what_is_wrong_is_named(members: dict[str, Any], pointer: str, detail: str | None) -> None:
    with pytest.raises(Refusal) as refused:
        ask(**members)
    assert refused.value.code == "invalid-request"
    assert [each.pointer for each in refused.value.errors] == [pointer]
    assert detail is None or refused.value.detail == detail


def test_a_front_without_vehicles_or_without_a_clock_has_no_offers() -> None:
    body = json.dumps({"coordinates": np.eye(4).tolist()}).encode()
    tours = parse_task(TaskSource("front", body), LIMITS, {"a": info_of("a", "coordinates")})
    with pytest.raises(Refusal, match="must have plans of a fleet"):
        ask(replace(FRONT, task=encode_task(tours)), slots=[[1, 2]])
    request = fleet_request()
    del request["clock"], request["vehicles"][0]["shift"]
    stops = [{"id": each["id"], "location": each["location"]} for each in request["stops"]]
    with pytest.raises(Refusal, match="slots needs a clock"):
        ask(as_stored(stored_fleet({**request, "stops": stops})), slots=[[1, 2]])
