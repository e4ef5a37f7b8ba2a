"""POST /fleet against a live server: plans with routes, jobs, GeoJSON, and refusals."""

import time
import uuid
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import httpx
import pytest

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.plans import Plan, Route
from service.fleet.schedule import schedule
from tests.helpers.fleet_requests import fleet_of, fleet_request
from tests.helpers.serving import app_of, problem, serving

GEOJSON = {"Accept": "application/geo+json"}


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with serving(app_of()) as address, httpx.Client(base_url=address, timeout=30) as client:
        yield client


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
            assert each["arrivals"] == list(schedule(fleet, routes[-1]).arrivals)
        plan = Plan(tuple(routes))
        assert violations(fleet, plan) == []
        assert item["lengths"] == pytest.approx(plan_lengths(fleet, plan))
        missing = set(indexes) - {stop for each in item["routes"] for stop in each["stops"]}
        assert set(item["unassigned"]) == missing


def test_a_front_of_plans_ascends_and_is_named(answer: dict[str, Any]) -> None:
    lengths = [item["lengths"] for item in answer["front"]]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in pairwise(lengths))
    assert answer["objectives"] == [
        {"name": "distance", "unit": "m", "over": "sum"},
        {"name": "time", "unit": "min", "over": "max"},
    ]
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


def test_a_fleet_cannot_be_replanned(client: httpx.Client, answer: dict[str, Any]) -> None:
    refused = client.post(f"/front/{answer['id']}/replan", json={})
    assert "POST /fleet" in problem(refused, 409, "not-replannable")["detail"]


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


def test_without_time_the_tours_of_the_network_are_cut(client: httpx.Client) -> None:
    request = fleet_request()
    request["time_limit"] = 0
    assert "shipments" in problem(client.post("/fleet", json=request), 422, "no-plan")["detail"]
    del request["shipments"]
    front = client.post("/fleet", json=request).json()
    assert front["terminated"] == "converged"
    assert front["actor"]["name"] == "pa-one-matrix"
    assert front["front"]
