"""Lines along the streets over HTTP: as the engine tells them, or refused for a reason."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import httpx
import numpy as np
import pytest

from service.api.app import Edge
from service.roads.client import RoadClient
from service.roads.router import RouterSettings
from tests.helpers.fake_router import (
    BEYOND,
    FakeOsrm,
    Misbehaviour,
    fake_osrm,
    replying,
    sleeping,
    snapped,
)
from tests.helpers.serving import LIMITS, app_of, problem, serving

ACCEPT = {"Accept": "application/geo+json"}
ROADS = {"geometry": "roads"}


def _request(n: int = 6, seed: int = 1, **more: Any) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    places = rng.uniform((24.0, 60.0), (25.0, 61.0), (n, 2)).round(6)
    way = {"name": "way", "from": "great_circle"}
    objectives = [way, {"name": "risk", "matrix": rng.random((n, n)).tolist()}]
    stops = [{"id": f"order-{i}", "location": place} for i, place in enumerate(places.tolist())]
    return {"stops": stops, "objectives": objectives, "time_limit": 0, **more}


@pytest.fixture(scope="module")
def engine() -> Iterator[FakeOsrm]:
    with fake_osrm() as fake:
        yield fake


@contextmanager
def _client(engine: FakeOsrm, seconds: float) -> Iterator[httpx.Client]:
    """Serve with an engine that must answer within some seconds."""
    settings = RouterSettings(
        url=engine.url, router="osrm", profile="driving", seconds=seconds, cache_bytes=0, legs=40
    )
    app = app_of(
        edge=Edge(streets=RoadClient(settings)), limits=replace(LIMITS, roads=True, seconds=5.0)
    )
    with serving(app) as address, httpx.Client(base_url=address, timeout=300) as client:
        yield client


@pytest.fixture(scope="module")
def client(engine: FakeOsrm) -> Iterator[httpx.Client]:
    with _client(engine, seconds=20.0) as client:
        yield client


@pytest.fixture
def misbehave(engine: FakeOsrm) -> Iterator[Callable[[Misbehaviour], None]]:
    usual = engine.misbehave
    yield lambda misbehaviour: setattr(engine, "misbehave", misbehaviour)
    engine.misbehave = usual


def _check(line: dict[str, Any], tour: list[int], request: dict[str, Any]) -> None:
    """Check that a line goes from stop to stop by the corners of the fake's streets."""
    corners = snapped(np.array([stop["location"] for stop in request["stops"]]))[tour]
    turns = np.column_stack((corners[1:, 0], corners[:-1, 1]))
    legs = np.stack((turns, corners[1:]), axis=1).reshape(-1, 2)
    assert line["geometry"]["type"] == "LineString"
    np.testing.assert_allclose(
        line["geometry"]["coordinates"], np.vstack((corners[:1], legs)), atol=1e-6
    )


@pytest.mark.parametrize("closed", [True, False])
def test_the_lines_of_a_front_and_of_its_tours_follow_the_streets(
    client: httpx.Client, closed: bool
) -> None:
    request = _request(closed=closed, **ROADS)
    answer = client.post("/front", json=request, headers=ACCEPT)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/geo+json")
    path = f"/front/{answer.json()['id']}"
    tours = client.get(path).json()["front"]
    lines = [each for each in answer.json()["features"] if "lengths" in each["properties"]]
    for line, each in zip(lines, tours, strict=True):
        _check(line, each["tour"] + each["tour"][:1] * closed, request)
    assert client.get(path, params=ROADS, headers=ACCEPT).json() == answer.json()
    assert client.get(path, headers=ACCEPT).json() != answer.json()
    tour = client.get("/tour", params={"balance": 0, **ROADS}, headers=ACCEPT).json()
    assert tour["features"][0] == lines[0]


def test_the_lines_of_routes_follow_the_streets_to_and_from_their_depots(
    client: httpx.Client,
) -> None:
    request = _request(**ROADS)
    request["objectives"][1]["over"] = "max"
    request["vehicles"] = [{"id": "van", "count": 2, "start": "order-0", "end": "order-1"}]
    answer = client.post("/fleet", json=request, headers=ACCEPT)
    assert answer.status_code == 200, answer.text
    routes = [each for each in answer.json()["features"] if "vehicle" in each["properties"]]
    # A plan of two vehicles has routes of different numbers of stops.
    assert len({len(line["properties"]["stops"]) for line in routes}) > 1
    for line in routes:
        stops = [int(stop.removeprefix("order-")) for stop in line["properties"]["stops"]]
        _check(line, stops, request)


def test_a_job_says_where_its_front_along_the_streets_will_be(client: httpx.Client) -> None:
    headers = {**ACCEPT, "Prefer": "respond-async"}
    accepted = client.post("/front", json=_request(**ROADS), headers=headers)
    assert accepted.status_code == 202
    location = accepted.headers["location"]
    assert location == f"/front/{accepted.json()['id']}?geometry=roads"
    while (answer := client.get(location, headers=ACCEPT).json())["status"] != "done":
        time.sleep(0.02)
    assert len(answer["features"][0]["geometry"]["coordinates"]) > 7


def test_one_stop_is_a_line_of_two_positions(client: httpx.Client) -> None:
    answer = client.post("/front", json=_request(1, **ROADS), headers=ACCEPT).json()
    assert len(answer["features"][0]["geometry"]["coordinates"]) == 2


@pytest.mark.parametrize(
    ("misbehaviour", "status", "code"),
    [
        (replying(503), 503, "router-unavailable"),
        (replying(0), 503, "router-unavailable"),
        (replying(200, b"<html>"), 502, "router-unusable"),
        (replying(200, b"[" * 10_000_000), 502, "router-unusable"),
        (replying(200, b'{"code": "Ok", "sources": [], "routes": []}'), 502, "router-unusable"),
    ],
)
def test_an_engine_that_fails_is_a_clear_problem(
    client: httpx.Client,
    misbehave: Callable[[Misbehaviour], None],
    misbehaviour: Misbehaviour,
    status: int,
    code: str,
) -> None:
    _fails(client, misbehave, misbehaviour, status, code)


def test_an_engine_that_is_too_slow_is_a_clear_problem(
    engine: FakeOsrm, misbehave: Callable[[Misbehaviour], None]
) -> None:
    with _client(engine, seconds=0.2) as client:
        _fails(client, misbehave, sleeping(0.5), 504, "router-too-slow")


def _fails(
    client: httpx.Client,
    misbehave: Callable[[Misbehaviour], None],
    misbehaviour: Misbehaviour,
    status: int,
    code: str,
) -> None:
    planned = client.post("/front", json=_request()).json()["id"]
    misbehave(misbehaviour)
    path = f"/front/{planned}"
    problem(client.get(path, params=ROADS, headers=ACCEPT), status, code)
    # What needs no engine is answered all the same.
    assert client.get(path, headers=ACCEPT).status_code == 200
    assert client.get("/health/ready").status_code == 200


def test_nothing_more_is_asked_for_a_caller_who_has_gone(
    client: httpx.Client, engine: FakeOsrm, misbehave: Callable[[Misbehaviour], None]
) -> None:
    planned = client.post("/front", json=_request()).json()["id"]
    misbehave(sleeping(2.0))  # long enough for a busy machine to notice that the caller has gone
    before = len(engine.asked)
    with pytest.raises(httpx.ReadTimeout):
        client.get(f"/front/{planned}", params=ROADS, headers=ACCEPT, timeout=0.2)
    time.sleep(3.0)
    # The streets would have been asked for after the nearest roads.
    assert len(engine.asked) <= before + 1


def test_streets_that_are_not_there_are_named(client: httpx.Client) -> None:
    request = _request(**ROADS)
    request["stops"][2]["location"][0] = BEYOND + 1
    document = problem(client.post("/front", json=request, headers=ACCEPT), 422, "no-road")
    assert "'order-2'" in document["detail"]


def test_more_legs_than_an_answer_may_have_are_refused_and_one_tour_is_drawn(
    client: httpx.Client,
) -> None:
    request = _request(30, size=5, **ROADS) | {"time_limit": 0.05}
    answer = client.post("/front", json=request, headers=ACCEPT)
    document = problem(answer, 422, "streets-too-long")
    assert document["limit"] == 40 < document["actual"]
    tour = client.get("/tour", params={"knee": "", **ROADS}, headers=ACCEPT)
    assert tour.status_code == 200


def test_streets_are_of_geojson_alone(client: httpx.Client) -> None:
    document = problem(client.post("/front", json=_request(**ROADS)), 422, "invalid-request")
    assert document["errors"][0]["pointer"] == "/geometry"
    client.post("/front", json=_request())
    document = problem(client.get("/tour?knee&geometry=roads"), 422, "invalid-request")
    assert document["errors"][0]["parameter"] == "geometry"
    assert "application/geo+json" in document["detail"]
    assert client.get("/tour?knee&geometry=straight").status_code == 200


def test_an_unknown_geometry_is_refused(client: httpx.Client) -> None:
    answer = client.post("/front", json=_request(geometry="lanes"), headers=ACCEPT)
    document = problem(answer, 422, "invalid-request")
    assert document["errors"][0]["pointer"] == "/geometry"
    planned = client.post("/front", json=_request()).json()["id"]
    for path in (f"/front/{planned}?geometry=lanes", "/tour?knee&geometry=lanes"):
        document = problem(client.get(path, headers=ACCEPT), 422, "invalid-request")
        assert document["errors"][0]["parameter"] == "geometry"


def test_without_an_engine_streets_are_refused_before_anything_is_planned() -> None:
    with serving(app_of()) as address, httpx.Client(base_url=address) as client:
        refused = client.post("/front", json=_request(**ROADS), headers=ACCEPT)
        document = problem(refused, 422, "no-router")
        assert document["errors"][0]["pointer"] == "/geometry"
        problem(client.get("/tour?knee"), 404, "no-front")
        planned = client.post("/front", json=_request()).json()["id"]
        for path in (f"/front/{planned}?geometry=roads", "/tour?knee&geometry=roads"):
            document = problem(client.get(path, headers=ACCEPT), 422, "no-router")
            assert document["errors"][0]["parameter"] == "geometry"


def test_one_plan_of_a_fleet_is_drawn_alone(client: httpx.Client) -> None:
    request = _request(time_limit=5)  # it ends once all plans are tried
    request["objectives"][1]["over"] = "max"
    request["vehicles"] = [{"id": "van", "count": 2, "start": "order-0", "end": "order-0"}]
    front = client.post("/fleet", json=request).json()
    assert len(front["front"]) > 1
    path = f"/front/{front['id']}"
    answer = client.get(path, params=ROADS, headers=ACCEPT)
    assert answer.status_code == 200, answer.text
    drawn = answer.json()["features"]
    stops = [each for each in drawn if "stop" in each["properties"]]
    for plan in range(len(front["front"])):
        alone = client.get(path, params={"plan": plan, **ROADS}, headers=ACCEPT).json()
        routes = [each for each in drawn if each["properties"].get("plan") == plan]
        assert alone["features"] == [*routes, *stops]
    many = {"plan": len(front["front"])}
    document = problem(client.get(path, params=many, headers=ACCEPT), 422, "invalid-request")
    assert document["errors"][0]["parameter"] == "plan"
    assert f"less than {len(front['front'])}" in document["detail"]


def test_a_plan_is_drawn_of_a_fleet_and_in_geojson_alone(client: httpx.Client) -> None:
    path = f"/front/{client.post('/front', json=_request()).json()['id']}"
    for headers, said in ((ACCEPT, "GET /tour"), ({}, "application/geo+json")):
        answer = client.get(path, params={"plan": 0}, headers=headers)
        document = problem(answer, 422, "invalid-request")
        assert document["errors"][0]["parameter"] == "plan"
        assert said in document["detail"]
