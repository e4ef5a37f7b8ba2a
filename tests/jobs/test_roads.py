"""Jobs whose costs are those of roads: measured before they take a worker, or refused in time."""

import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event
from typing import Any

import httpx
import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.server import Ending, build
from service.settings import Settings
from tests.helpers.fake_router import (
    BEYOND,
    FakeOsrm,
    Misbehaviour,
    fake_osrm,
    replying,
    road_costs,
    sleeping,
    waiting,
    without_ways,
)
from tests.helpers.instances import every_tour
from tests.helpers.processes import UNLIMITED
from tests.helpers.serving import problem, serving


def _request(n: int = 7, seed: int = 1, **more: Any) -> dict[str, Any]:
    places = np.random.default_rng(seed).uniform((24.0, 60.0), (25.0, 61.0), (n, 2)).round(6)
    stops = [{"id": f"order-{i}", "location": place} for i, place in enumerate(places.tolist())]
    objectives = [
        {"name": "time", "from": "road_time"},
        {"name": "distance", "from": "road_distance"},
    ]
    return {"stops": stops, "objectives": objectives, "time_limit": 0.1, "seed": 1, **more}


@pytest.fixture(scope="module")
def engine() -> Iterator[FakeOsrm]:
    with fake_osrm() as fake:
        yield fake


@contextmanager
def service(engine: FakeOsrm, router_seconds: float) -> Iterator[str]:
    settings = Settings(
        workers=1,
        rate=UNLIMITED,
        router_url=engine.url,
        router="osrm",
        router_seconds=router_seconds,
    )
    with serving(build(settings, Ending())) as url:
        yield url


@pytest.fixture(scope="module")
def url(engine: FakeOsrm) -> Iterator[str]:
    with service(engine, router_seconds=60.0) as url:
        yield url


@contextmanager
def misbehaving(engine: FakeOsrm, misbehave: Misbehaviour) -> Iterator[None]:
    engine.misbehave, usual = misbehave, engine.misbehave
    try:
        yield
    finally:
        engine.misbehave = usual


def test_a_front_by_road_has_the_lengths_of_the_engine(url: str) -> None:
    request = _request()
    answer = httpx.post(f"{url}/front", json=request).json()
    places = np.array([stop["location"] for stop in request["stops"]])
    costs = road_costs(places, places)
    assert answer["timings_ms"]["roads"] > 0
    assert [each["unit"] for each in answer["objectives"]] == ["s", "m"]
    for each in answer["front"]:
        tour = each["tour"]
        lengths = costs[:, tour, np.roll(tour, -1)].sum(axis=1)
        assert each["lengths"] == pytest.approx(lengths)
        assert each["stops"] == [f"order-{city}" for city in tour]


def test_one_objective_by_road_beside_one_of_ones_own(url: str) -> None:
    risk = np.random.default_rng(2).integers(1, 9, (7, 7)).tolist()
    objectives = [{"name": "time", "from": "road_time"}, {"name": "risk", "matrix": risk}]
    answer = httpx.post(f"{url}/front", json=_request(objectives=objectives)).json()
    for each in answer["front"]:
        tour = each["tour"]
        assert each["lengths"][1] == np.array(risk)[tour, np.roll(tour, -1)].sum()


def test_factors_of_the_day_hold_for_times_by_road(url: str) -> None:
    objectives = [
        {"name": "time", "from": "road_time", "over_the_day": [[0, 1.0], [60_000, 2.0]]},
        {"name": "distance", "from": "road_distance"},
    ]
    usual, slow = (
        httpx.post(f"{url}/front", json=_request(objectives=objectives, departure=when)).json()
        for when in (0, 60_000)
    )
    places = np.array([stop["location"] for stop in _request()["stops"]])
    costs = road_costs(places, places)
    for front, factors in ((usual, [1, 1]), (slow, [2, 1])):
        for each in front["front"]:
            tour = each["tour"]
            lengths = costs[:, tour, np.roll(tour, -1)].sum(axis=1) * factors
            assert each["lengths"] == pytest.approx(lengths)


def test_a_repeat_does_not_ask_the_engine_again(url: str, engine: FakeOsrm) -> None:
    httpx.post(f"{url}/front", json=_request(seed=3))
    asked = len(engine.asked)
    again = httpx.post(f"{url}/front", json=_request(seed=3, time_limit=0.2))
    assert again.status_code == 200
    assert len(engine.asked) == asked


def test_the_engine_is_asked_by_the_job_and_not_before_the_answer(
    url: str, engine: FakeOsrm
) -> None:
    gate = Event()
    with misbehaving(engine, waiting(gate)):
        headers = {"Prefer": "respond-async"}
        accepted = httpx.post(f"{url}/front", json=_request(seed=4), headers=headers, timeout=300)
        assert accepted.status_code == 202
        gate.set()
        found = _finished(url, accepted.json()["id"])
    assert found["status"] == "done"


def test_jobs_that_wait_for_the_engine_take_no_worker(url: str, engine: FakeOsrm) -> None:
    gate = Event()
    with misbehaving(engine, waiting(gate)):
        headers = {"Prefer": "respond-async"}
        jobs = [
            httpx.post(f"{url}/front", json=_request(seed=seed), headers=headers).json()["id"]
            for seed in (5, 6, 7)
        ]
        other = {"coordinates": [[0, 0, 1, 3], [2, 5, 0, 0], [4, 1, 2, 2]], "time_limit": 0}
        assert httpx.post(f"{url}/front", json=other, timeout=300).status_code == 200
        gate.set()
        assert all(_finished(url, id_)["status"] == "done" for id_ in jobs)


def test_a_cancelled_job_asks_no_more(url: str, engine: FakeOsrm) -> None:
    with misbehaving(engine, sleeping(0.3)):
        headers = {"Prefer": "respond-async"}
        # 140 stops take 9 blocks.
        request = _request(140, seed=8)
        id_ = httpx.post(f"{url}/front", json=request, headers=headers).json()["id"]
        time.sleep(0.1)
        cancelled = httpx.delete(f"{url}/front/{id_}")
        assert cancelled.json()["status"] == "cancelled"
        time.sleep(0.4)
        asked = len(engine.asked)
        time.sleep(0.7)
        assert len(engine.asked) == asked


def test_a_client_that_goes_away_asks_no_more(url: str, engine: FakeOsrm) -> None:
    with misbehaving(engine, sleeping(0.3)):
        with pytest.raises(httpx.ReadTimeout):
            httpx.post(f"{url}/front", json=_request(140, seed=9), timeout=0.5)
        time.sleep(0.5)
        asked = len(engine.asked)
        time.sleep(0.7)
        assert len(engine.asked) == asked
    # Its place is free again.
    assert httpx.post(f"{url}/front", json=_request(seed=10)).status_code == 200


@pytest.mark.parametrize(
    ("misbehave", "status", "code"),
    [
        (replying(503), 503, "router-unavailable"),
        (replying(0), 503, "router-unavailable"),
        (replying(200, b"<html>"), 502, "router-unusable"),
        (replying(200, b" " * 10_000_000), 502, "router-unusable"),
    ],
    ids=["busy", "hanging up", "wrong", "10 MB"],
)
def test_an_engine_that_fails_is_a_clear_problem(
    url: str, engine: FakeOsrm, misbehave: Misbehaviour, status: int, code: str
) -> None:
    _fails(url, engine, misbehave, status, code)


def test_an_engine_that_is_slow_is_a_clear_problem_before_it_answers(engine: FakeOsrm) -> None:
    gate = Event()
    with service(engine, router_seconds=0.5) as url:
        try:
            _fails(url, engine, waiting(gate), 504, "router-too-slow")
        finally:
            gate.set()


def _fails(url: str, engine: FakeOsrm, misbehave: Misbehaviour, status: int, code: str) -> None:
    """Check what comes of a request by road while the engine fails, and after that."""
    # Other stops each time, since costs are remembered.
    request = _request(seed=1000 + len(engine.asked))
    with misbehaving(engine, misbehave):
        problem(httpx.post(f"{url}/front", json=request, timeout=300), status, code)
        headers = {"Prefer": "respond-async"}
        accepted = httpx.post(f"{url}/front", json=request, headers=headers).json()
        found = _finished(url, accepted["id"])
    assert (found["status"], found["problem"]["code"]) == ("failed", code)
    # Nothing is left of it: the next request is planned.
    assert httpx.post(f"{url}/front", json=request).status_code == 200


def test_stops_without_a_way_are_named(url: str) -> None:
    request = _request(seed=12)
    request["stops"][3]["location"][0] = BEYOND + 1
    document = problem(httpx.post(f"{url}/front", json=request), 422, "no-road")
    assert document["errors"][0]["pointer"] == "/stops/3"
    assert "'order-3'" in document["detail"]


def test_a_way_that_the_engine_knows_in_one_direction_alone_is_driven_in_that_alone(
    url: str, engine: FakeOsrm
) -> None:
    request = _request(seed=21)
    places = np.array([stop["location"] for stop in request["stops"]])
    forgotten = np.random.default_rng(21).random((7, 7)) < 0.3
    costs = np.where(forgotten & ~np.eye(7, dtype=bool), np.inf, road_costs(places, places))
    with misbehaving(engine, without_ways(places, forgotten)):
        answer = httpx.post(f"{url}/front", json=request)
    instance = Instance(matrices=costs)
    lengths = tour_lengths(instance, every_tour(instance))
    expected = lengths[nondominated(lengths)]
    assert len(expected) > 0
    np.testing.assert_allclose([each["lengths"] for each in answer.json()["front"]], expected)
    # Costs by road that have been changed are stored as JSON: a closed leg stays closed.
    for _ in range(2):
        front = answer.json()
        origin, destination = front["front"][0]["tour"][:2]
        costs[:, origin, destination] = np.inf
        closed = {"objective": 0, "from": origin, "to": destination, "cost": None}
        answer = httpx.post(
            f"{url}/front/{front['id']}/replan", json={"costs": [closed], "time_limit": 0.1}
        )
        instance = Instance(matrices=costs)
        lengths = tour_lengths(instance, every_tour(instance))
        found = [each["lengths"] for each in answer.json().get("front", ())]
        np.testing.assert_allclose(np.array(found).reshape(-1, 2), lengths[nondominated(lengths)])
        if not found:
            problem(answer, 422, "no-plan")
            return


def test_a_stop_without_a_way_out_ends_no_closed_tour_but_may_end_a_route(
    url: str, engine: FakeOsrm
) -> None:
    request = _request(seed=22)
    places = np.array([stop["location"] for stop in request["stops"]])
    forgotten = np.zeros((7, 7), np.bool_)
    forgotten[4] = True
    with misbehaving(engine, without_ways(places, forgotten)):
        document = problem(httpx.post(f"{url}/front", json=request), 422, "no-road")
        route = httpx.post(f"{url}/front", json={**request, "closed": False}).json()
    sentence = "a way must lead from stop 'order-4' to another stop, and none does"
    assert document["detail"] == sentence
    assert document["errors"][0]["pointer"] == "/stops/4"
    assert {each["stops"][-1] for each in route["front"]} == {"order-4"}


def test_what_is_asked_of_the_engine_is_counted(url: str, engine: FakeOsrm) -> None:
    def counted() -> dict[str, float]:
        lines = httpx.get(f"{url}/metrics").text.splitlines()
        pairs = (line.rsplit(" ", 1) for line in lines if line.startswith("paretour_router_"))
        return {name: float(value) for name, value in pairs}

    before, asked = counted(), len(engine.asked)
    httpx.post(f"{url}/front", json=_request(seed=13))
    after = counted()
    name = 'paretour_router_requests_total{outcome="answered"}'
    assert after[name] - before[name] == len(engine.asked) - asked == 2
    name = "paretour_router_seconds_count"
    assert after[name] - before[name] == 2


def _finished(url: str, id: str) -> dict[str, Any]:
    """Wait until a job is finished, and return its front."""
    deadline = time.monotonic() + 20
    while time.monotonic() < deadline:
        found: dict[str, Any] = httpx.get(f"{url}/front/{id}").json()
        if found["status"] not in ("queued", "running"):
            return found
        time.sleep(0.05)
    raise TimeoutError(json.dumps(found)[:500])
