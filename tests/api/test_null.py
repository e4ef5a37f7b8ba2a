"""Requests of generated clients, which send null for every member that was not set."""

from typing import Any

import httpx

from service.requests.day_fields import StopItem
from service.requests.fleet import FleetRequest
from service.requests.fleet_fields import FleetStopItem, VehicleItem
from service.requests.front import FrontRequest
from service.requests.replan.fields import ReplanRequest

PLACES = [[24.94, 60.17], [24.96, 60.18], [24.9, 60.2], [24.97, 60.16]]
WAY = {"name": "way", "from": "great_circle"}


def whole(form: Any, **given: Any) -> dict[str, Any]:
    """Return all members of a form, null but for those that are given."""
    return {**dict.fromkeys(form.model_fields), **given}


def test_every_member_of_a_front_and_of_its_rest_may_be_null(client: httpx.Client) -> None:
    stops = [whole(StopItem, id=f"s{n}", location=place) for n, place in enumerate(PLACES)]
    objectives = [WAY | {"matrix": None}, WAY | {"name": "other", "speed": None, "unit": None}]
    front = whole(FrontRequest, stops=stops, objectives=objectives, time_limit=0.1)
    planned = client.post("/front", json=front)
    assert planned.status_code == 200, planned.text
    rest = whole(ReplanRequest, done=["s0"], time_limit=0.1)
    answer = client.post(f"/front/{planned.json()['id']}/replan", json=rest)
    assert answer.status_code == 200, answer.text
    assert answer.json()["front"][0]["stops"][0] == "s0"


def test_every_member_of_a_fleet_may_be_null(client: httpx.Client) -> None:
    stops = [whole(FleetStopItem, id=f"s{n}", location=place) for n, place in enumerate(PLACES)]
    vans = [whole(VehicleItem, id="van", count=2, start="s0")]
    longest = WAY | {"name": "longest", "over": "max", "measure": None}
    fleet = whole(FleetRequest, stops=stops, vehicles=vans, objectives=[WAY, longest])
    answer = client.post("/fleet", json={**fleet, "time_limit": 0.1})
    assert answer.status_code == 200, answer.text


def test_a_member_that_is_required_is_missing_where_it_is_null(client: httpx.Client) -> None:
    for stop in ({}, {"id": None}):
        answer = client.post("/front", json={"stops": [stop], "objectives": [WAY, WAY]})
        [fault] = answer.json()["errors"]
        assert (fault["pointer"], fault["detail"]) == ("/stops/0/id", "stops/0/id is required")
