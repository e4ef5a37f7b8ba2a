"""POST /fleet against a live server: plans with routes, jobs, GeoJSON, and refusals."""

import time
import uuid
from itertools import pairwise
from typing import Any

import httpx
import pytest
from paretour import Refused

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.plans import Plan, Route
from service.fleet.schedule import schedule
from tests.helpers.fleet_requests import fleet_of, fleet_request
from tests.helpers.serving import problem
from tests.helpers.straight_lines import metres_between, seconds_between

GEOJSON = {"Accept": "application/geo+json"}


@pytest.fixture(scope="module")
def answer(client: httpx.Client) -> dict[str, Any]:
    response = client.post("/fleet", json=fleet_request())
    assert response.status_code == 200, response.text
    front: dict[str, Any] = response.json()
    return front


def test_every_plan_keeps_the_rules_and_has_the_lengths_that_it_says(
    answer: dict[str, Any],
) -> None:
    request = fleet_request()
    fleet = fleet_of(request)
    indexes = {stop["id"]: index for index, stop in enumerate(request["stops"])}
    vehicles = {vehicle["id"]: index for index, vehicle in enumerate(request["vehicles"])}
    assert answer["front"]
    for item in answer["front"]:
        routes = []
        for each in item["routes"]:
            stops = tuple(indexes[stop] for stop in each["stops"] if stop != "stop-0")
            routes.append(Route(vehicles[each["vehicle"]], stops))
            assert each["stops"][0] == "stop-0"
            assert each["load"] == [greatest_load(each["stops"])]
            assert each["arrivals"] == list(schedule(fleet, routes[-1]).arrivals)
        plan = Plan(tuple(routes))
        assert violations(fleet, plan) == []
        assert item["lengths"] == pytest.approx(plan_lengths(fleet, plan))
        missing = set(indexes) - {stop for each in item["routes"] for stop in each["stops"]}
        assert set(item["unassigned"]) == missing


def greatest_load(stops: list[str]) -> int:
    """The most that a vehicle holds, of three loads. It takes one from stop-3 to stop-4."""
    demand = {"stop-1": 2, "stop-2": 1}
    load = most = sum(demand.get(stop, 0) for stop in stops)
    for stop in stops:
        load += {"stop-3": 3, "stop-4": -3}.get(stop, -demand.get(stop, 0))
        most = max(most, load)
    return most


def test_a_front_of_plans_ascends_and_is_named(answer: dict[str, Any]) -> None:
    lengths = [item["lengths"] for item in answer["front"]]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(lengths))
    assert answer["objectives"] == [
        {"name": "distance", "unit": "m", "over": "sum"},
        {"name": "time", "unit": "min", "over": "max"},
    ]
    assert answer["clock"] == {"name": "time", "unit": "min"}
    assert [stop["id"] for stop in answer["stops"]] == [f"stop-{i}" for i in range(8)]
    assert answer["cities"] == 8
    assert 0 < answer["hypervolume"] <= 1
    assert {"costs", "improvement", "total"} <= answer["timings_ms"].keys()


def test_a_front_of_plans_is_stored_and_forgotten(client: httpx.Client) -> None:
    front = client.post("/fleet", json=fleet_request()).json()
    path = f"/front/{front['id']}"
    assert client.get(path).json() == front
    assert problem(client.get("/tour?knee"), 404, "no-tours")
    assert problem(client.get("/tour", params={"knee": "", "front": front["id"]}), 404, "no-tours")
    assert client.delete(path).status_code == 204
    assert client.get(path).status_code == 404


def test_a_job_tells_its_progress_and_is_repeated_by_its_key(client: httpx.Client) -> None:
    headers = {"Prefer": "respond-async", "Idempotency-Key": uuid.uuid4().hex}
    accepted = client.post("/fleet", json=fleet_request(), headers=headers)
    assert accepted.status_code == 202
    path = accepted.headers["Location"]
    first = client.get(path).json()
    assert (first["front"], first["objectives"][1]["over"]) == ([], "max") or first["front"]
    with client.stream("GET", f"{path}/events") as stream:
        events = "".join(stream.iter_text())
    assert '"status":"done"' in events
    again = client.post("/fleet", json=fleet_request(), headers=headers)
    assert again.headers["Location"] == path
    assert client.get(path).json()["status"] == "done"


def test_a_job_is_cancelled(client: httpx.Client) -> None:
    headers = {"Prefer": "respond-async"}
    path = client.post("/fleet", json=fleet_request(), headers=headers).headers["Location"]
    client.delete(path)
    while (front := client.get(path)).json().get("status") in ("queued", "running"):
        time.sleep(0.01)
    assert front.status_code == 404 or front.json()["status"] in ("cancelled", "done")


def test_a_fleet_without_a_plan_is_refused_with_the_reason(client: httpx.Client) -> None:
    request = fleet_request()
    request["stops"][1]["demand"] = [9]
    refused = problem(client.post("/fleet", json=request), 422, "no-plan")
    assert refused["detail"] == "the demand of stop 'stop-1' is over the capacity of every vehicle"
    accepted = client.post("/fleet", json=request, headers={"Prefer": "respond-async"})
    path = accepted.headers["Location"]
    while (front := client.get(path).json())["status"] in ("queued", "running"):
        time.sleep(0.01)
    assert (front["status"], front["problem"]["code"]) == ("failed", "no-plan")
    for document in (refused, front["problem"]):
        remedy = Refused(document).remedies[0]
        assert client.post("/fleet", json=remedy.applied_to(request)).status_code == 200


def test_a_reference_point_that_plainly_no_plan_comes_below_is_refused(
    client: httpx.Client,
) -> None:
    request = {**fleet_request(), "reference_point": [1e9, 1]}
    refused = problem(client.post("/fleet", json=request), 422, "invalid-request")
    assert refused["detail"].startswith("reference_point/1 must be more than ")
    assert refused["detail"].endswith("which every plan has at least, got 1")


def test_plans_are_drawn_with_a_line_for_each_route(
    client: httpx.Client, answer: dict[str, Any]
) -> None:
    drawn = client.get(f"/front/{answer['id']}", headers=GEOJSON).json()
    lines = [each for each in drawn["features"] if each["geometry"]["type"] == "LineString"]
    places = {stop["id"]: stop["location"] for stop in answer["stops"]}
    routes = [route for item in answer["front"] for route in item["routes"]]
    assert [line["properties"]["stops"] for line in lines] == [each["stops"] for each in routes]
    for line in lines:
        stops = line["properties"]["stops"]
        assert line["geometry"]["coordinates"] == [places[stop] for stop in stops]
        plan = answer["front"][line["properties"]["plan"]]
        assert line["properties"]["plan_lengths"] == plan["lengths"]
    assert len(drawn["features"]) == len(lines) + len(places)


def test_a_file_beside_a_fleet_is_refused(client: httpx.Client) -> None:
    refused = client.post("/fleet", files={"request": b"{}", "matrices": b""})
    problem(refused, 415, "not-json")


def test_the_network_plans_fleets_only_without_time(client: httpx.Client) -> None:
    request = fleet_request()
    request["time_limit"] = 0
    assert "shipments" in problem(client.post("/fleet", json=request), 422, "no-plan")["detail"]
    del request["shipments"]
    front = client.post("/fleet", json=request).json()
    assert front["terminated"] == "converged"
    assert front["actor"]["name"] == "pa-one-matrix"
    assert front["front"]
    searched = client.post("/fleet", json={**request, "time_limit": 0.1}).json()
    assert searched["front"]
    assert searched["actor"] is None


HOUR, SPEED = 3600, 36
PLACES = {
    "depot": [24.94, 60.17],
    "near": [24.96, 60.17],
    "north": [24.94, 60.2],
    "far": [25.1, 60.17],
}
# The van would visit "near" first; its window makes it the last stop.
TIMED: dict[str, Any] = {
    "stops": [
        {"id": "depot", "location": PLACES["depot"]},
        {"id": "near", "location": PLACES["near"], "window": [11 * HOUR, 12 * HOUR]},
        {"id": "north", "location": PLACES["north"], "service": 300},
        {"id": "far", "location": PLACES["far"], "window": [9 * HOUR, 9 * HOUR + 900]},
    ],
    "vehicles": [{"id": "van", "start": "depot", "end": "depot", "shift": [8 * HOUR, 18 * HOUR]}],
    "objectives": [
        {"name": "distance", "from": "great_circle"},
        {"name": "time", "from": "great_circle", "speed": SPEED, "over": "max"},
    ],
    "clock": "time",
    "time_limit": 0.2,
}


def test_windows_are_kept_along_straight_lines_without_a_routing_engine(
    client: httpx.Client,
) -> None:
    front = client.post("/fleet", json=TIMED)
    assert front.status_code == 200, front.text
    assert [each["unit"] for each in front.json()["objectives"]] == ["m", "s"]
    stops = {stop["id"]: stop for stop in TIMED["stops"]}
    assert front.json()["front"]
    for plan in front.json()["front"]:
        [route] = plan["routes"]
        clock = route["arrivals"][0]
        for here, there, arrival in zip(
            route["stops"], route["stops"][1:], route["arrivals"][1:], strict=False
        ):
            # The window of a stop is for when its visit begins.
            begins = max(clock, stops[here].get("window", [0])[0])
            assert begins <= stops[here].get("window", [0, HOUR * 24])[1]
            way = seconds_between(PLACES[here], PLACES[there], SPEED)
            clock = begins + stops[here].get("service", 0) + way
            assert arrival == pytest.approx(clock)
        assert plan["lengths"][1] == pytest.approx(clock - route["arrivals"][0])
        metres = [
            metres_between(PLACES[here], PLACES[there]) for here, there in pairwise(route["stops"])
        ]
        assert plan["lengths"][0] == pytest.approx(sum(metres))


def test_a_window_that_a_speed_is_too_slow_for_has_no_plan(client: httpx.Client) -> None:
    way, objectives = TIMED["objectives"][0], TIMED["objectives"]
    slow = {**TIMED, "objectives": [way, {**objectives[1], "speed": 5}]}
    slow["vehicles"] = [{**TIMED["vehicles"][0], "shift": [8 * HOUR, 10 * HOUR]}]
    slow["stops"] = [TIMED["stops"][0], TIMED["stops"][3]]
    refused = problem(client.post("/fleet", json=slow), 422, "no-plan")
    assert "far" in refused["detail"]


def test_a_speed_by_road_is_pointed_at(client: httpx.Client) -> None:
    way, time = TIMED["objectives"]
    body = {**TIMED, "objectives": [way, {**time, "from": "road_time"}]}
    refused = problem(client.post("/fleet", json=body), 422, "invalid-request")
    assert refused["errors"][0]["pointer"] == "/objectives/1/speed"


def test_the_routes_of_a_fleet_at_a_speed_are_geojson(client: httpx.Client) -> None:
    answer = client.post("/fleet", json=TIMED, headers=GEOJSON).json()
    properties = answer["features"][0]["properties"]
    assert properties["units"] == ["m", "s"]
