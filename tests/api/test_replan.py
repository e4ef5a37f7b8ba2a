"""POST /front/{id}/replan against a live server."""

import asyncio
import json
import time
import uuid
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from service.instance import Instance, tour_lengths
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.changes import random_change
from tests.helpers.serving import app_of, serving
from tests.helpers.stores import job, record
from tests.helpers.straight_lines import matrix_of

CITIES = np.random.default_rng(1).random((12, 4))
SHORT = {"coordinates": CITIES.tolist(), "time_limit": 0.1}
MAP = {
    "grid": [[0] * 4] * 3,
    "cell_size": 1.0,
    "origin": [0.0, 0.0, 0.0],
    "places": [[0, 0], [2, 0], [2, 3], [0, 3]],
    "cost_layer": [[1, 2, 3, 1]] * 3,
    "time_limit": 0.1,
}
NEW = {"id": "new", "coordinates": [[0.5, 0.5], [0.5, 0.5]]}


@pytest.fixture(scope="module")
def store() -> SqliteStore:
    return SqliteStore(IN_MEMORY, entries=20, max_age=60)


@pytest.fixture(scope="module")
def client(store: SqliteStore) -> Iterator[httpx.Client]:
    with (
        serving(app_of(store=store)) as address,
        httpx.Client(base_url=address, timeout=300) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def front(client: httpx.Client) -> dict[str, Any]:
    return client.post("/front", json=SHORT).json()


def replan(client: httpx.Client, front: dict[str, Any], **request: Any) -> httpx.Response:
    body = {"time_limit": 0.1, **request}
    return client.post(f"/front/{front['id']}/replan", json=body)


def problem(answer: httpx.Response) -> dict[str, Any]:
    assert answer.headers["content-type"] == "application/problem+json", answer.text
    return answer.json()


def test_the_rest_leads_from_the_last_that_is_done_back_to_the_start(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    driven = front["front"][0]["tour"]
    answer = replan(client, front, done=driven[:4], tour=driven, add=[NEW], remove=[driven[-1]])
    assert answer.status_code == 200, answer.text
    rest = answer.json()
    assert (rest["closed"], rest["cities"]) == (False, 10)
    left = {str(driven[3]), "0", "new", *map(str, driven[4:-1])}
    assert rest["stops"] == [
        {"id": name, "location": None}
        for name in sorted(left, key=lambda x: (x == "new", len(x), x))
    ]
    cities = np.concatenate((CITIES, [[0.5] * 4]))
    instance = Instance(coordinates=cities, closed=False)
    for tour in rest["front"]:
        assert (tour["stops"][0], tour["stops"][-1]) == (str(driven[3]), "0")
        assert set(tour["stops"]) == left
        assert 0 <= tour["kept"] <= 1
        way = [12 if name == "new" else int(name) for name in tour["stops"]]
        np.testing.assert_allclose(tour_lengths(instance, np.array([way]))[0], tour["lengths"])
    assert client.get(f"/front/{front['id']}").json() == front


def test_a_front_of_a_rest_is_replanned_and_asked_for_tours_like_any_other(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    rest = replan(client, front, done=[3], position=5).json()
    again = replan(
        client,
        rest,
        done=["5"],
        position="7",
        costs=[{"objective": "second", "from": "7", "to": "8", "cost": 0.0}],
    ).json()
    assert {tour["stops"][0] for tour in again["front"]} == {"7"}
    assert again["cities"] == rest["cities"] - 1
    tour = client.get("/tour", params={"front": again["id"], "knee": ""}).json()
    assert tour in [{"front": again["id"], **each} for each in again["front"]]


def test_a_tour_not_begun_remains_a_closed_tour(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    rest = replan(client, front, remove=[4]).json()
    assert "closed" not in rest
    assert {tour["stops"][0] for tour in rest["front"]} == {"0"}


def test_a_job_and_its_repeats_give_one_front(client: httpx.Client, front: dict[str, Any]) -> None:
    headers = {"Prefer": "respond-async", "Idempotency-Key": uuid.uuid4().hex}
    url, body = f"/front/{front['id']}/replan", {"done": [3], "time_limit": 0.1}
    answers = [client.post(url, json=body, headers=headers) for _ in range(2)]
    assert {answer.status_code for answer in answers} == {202}
    [path] = {answer.headers["Location"] for answer in answers}
    while (rest := client.get(path).json())["status"] in ("queued", "running"):
        time.sleep(0.02)
    assert (rest["status"], rest["front"][0]["stops"][0]) == ("done", "3")
    repeat = client.post(url, json=body, headers={"Idempotency-Key": headers["Idempotency-Key"]})
    assert repeat.json() == rest
    other = client.post(f"/front/{rest['id']}/replan", json=body, headers=headers)
    assert problem(other)["code"] == "idempotency-mismatch"


MEASURED = [{"name": "way", "from": "great_circle"}, {"name": "air", "from": "great_circle"}]


def changed(**entry: Any) -> dict[str, Any]:
    return {"costs": [{"objective": 0, "from": 1, "to": 2, "cost": 1, **entry}]}


@pytest.mark.parametrize(
    ("request_", "pointer", "detail"),
    [
        ({"done": ["x"]}, "/done/0", "must be the id of a stop"),
        ({"done": [12]}, "/done/0", "must be a stop of the front, 0 to 11, got 12"),
        ({"done": [1, 2, "1"]}, "/done/2", "must not be done/0 again"),
        ({"done": [1], "remove": [1]}, "/remove/0", "must be a stop that is not done"),
        ({"remove": [0]}, "/remove/0", "must not be where the way goes on"),
        ({"done": [1], "remove": [0]}, "/remove/0", "must not be where the way ends"),
        ({"position": 99}, "/position", "must be a stop of the front"),
        ({"position": 1, "remove": [1]}, "/remove/0", "must not be where the way goes on"),
        ({"add": [{"id": "3"}]}, "/add/0/id", "must differ from the ids of all other stops"),
        ({"add": [{"id": "new"}]}, "/add/0/coordinates", 'is required, with an entry for "first"'),
        ({"position": {"id": "here"}}, "/position/coordinates", "is required"),
        (
            {"add": [{**NEW, "costs": [{"to": [1.0]}, None]}]},
            "/add/0/costs/0",
            'must be null: "first" is given by coordinates',
        ),
        ({"tour": [0, 1]}, "/tour", "must have all 12 stops of the front, got 2"),
        (
            {"costs": [{"objective": 2, "from": 1, "to": 2, "cost": 1}]},
            "/costs/0/objective",
            "must be 0, 1 or",
        ),
        (
            {"costs": [{"objective": "x", "from": 1, "to": 2, "cost": 1}]},
            "/costs/0/objective",
            "0, 1",
        ),
        (
            {"costs": [{"objective": 0, "from": 1, "to": 1, "cost": 1}]},
            "/costs/0/to",
            "must not be",
        ),
        (
            {"costs": [{"objective": 0, "from": 1, "to": 2, "cost": -1}]},
            "/costs/0/cost",
            "at least 0",
        ),
        ({"min_kept": 1.5}, "/min_kept", "at most 1"),
        ({"closed": True}, "/closed", "is not a field"),
        ({"size": 10**6}, "/size", "must be at most"),
        ({"objectives": MEASURED}, None, "location of stop '0' is required by objectives/0/from"),
    ],
)
def test_what_cannot_be_is_refused_at_its_place(
    client: httpx.Client,
    front: dict[str, Any],
    request_: dict[str, Any],
    pointer: str | None,
    detail: str,
) -> None:
    refusal = problem(replan(client, front, **request_))
    assert (refusal["status"], refusal["errors"][0].get("pointer")) == (422, pointer), refusal
    assert detail in refusal["detail"]
    assert client.get(f"/front/{front['id']}").json() == front


@pytest.mark.parametrize("cost", ["NaN", "Infinity", "1e999", '"1"'])
def test_costs_that_are_no_numbers_are_refused(
    client: httpx.Client, front: dict[str, Any], cost: str
) -> None:
    body = '{"costs": [{"objective": 0, "from": 1, "to": 2, "cost": ' + cost + "}]}"
    headers = {"Content-Type": "application/json"}
    answer = client.post(f"/front/{front['id']}/replan", content=body, headers=headers)
    assert answer.status_code in (400, 422)
    assert problem(answer)["code"] in ("malformed-json", "invalid-request")


def test_the_end_of_an_open_route_is_not_passed_while_stops_are_left(client: httpx.Client) -> None:
    front = client.post("/front", json={**SHORT, "closed": False, "start": 0, "end": 5}).json()
    refusal = problem(replan(client, front, done=[0, 1, 5]))
    assert (refusal["code"], refusal["errors"][0]["pointer"]) == ("invalid-request", "/done/2")
    assert problem(replan(client, front, position=5))["errors"][0]["pointer"] == "/position"
    everything = [city for city in range(12) if city != 5]
    rest = replan(client, front, done=[*everything, 5]).json()
    assert [(tour["stops"], tour["lengths"]) for tour in rest["front"]] == [(["5"], [0.0, 0.0])]


def test_a_front_of_a_map_is_replanned_on_the_map_as_it_is_now(client: httpx.Client) -> None:
    front = client.post("/coverage", json=MAP).json()
    driven = front["front"][0]["tour"]
    rest = replan(client, front, done=driven[:2], tour=driven, blocked=[[1, 0]], paths=True).json()
    end, *_, start = (front["places"][place] for place in driven[:2])
    assert rest["closed"] is False
    assert len(rest["places"]) == 4
    for tour in rest["front"]:
        assert (tour["path"]["cells"][0], tour["path"]["cells"][-1]) == (start, end)
        assert [1, 0] not in tour["path"]["cells"]
        assert 0 <= tour["kept"] <= 1
    # Where the obstacle is gone, and the robot elsewhere, and a place is added.
    again = replan(client, rest, pose=[2.5, 1.5], freed=[[1, 0]], add=[[1, 1]]).json()
    assert {tuple(again["places"][tour["tour"][0]]) for tour in again["front"]} == {(1, 2)}
    assert again["cities"] == 5
    tour = client.get("/tour", params={"front": again["id"], "knee": ""}).json()
    assert tour in [{"front": again["id"], **each} for each in again["front"]]
    assert client.get(f"/front/{front['id']}").json() == front


def test_a_place_that_became_an_obstacle_is_named_at_once_or_by_the_job(
    client: httpx.Client,
) -> None:
    front = client.post("/coverage", json=MAP).json()
    place = front["front"][0]["tour"][2]
    request = {"blocked": [front["places"][place]]}
    refusal = problem(replan(client, front, **request))
    assert (refusal["status"], refusal["errors"][0]["pointer"]) == (422, "/remove")
    assert f"must have place {place}, as it must be a free cell" in refusal["detail"]
    later = client.post(
        f"/front/{front['id']}/replan", json=request, headers={"Prefer": "respond-async"}
    )
    assert later.status_code == 202
    while (job := client.get(later.headers["Location"]).json())["status"] in ("queued", "running"):
        time.sleep(0.01)
    assert job["status"] == "failed"
    assert job["problem"]["errors"] == refusal["errors"]


def test_what_is_of_a_map_alone_is_refused_of_stops(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    for request, pointer in (
        ({"blocked": [[0, 0]]}, "/blocked"),
        ({"paths": False}, "/paths"),
        ({"add": [[0, 0]]}, "/add/0"),
        ({"position": [0, 0]}, "/position"),
    ):
        refusal = problem(replan(client, front, **request))
        assert (refusal["status"], refusal["errors"][0]["pointer"]) == (422, pointer)


def test_fronts_that_cannot_be_replanned_say_why(client: httpx.Client, store: SqliteStore) -> None:
    asyncio.run(store.put(record("imported", caller="anonymous")))
    refusal = problem(replan(client, {"id": "imported"}))
    assert refusal["code"] == "not-replannable"
    assert "is not kept" in refusal["detail"]
    asyncio.run(store.put(job("running", caller="anonymous")))
    assert "still being planned" in problem(replan(client, {"id": "running"}))["detail"]
    assert problem(replan(client, {"id": "nothing"}))["code"] == "unknown-front"


def test_a_front_that_was_dropped_has_expired(client: httpx.Client, store: SqliteStore) -> None:
    front = client.post("/front", json=SHORT).json()
    address = asyncio.run(store.get("anonymous", front["id"])).client
    for _ in range(20):
        later = record(uuid.uuid4().hex, caller="anonymous", client=address)
        asyncio.run(store.put(later))
    answer = replan(client, front)
    assert (answer.status_code, problem(answer)["code"]) == (410, "front-expired")


def test_only_tours_that_keep_enough_are_returned(
    client: httpx.Client, front: dict[str, Any]
) -> None:
    front = client.post("/front", json=SHORT).json()
    rest = replan(client, front, done=[3], min_kept=0.7).json()
    assert min(tour["kept"] for tour in rest["front"]) >= 0.7
    # Wherever a stop is added, a leg is lost.
    refusal = problem(replan(client, front, add=[NEW], min_kept=1.0))
    assert (refusal["status"], refusal["code"]) == (422, "too-different")


def test_fronts_of_every_form_are_replanned(client: httpx.Client) -> None:
    for seed in range(4):
        change = random_change(seed, least=5)
        request = json.loads(change.front.source.body)
        front = client.post("/front", json={**request, "time_limit": 0.1}).json()
        rest = replan(client, front, **{**change.request, "tour": []})
        assert rest.status_code == 200, rest.text
        stops = {stop["id"] for stop in rest.json()["stops"]}
        ends = [stop for stop in (change.start, change.end) if stop is not None]
        assert stops == {change.ids[stop] for stop in (*change.between, *ends)}


PLACES = np.random.default_rng(3).uniform((24.9, 60.15), (25.0, 60.2), (8, 2)).tolist()
RISKS = np.random.default_rng(4).random((8, 8)).tolist()


def test_the_rest_of_a_way_is_still_timed_at_the_speed_of_its_front(client: httpx.Client) -> None:
    stops = [{"id": f"s{i}", "location": place} for i, place in enumerate(PLACES[:7])]
    objectives = [
        {"name": "time", "from": "great_circle", "speed": 18},
        {"name": "risk", "matrix": [row[:7] for row in RISKS[:7]]},
    ]
    body = {"stops": stops, "objectives": objectives, "time_limit": 0.1}
    front = client.post("/front", json=body).json()
    assert front["objectives"][0] == {"name": "time", "unit": "s"}
    new = {"id": "s7", "location": PLACES[7]}
    new["costs"] = [None, {"to": RISKS[7], "from": [row[7] for row in RISKS]}]
    changed = {"objective": "time", "from": "s2", "to": "s3", "cost": 5000.0}
    tour = front["front"][0]["stops"]
    answer = replan(client, front, done=tour[:2], add=[new], costs=[changed])
    assert answer.status_code == 200, answer.text
    rest = answer.json()
    assert rest["objectives"][0] == {"name": "time", "unit": "s"}
    seconds = np.array(matrix_of(PLACES, 18))
    seconds[2, 3] = 5000
    for item in rest["front"]:
        way = [int(stop[1:]) for stop in item["stops"]]
        assert way[0] == int(tour[1][1:])
        assert item["lengths"][0] == pytest.approx(seconds[way[:-1], way[1:]].sum())


def test_objectives_of_a_replan_may_have_a_speed(client: httpx.Client) -> None:
    stops = [{"id": f"s{i}", "location": place} for i, place in enumerate(PLACES)]
    way, risk = {"name": "way", "from": "great_circle"}, {"name": "risk", "matrix": RISKS}
    body = {"stops": stops, "objectives": [way, risk], "time_limit": 0.1}
    front = client.post("/front", json=body).json()
    timed = [{"name": "time", "from": "great_circle", "speed": 36}, risk]
    rest = replan(client, front, objectives=timed).json()
    assert rest["objectives"][0] == {"name": "time", "unit": "s"}
    seconds = np.array(matrix_of(PLACES, 36))
    for item in rest["front"]:
        way_round = [int(stop[1:]) for stop in item["stops"]]
        expected = seconds[way_round, np.roll(way_round, -1)].sum()
        assert item["lengths"][0] == pytest.approx(expected)
    by_road = [{**timed[0], "from": "road_time"}, risk]
    refused = problem(replan(client, front, objectives=by_road))
    assert refused["errors"][0]["pointer"] == "/objectives/0/speed"
