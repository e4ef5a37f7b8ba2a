"""POST /front/{id}/replan of fleets against a live server."""

from itertools import pairwise
from typing import Any

import httpx
import numpy as np
import pytest
from paretour import Refused

from tests.helpers.straight_lines import metres_between

SPEED = 36 / 3.6  # metres in a second
NOW = 1500.0
RANDOM = np.random.default_rng(4)
PLACES = RANDOM.uniform((24.90, 60.15), (25.00, 60.20), (13, 2)).tolist()
DISTANCE = {"name": "distance", "from": "great_circle"}
TIME = {"name": "time", "from": "great_circle", "speed": 36, "over": "max"}


def request(**van: Any) -> dict[str, Any]:
    """Return a request of twelve orders and three vans."""
    orders = [
        {"id": f"order-{i}", "location": PLACES[i], "demand": [1], "service": 60}
        for i in range(1, 13)
    ]
    van = {"id": "van", "count": 3, "start": "depot", "end": "depot", "capacity": [5], **van}
    return {
        "stops": [{"id": "depot", "location": PLACES[0]}, *orders],
        "vehicles": [{**van, "shift": [0, 30000]}],
        "objectives": [DISTANCE, TIME],
        "clock": "time",
        "time_limit": 0.2,
    }


@pytest.fixture(scope="module")
def front(client: httpx.Client) -> dict[str, Any]:
    response = client.post("/fleet", json=request())
    assert response.status_code == 200, response.text
    return response.json()


def full_plan(front: dict[str, Any]) -> int:
    """Return the number of the plan with the most routes: three at least, as each holds 5 of 12."""
    return max(range(len(front["front"])), key=lambda i: len(front["front"][i]["routes"]))


def replan(client: httpx.Client, front: dict[str, Any], **changes: Any) -> httpx.Response:
    body = {"time_limit": 0.2, "now": NOW, **changes}
    return client.post(f"/front/{front['id']}/replan", json=body)


def test_vans_go_on_with_what_they_carry_and_bring_nothing_new(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    plan = full_plan(front)
    routes = front["front"][plan]["routes"]
    # The van that stays at the depot has room left, as these two have eight of twelve at least.
    a, b, *_ = sorted(range(len(routes)), key=lambda i: -len(routes[i]["stops"]))
    first, second = routes[a], routes[b]
    here = {"id": "here", "location": [24.95, 60.17]}
    new = {"id": "new", "location": [24.93, 60.16], "demand": [1]}
    visit = {"id": "visit", "location": [24.96, 60.18]}
    ways = [
        {"route": a, "done": first["stops"][1:2], "position": here},
        {"route": b, "done": second["stops"][1:3], "leaves": NOW + 45},
    ]
    removed = first["stops"][2]
    changes = {"plan": plan, "routes": ways, "add": [new, visit], "remove": [removed]}
    response = replan(client, front, **changes)
    assert response.status_code == 200, response.text
    answer = response.json()
    done = {*first["stops"][1:2], *second["stops"][1:3], removed}
    carried = {i: {*routes[i]["stops"][1:-1]} - done for i in (a, b)}
    places = {stop["id"]: stop["location"] for stop in answer["stops"]}
    assert answer["front"]
    for each in answer["front"]:
        visited = {stop for route in each["routes"] for stop in visits_of(route)}
        everything = {f"order-{i}" for i in range(1, 13)} - done
        assert visited == everything | {"new", "visit"}
        on_the_way = {route["route"]: route for route in each["routes"] if "route" in route}
        for number, start, leaves in ((a, "here", NOW), (b, second["stops"][2], NOW + 45)):
            route = on_the_way[number]
            assert (route["stops"][0], route["arrivals"][0]) == (start, leaves)
            assert set(visits_of(route)) - {"visit"} == carried[number]
        for route in each["routes"]:
            check_times(route, places)
            assert "route" in route or route["arrivals"][0] >= NOW
        assert 0 <= each["kept"] <= 1
    assert max(each["kept"] for each in answer["front"]) >= 0.5


def visits_of(route: dict[str, Any]) -> list[str]:
    return [stop for stop in route["stops"][1:] if stop != "depot"]


def check_times(route: dict[str, Any], places: dict[str, list[float]]) -> None:
    columns = zip(route["stops"], route["arrivals"], strict=True)
    for number, ((a, left), (b, arrived)) in enumerate(pairwise(columns)):
        service = 60 if number and a.startswith("order") else 0
        seconds = metres_between(places[a], places[b]) / SPEED
        assert arrived == pytest.approx(left + service + seconds)


def test_a_van_that_broke_down_leaves_its_load_to_those_at_the_depot(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    plan = full_plan(front)
    routes = front["front"][plan]["routes"]
    ways = [{"route": 0, "done": routes[0]["stops"][1:2], "broken_down": True}]
    response = replan(client, front, plan=plan, routes=ways)
    assert response.json()["code"] == "no-plan"  # two vans hold ten of eleven
    ways = [{"route": 0, "done": routes[0]["stops"][1:3], "broken_down": True}]
    response = replan(client, front, plan=plan, routes=ways)
    answer = response.json()
    done = set(ways[0]["done"])
    for each in answer["front"]:
        assert len(each["routes"]) <= 2
        visited = {stop for route in each["routes"] for stop in visits_of(route)}
        assert visited == {f"order-{i}" for i in range(1, 13)} - done
        assert not any("route" in route for route in each["routes"])


def test_a_van_that_may_load_again_brings_a_new_order_after_it_has(client: httpx.Client) -> None:
    front = client.post("/fleet", json=request(reload=["depot"])).json()
    plan = full_plan(front)
    routes = front["front"][plan]["routes"]
    ways = [{"route": i, "done": route["stops"][1:2]} for i, route in enumerate(routes)]
    new = {"id": "new", "location": [24.93, 60.16], "demand": [1]}
    response = replan(client, front, plan=plan, routes=ways, add=[new])
    assert response.status_code == 200, response.text
    answer = response.json()
    for each in answer["front"]:
        (stops,) = (route["stops"] for route in each["routes"] if "new" in route["stops"])
        route = next(route for route in each["routes"] if "new" in route["stops"])
        assert "route" not in route or "depot" in stops[: stops.index("new")]


@pytest.mark.parametrize("replanned", [False, True])
def test_a_van_that_is_back_brings_a_new_order_once_it_is_loaded(
    client: httpx.Client, replanned: bool
) -> None:
    front = client.post("/fleet", json=request(count=1, capacity=[12], max_trips=None)).json()
    if replanned:
        way = {"route": 0, "done": front["front"][0]["routes"][0]["stops"][1:2]}
        front = replan(client, front, now=500, plan=0, routes=[way]).json()
    (route,) = front["front"][0]["routes"]
    now = route["arrivals"][-1] + 60
    new = {"id": "new", "location": [24.93, 60.16], "demand": [1]}

    def rest(position: str) -> httpx.Response:
        way = {"route": 0, "done": route["stops"][1:-1], "position": position}
        return replan(client, front, now=now, plan=0, routes=[way], add=[new])

    answer = rest("depot").json()
    (again,) = answer["front"][0]["routes"]
    assert (again["stops"], again["route"]) == (["depot", "new", "depot"], 0)
    assert again["arrivals"][0] >= now
    for elsewhere in {route["stops"][0], route["stops"][-2]} - {"depot"}:
        assert rest(elsewhere).json()["errors"][0]["code"] == "no-vehicle-for-stop"


def test_the_rest_of_the_rest_is_replanned_too(client: httpx.Client, front: dict[str, Any]) -> None:
    plan = full_plan(front)
    stops = front["front"][plan]["routes"][0]["stops"]
    once = replan(client, front, plan=plan, routes=[{"route": 0, "done": stops[1:2]}]).json()
    routes = once["front"][0]["routes"]
    number = next(i for i, route in enumerate(routes) if route.get("route") == 0)
    done = routes[number]["stops"][1:2]
    ways = [{"route": number, "done": done}]
    answer = replan(client, once, plan=0, now=NOW + 600, routes=ways)
    assert answer.status_code == 200, answer.text
    left = {f"order-{i}" for i in range(1, 13)} - {*stops[1:2], *done}
    for each in answer.json()["front"]:
        assert {stop for route in each["routes"] for stop in visits_of(route)} == left


def test_each_change_that_would_help_gives_a_plan(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    plan = full_plan(front)
    routes = front["front"][plan]["routes"]
    out = {"route": 0, "done": routes[0]["stops"][1:2], "broken_down": True}
    away = [{"route": i, "done": routes[i]["stops"][1:2]} for i in range(1, len(routes))]
    late = {"id": "late", "location": [24.95, 60.17], "window": [0, NOW + 60]}
    table: dict[str, dict[str, Any]] = {
        "leave-out": {"routes": [out]},
        # Nobody is at the depot, and a request to replan may have changed a stop already.
        "leave-these-out": {
            "routes": [out, *away],
            "stops": [{"stop": routes[0]["stops"][2], "prize": 3}],
        },
    }
    for first, changes in [*table.items(), ("leave-these-out", {"add": [late]})]:
        # On a busy machine a trial may take longer than the time that there is.
        tries = (replan(client, front, plan=plan, **changes).json() for _ in range(9))
        remedies = next(found for each in tries if (found := Refused(each).remedies))
        assert first in {each.code for each in remedies}
        for each in remedies:
            answer = replan(client, front, **each.applied_to({"plan": plan, **changes}))
            assert answer.status_code == 200, (each, answer.text)
            left_out = min(len(found["unassigned"]) for found in answer.json()["front"])
            assert left_out <= (1 if "out" not in each.code else 12)


def test_where_all_vehicles_are_out_of_service_more_of_them_help(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    plan = full_plan(front)
    routes = front["front"][plan]["routes"]
    ways = [{"route": i, "done": each["stops"][1:2]} for i, each in enumerate(routes)]
    out = {"plan": plan, "routes": [{**way, "broken_down": True} for way in ways]}
    tries = (replan(client, front, **out).json() for _ in range(9))
    refusal = next(found for each in tries if (found := Refused(each)).remedies)
    assert [each["code"] for each in refusal.errors] == ["no-vehicle-left"]
    assert [each.code for each in refusal.remedies] == ["send-more"]
    [remedy] = refusal.remedies
    answer = replan(client, front, **remedy.applied_to(out))
    assert answer.status_code == 200, answer.text
    left = {f"order-{i}" for i in range(1, 13)} - {way["done"][0] for way in ways}
    for each in answer.json()["front"]:
        assert {stop for route in each["routes"] for stop in visits_of(route)} == left
    order = {"order": NEW, "slots": [[NOW, 30000]], "now": NOW, **out}
    offered = client.post(f"/front/{front['id']}/offers", json=order)
    assert offered.status_code == 422
    assert offered.json()["errors"][0]["code"] == "no-vehicle-left"


END = 30000  # of all shifts


def test_a_van_may_still_leave_within_its_overtime_and_not_after_it(client: httpx.Client) -> None:
    front = client.post("/fleet", json=request(max_overtime=7200)).json()
    for route in (
        route
        for each in replan(client, front, plan=0, now=END + 600).json()["front"]
        for route in each["routes"]
    ):
        assert END + 600 <= route["arrivals"][0] < route["arrivals"][-1] <= END + 7200
    after = replan(client, front, plan=0, now=END + 7201)
    assert (after.status_code, after.json()["code"]) == (422, "no-plan")
    more = {"vehicles": [{"vehicle": "van", "more": 1}]}
    refused = replan(client, front, plan=0, now=END + 7201, **more).json()
    assert [each["code"] for each in refused["errors"]] == ["no-more-vehicles"]


NEW = {"id": "new", "location": [24.95, 60.17]}
REFUSED = [
    ({"now": None}, "/now"),
    ({"plan": 999}, "/plan"),
    ({"routes": [{"route": 99}]}, "/routes/0/route"),
    ({"routes": [{"route": 0}, {"route": 0}]}, "/routes/1/route"),
    ({"routes": [{"route": 0, "done": ["depot"]}]}, "/routes/0/done/0"),
    ({"routes": [{"route": 0, "position": "nowhere"}]}, "/routes/0/position"),
    ({"remove": ["depot"]}, "/remove/0"),
    ({"add": [{"id": "order-1", "location": [25, 60]}]}, "/add/0/id"),
    ({"stops": [{"stop": "depot", "prize": 3}]}, "/stops/0/stop"),
    ({"stops": [{"stop": "order-1", "windows": [[9, 3]]}]}, "/stops/0/windows/0"),
    ({"vehicles": [{"vehicle": "ship", "more": 1}]}, "/vehicles/0/vehicle"),
    ({"add": [{"id": "new"}]}, "/add/0/location"),
    # What is checked, or found to be impossible, of the fleet that is made of the rest:
    ({"add": [{**NEW, "demand": [1, 1]}]}, "/add/0/demand"),
    ({"add": [NEW, {**NEW, "id": "other", "window": [9, 3]}]}, "/add/1/window"),
    ({"add": [NEW, {**NEW, "id": "other", "demand": [99]}]}, "/add/1"),
]


@pytest.mark.parametrize(("changes", "pointer"), REFUSED)
def test_what_cannot_be_is_refused_where_it_stands(
    client: httpx.Client, front: dict[str, Any], changes: dict[str, Any], pointer: str
) -> None:
    response = replan(client, front, **changes)
    assert response.status_code == 422
    assert [error["pointer"] for error in response.json()["errors"]] == [pointer], response.text


def test_a_fleet_under_three_objectives_is_replanned_chosen_from_and_drawn(
    client: httpx.Client,
) -> None:
    """Its total has the costs of its longest route; no objective has the second's own."""
    total = {**TIME, "name": "total", "over": "sum"}
    objectives = [total, TIME, {"name": "vans", "measure": "vehicles"}]
    answer = client.post("/fleet", json={**request(), "objectives": objectives}).json()
    assert [len(plan["lengths"]) for plan in answer["front"]] == [3] * len(answer["front"])
    assert all(len(plan["losses"]) == 3 and "balance" not in plan for plan in answer["front"])
    first, *_ = answer["front"][full_plan(answer)]["routes"]
    way = {"route": 0, "done": first["stops"][1:2]}
    new = {"id": "new", "location": [24.93, 60.16]}
    changes = {"plan": full_plan(answer), "routes": [way], "add": [new]}
    response = replan(client, answer, **changes)
    assert response.status_code == 200, response.text
    rest = response.json()
    assert [each["name"] for each in rest["objectives"]] == ["total", "time", "vans"]
    assert all(plan["lengths"][2] == len(plan["routes"]) for plan in rest["front"])
    drawn = client.get(f"/front/{rest['id']}", headers={"Accept": "application/geo+json"}).json()
    assert len(drawn["features"][0]["properties"]["losses"]) == 3


@pytest.mark.parametrize(
    ("objectives", "pointer", "sentence"),
    [
        (
            [DISTANCE, TIME, {**DISTANCE, "name": "c", "speed": 5}],
            "/objectives/2",
            "two kinds at most",
        ),
        ([DISTANCE, TIME, {**TIME, "name": "c"}], "/objectives/2/over", "objectives/1 is max"),
        (
            [DISTANCE, *({"name": name, "measure": "vehicles"} for name in "ab")],
            "/objectives/2/measure",
            "another than that of objectives/1",
        ),
        (
            [{**DISTANCE, "over": "max"}, {"name": "b", "measure": "vehicles"}],
            "/objectives/1/measure",
            "needs a first objective over sum",
        ),
        (
            [{"name": "a", "measure": "vehicles"}, DISTANCE],
            "/objectives/0/measure",
            "must not be given for the first objective",
        ),
        ([DISTANCE, TIME, DISTANCE, TIME, TIME], "/objectives", "4 items or fewer"),
    ],
)
def test_objectives_that_do_not_fit_each_other_are_refused_where_they_stand(
    client: httpx.Client, objectives: list[dict[str, Any]], pointer: str, sentence: str
) -> None:
    body = {**request(), "objectives": objectives}
    body["vehicles"][0].pop("shift")
    for stop in body["stops"]:
        stop.pop("service", None)
    del body["clock"]
    response = client.post("/fleet", json=body)
    assert response.status_code == 422, response.text
    problem = response.json()
    assert problem["errors"][0]["pointer"] == pointer, problem
    assert sentence in problem["detail"]
