"""Jobs of either engine over HTTP: submitted, watched, cancelled, repeated, resumed."""

import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from service.api.app import Edge
from service.api.auth import Access
from service.api.keys import KeyHash, new_key
from tests.helpers.actors import Broken, Shuffler
from tests.helpers.engines import Clustered, Embedded, engine_of
from tests.helpers.fleet_requests import fleet_request
from tests.helpers.jobs import (
    CITIES,
    LATER,
    LONG,
    SHORT,
    check,
    ended,
    events,
    first_found,
    id_of,
    later,
    until_found,
)
from tests.helpers.serving import events_of, problem

Engine = Embedded | Clustered


@pytest.fixture(scope="module", params=["embedded", "cluster"])
def engine(request: pytest.FixtureRequest) -> Iterator[Engine]:
    with engine_of(request.param, request) as engine:
        yield engine


@pytest.fixture(scope="module")
def client(engine: Engine) -> Iterator[httpx.Client]:
    with engine.serve() as served:
        yield served.client


@pytest.fixture(scope="module")
def gate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("gated") / "gate"


@pytest.fixture
def gated(gate: Path) -> Shuffler:
    """An actor that waits until the test opens the gate."""
    actor = Shuffler(gate)
    actor.close()
    return actor


def test_a_fleet_is_planned_by_either_engine(client: httpx.Client) -> None:
    answer = client.post("/fleet", json=fleet_request())
    assert answer.status_code == 200, answer.text
    assert answer.json()["front"][0]["routes"]


def test_a_front_asked_for_later_is_the_one_that_would_have_been_answered(
    client: httpx.Client,
) -> None:
    # All tours of so few cities are tried, in far less than the time limit.
    request = {**SHORT, "coordinates": SHORT["coordinates"][:8], "time_limit": 30}
    at_once = client.post("/front", json=request).json()
    found = ended(client, later(client, request))
    assert found["status"] == "done"
    assert at_once["terminated"] == found["terminated"] == "converged"
    assert found["front"] == at_once["front"]
    check(found)
    tour = client.get("/tour", params={"angle": 30}).json()
    assert tour["front"] == found["id"]


def test_coverage_may_be_asked_for_later_as_well(client: httpx.Client) -> None:
    request = {
        "grid": [[0] * 12] * 12,
        "cell_size": 0.5,
        "places": [[row, 5 * row % 12] for row in range(12)],
        "second_coordinates": [row[:2] for row in CITIES[:12]],
        "paths": True,
        "time_limit": 0.05,
    }
    answer = client.post("/coverage", json=request, headers=LATER)
    assert answer.status_code == 202
    found = ended(client, answer.headers["location"])
    assert (found["status"], found["places"]) == ("done", request["places"])
    assert all(item["path"]["metres"] > 0 for item in found["front"])


def test_a_wrong_request_is_refused_at_once(client: httpx.Client) -> None:
    answer = client.post("/front", json={**SHORT, "size": 0}, headers=LATER)
    problem(answer, 422, "invalid-request")


def test_before_anything_is_found_the_front_is_empty(engine: Engine, gated: Shuffler) -> None:
    with engine.serve(gated) as served:
        client = served.client
        running, waiting = later(client), later(client)
        while not gated.started:
            time.sleep(0.01)
        for path, status in ((running, "running"), (waiting, "queued")):
            found = client.get(path).json()
            assert (found["status"], found["front"], found["terminated"]) == (status, [], None)
            assert (found["hypervolume"], found["points"], found["cities"]) == (0, 0, 12)
            np.testing.assert_allclose(found["reference_point"], 12 * np.array(found["scale"]))
            problem(client.get(f"/tour?angle=3&front={found['id']}"), 404, "no-tour")
        problem(client.get("/tour?angle=3"), 404, "no-front")
        cancelled = client.delete(waiting).json()
        assert (cancelled["status"], cancelled["front"]) == ("cancelled", [])
        gated.open()
        assert ended(client, running)["status"] == "done"


def test_while_it_is_planned_the_best_front_so_far_is_given(client: httpx.Client) -> None:
    path = later(client, LONG)
    found = until_found(client, path)
    check(found)
    assert found["terminated"] is None
    tour = client.get("/tour", params={"angle": 30, "front": found["id"]})
    assert tour.json()["tour"]
    cancelled = client.delete(path)
    assert (cancelled.status_code, cancelled.json()["status"]) == (200, "cancelled")
    assert cancelled.json()["terminated"] == "cancelled"
    assert cancelled.json()["points"] >= found["points"] / 2
    check(cancelled.json())
    assert client.get(path).json() == cancelled.json()


def test_a_front_that_is_forgotten_is_404(client: httpx.Client) -> None:
    path = later(client)
    ended(client, path)
    forgotten = client.delete(path)
    assert (forgotten.status_code, forgotten.content) == (204, b"")
    for answer in (client.get(path), client.delete(path), client.get(f"{path}/events")):
        problem(answer, 404, "unknown-front")


def test_events_tell_how_it_goes_until_it_has_ended(client: httpx.Client) -> None:
    path = later(client, LONG)
    id_ = id_of(path)
    told: list[tuple[str, Any]] = []
    for name, data in events_of(client, id_):
        told.append((name, data))
        if name == "progress" and [each for each, _ in told].count(name) == 2:
            client.delete(path)
    statuses = [data for name, data in told if name == "status"]
    assert statuses[-2:] == [{"id": id_, "status": each} for each in ("running", "cancelled")]
    assert told[-1] == ("status", statuses[-1])
    progress = [data for name, data in told if name == "progress"]
    for before, after in pairwise(progress):
        assert before["seconds"] < after["seconds"]
        assert before["hypervolume"] <= after["hypervolume"]
    assert progress[0]["points"] > 0
    assert events(client, path) == [("status", statuses[-1])]


def test_events_end_when_the_job_is_done(client: httpx.Client) -> None:
    path = later(client)
    assert events(client, path)[-1] == ("status", {"id": id_of(path), "status": "done"})


def test_a_repeat_with_the_same_key_is_the_same_front(client: httpx.Client) -> None:
    key = {"Idempotency-Key": "same"}
    answer = client.post("/front", json=SHORT, headers=key)
    first = answer.json()
    assert first["status"] == "done"
    repeat = client.post("/front", json=SHORT, headers=key)
    assert repeat.json() == first
    accepted = client.post("/front", json=SHORT, headers={**key, **LATER})
    assert accepted.headers["location"] == f"/front/{first['id']}"
    other = client.post("/front", json=LONG, headers=key)
    problem(other, 422, "idempotency-mismatch")
    answers = (answer, repeat, accepted, other)
    replayed = [each.headers.get("idempotent-replayed") for each in answers]
    assert replayed == [None, "true", "true", None]
    assert later(client, SHORT) != f"/front/{first['id']}"


def test_repeats_at_the_same_time_are_the_same_job(client: httpx.Client) -> None:
    headers = {**LATER, "Idempotency-Key": "at the same time"}
    with ThreadPoolExecutor(8) as clients:
        posts = [
            clients.submit(client.post, "/front", json=SHORT, headers=headers) for _ in range(8)
        ]
    assert len({post.result().json()["id"] for post in posts}) == 1


def test_work_with_a_key_goes_on_when_its_client_goes_away(client: httpx.Client) -> None:
    request = {**LONG, "time_limit": 1}
    key = {"Idempotency-Key": "gone"}
    with pytest.raises(httpx.ReadTimeout):
        client.post("/front", json=request, headers=key, timeout=0.3)
    again = client.post("/front", json=request, headers=key).json()
    assert (again["status"], again["terminated"]) == ("done", "time_limit")


@pytest.mark.parametrize("key", ["", "k" * 256, "k\tk", "clé"])
def test_a_key_that_is_none_is_refused(client: httpx.Client, key: str) -> None:
    headers = {"Idempotency-Key": key.encode("latin-1")}
    problem(client.post("/front", json=SHORT, headers=headers), 422, "invalid-request")


def test_a_job_that_fails_says_why(engine: Engine) -> None:
    with engine.serve(Broken()) as served:
        client = served.client
        path = later(client)
        found = ended(client, path)
        assert (found["status"], found["front"]) == ("failed", [])
        assert (found["problem"]["status"], found["problem"]["code"]) == (500, "internal-error")
        assert "no tour" not in json.dumps(found)
        key = {"Idempotency-Key": "k"}
        for _ in range(2):  # what failed is tried again, and not replayed
            answer = client.post("/front", json=SHORT, headers=key)
            problem(answer, 500, "internal-error")
            assert "idempotent-replayed" not in answer.headers


def test_a_job_whose_worker_is_killed_ends_with_a_front(engine: Engine) -> None:
    with engine.serve() as served:
        # Long enough to be killed while it runs, on a busy machine too.
        path = later(served.client, {**LONG, "time_limit": 6})
        until_found(served.client, path)
        served.kill(id_of(path))
        found = ended(served.client, path)
        assert (found["status"], found["terminated"]) == ("done", "time_limit")
        check(found)


def test_a_job_that_loses_two_workers_fails_with_the_best_front_so_far(engine: Engine) -> None:
    with engine.serve() as served:
        path = later(served.client, LONG)
        until_found(served.client, path)
        first = served.kill(id_of(path))
        served.kill(id_of(path), but=first)
        found = ended(served.client, path)
        assert (found["status"], found["problem"]["code"]) == ("failed", "worker-lost")
        check(found)


def test_jobs_are_in_the_queue_like_everybody_else(engine: Engine, gated: Shuffler) -> None:
    with engine.serve(gated, queue=0) as served:
        client = served.client
        path = later(client, SHORT, **{"Idempotency-Key": "first"})
        refused = client.post("/front", json=SHORT, headers=LATER)
        problem(refused, 503, "queue-full")
        other = {**LATER, "Idempotency-Key": "other"}
        problem(client.post("/front", json=SHORT, headers=other), 503, "queue-full")
        # A repeat needs no place.
        assert later(client, SHORT, **{"Idempotency-Key": "first"}) == path
        gated.open()
        assert ended(client, path)["status"] == "done"
        assert ended(client, later(client, SHORT, **other))["status"] == "done"


@pytest.mark.parametrize("headers", [{}, LATER])
def test_repeats_on_a_full_queue_are_all_refused(
    engine: Engine, gated: Shuffler, headers: dict[str, str]
) -> None:
    with engine.serve(gated, queue=0) as served, ThreadPoolExecutor(20) as clients:
        client = served.client
        path = later(client)
        headers = {**headers, "Idempotency-Key": f"full {len(headers)}"}
        posts = [
            clients.submit(client.post, "/front", json=SHORT, headers=headers) for _ in range(40)
        ]
        for post in posts:
            problem(post.result(), 503, "queue-full")
        gated.open()
        ended(client, path)
        answer = client.post("/front", json=SHORT, headers=headers)
        assert answer.status_code in (200, 202)
        ended(client, f"/front/{answer.json()['id']}")


@pytest.mark.parametrize("headers", [{}, LATER])
def test_repeats_while_the_queue_fills_are_one_job_or_refused(
    engine: Engine, gated: Shuffler, headers: dict[str, str]
) -> None:
    with engine.serve(gated, queue=0) as served, ThreadPoolExecutor(40) as clients:
        client = served.client
        headers = {**headers, "Idempotency-Key": f"one place {len(headers)}"}
        posts = [
            clients.submit(client.post, "/front", json=SHORT, headers=headers) for _ in range(40)
        ]
        time.sleep(1)
        gated.open()
        answers = [post.result() for post in posts]
        taken = [answer.json() for answer in answers if answer.status_code != 503]
        assert len({answer["id"] for answer in taken}) == 1
        found = ended(client, f"/front/{taken[0]['id']}")
        assert found["status"] == "done"
        for answer in answers:
            if answer.status_code == 503:
                # On a busy machine Redis may take longer to answer than it may.
                assert answer.json()["code"] in ("queue-full", "store-unavailable")
            elif answer.status_code == 200:
                assert answer.json() == found


def test_a_caller_holds_no_more_than_its_share(engine: Engine, gated: Shuffler) -> None:
    (our_key, ours), (their_key, theirs) = new_key(), new_key()
    hashes = [KeyHash(caller="us", digest=ours), KeyHash(caller="them", digest=theirs)]
    edge = Edge(access=Access(hashes))
    with engine.serve(gated, queue=5, edge=edge, share=0.5) as served:
        client = served.client
        us, them = ({"Authorization": f"Bearer {key}"} for key in (our_key, their_key))
        paths = [later(client, SHORT, **us) for _ in range(3)]
        for more in ({}, LATER, {"Idempotency-Key": "k"}):
            refused = client.post("/front", json=SHORT, headers={**us, **more})
            assert problem(refused, 503, "share-full")["limit"] == 3
            assert int(refused.headers["retry-after"]) > 0
        foreign = later(client, SHORT, **them)
        gated.open()
        for path, caller in [*((path, us) for path in paths), (foreign, them)]:
            _await_end(client, path, caller)
        _await_end(client, later(client, SHORT, **us), us)


def _await_end(client: httpx.Client, path: str, caller: dict[str, str]) -> None:
    while client.get(path, headers=caller).json()["status"] != "done":
        time.sleep(0.02)


def test_what_was_unfinished_when_the_service_ended_is_done_for_the_next(
    engine: Engine, gated: Shuffler, tmp_path: Path
) -> None:
    with engine.serve(gated, folder=tmp_path) as served:
        paths = [later(served.client) for _ in range(2)]
        while not gated.started:
            time.sleep(0.01)
    gated.open()
    with engine.serve(gated, folder=tmp_path) as served:
        for path in paths:
            found = ended(served.client, path)
            assert found["status"] == "done"
            check(found)


def test_without_keys_the_latest_front_is_that_of_an_address_behind_a_proxy(
    engine: Engine,
) -> None:
    with engine.serve() as served:
        us, them = ({"X-Forwarded-For": f"203.0.113.{last}"} for last in (1, 2))
        problem(served.client.get("/tour?knee", headers=us), 404, "no-front")
        fronts = [
            served.client.post("/front", json=SHORT, headers=who).json()["id"] for who in (us, them)
        ]
        for who, front in zip((us, them), fronts, strict=True):
            assert served.client.get("/tour?knee", headers=who).json()["front"] == front
        problem(served.client.get("/tour?knee"), 404, "no-front")
        by_id = served.client.get(f"/tour?knee&front={fronts[0]}", headers=them)
        assert by_id.json()["front"] == fronts[0]


def test_fronts_are_listed_page_by_page_to_their_address_alone(engine: Engine) -> None:
    us, them = ({"X-Forwarded-For": f"203.0.113.{last}"} for last in (1, 2))
    with engine.serve() as served:
        client = served.client
        made = [client.post("/front", json=SHORT, headers=us).json()["id"] for _ in range(3)]
        first = client.get("/front?limit=2", headers=us)
        second = client.get(first.links["next"]["url"], headers=us)
        listed = first.json()["fronts"] + second.json()["fronts"]
        assert [each["id"] for each in listed] == made[::-1]
        assert "link" not in second.headers
        front = client.get(f"/front/{made[-1]}").json()
        assert listed[0].items() >= {k: front[k] for k in ("kind", "cities", "points")}.items()
        assert (listed[0]["status"], listed[0]["hypervolume"]) == ("done", front["hypervolume"])
        assert client.get("/front", headers=them).json() == {"fronts": []}
        path = later(client, LONG, **them)
        until_found(client, path)
        [running] = client.get("/front", headers=them).json()["fronts"]
        assert (running["id"], running["status"]) == (id_of(path), "running")
        client.delete(path)


@pytest.mark.parametrize("query", ["limit=0", "limit=101", "limit=x", "after=0", "after=x"])
def test_a_page_that_cannot_be_is_refused(client: httpx.Client, query: str) -> None:
    document = problem(client.get(f"/front?{query}"), 422, "invalid-request")
    assert document["errors"][0]["parameter"] == query.partition("=")[0]


def test_a_caller_sees_its_own_jobs_alone(engine: Engine) -> None:
    (our_key, ours), (their_key, theirs) = new_key(), new_key()
    hashes = [KeyHash(caller="us", digest=ours), KeyHash(caller="them", digest=theirs)]
    with engine.serve(edge=Edge(access=Access(hashes))) as served:
        client = served.client
        us, them = ({"Authorization": f"Bearer {key}"} for key in (our_key, their_key))
        path = later(client, SHORT, **us)
        for answer in (
            client.get(path, headers=them),
            client.delete(path, headers=them),
            client.get(f"{path}/events", headers=them),
        ):
            problem(answer, 404, "unknown-front")
        assert client.get("/front", headers=them).json() == {"fronts": []}
        problem(client.get("/tour?angle=3", headers=them), 404, "no-front")
        with_key = {"Idempotency-Key": "k"}
        ids = {later(client, SHORT, **who, **with_key) for who in (us, them)}
        assert len(ids) == 2
        assert client.get(path, headers=us).status_code == 200


def test_a_keyed_request_is_answered_in_time_and_its_job_goes_on(engine: Engine) -> None:
    key = {"Idempotency-Key": "in time"}
    with engine.serve(edge=Edge(request_seconds=1.0)) as served:
        client = served.client
        for _ in range(2):
            answer = first_found(client, LONG, **key)
            assert (answer.status_code, answer.json()["status"]) == (200, "running")
            assert answer.json()["terminated"] is None
            check(answer.json())
        path = f"/front/{answer.json()['id']}"
        assert client.delete(path).json()["status"] == "cancelled"
        assert client.post("/front", json=LONG, headers=key).json()["status"] == "cancelled"


def test_a_keyed_request_that_found_nothing_in_time_is_504_and_its_job_goes_on(
    engine: Engine, gated: Shuffler
) -> None:
    key = {"Idempotency-Key": "nothing in time"}
    with engine.serve(gated, edge=Edge(request_seconds=0.5)) as served:
        client = served.client
        problem(client.post("/front", json=SHORT, headers=key), 504, "overdue")
        gated.open()
        path = later(client, SHORT, **key)
        assert ended(client, path)["status"] == "done"
        assert client.post("/front", json=SHORT, headers=key).json()["status"] == "done"
