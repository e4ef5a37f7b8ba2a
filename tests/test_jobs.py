"""Fronts that are asked for now and found later, over HTTP."""

import json
import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from httpx_sse import connect_sse

from service.access import Access, KeyHash, new_key
from service.edge import Edge
from service.instance import Instance, tour_lengths
from service.sqlite import SqliteStore
from tests.serving import (
    LIMITS,
    Broken,
    Shuffler,
    app_of,
    planner_of,
    problem,
    serving,
    workers_of,
)

# So many that no search of theirs has converged within seconds.
CITIES = np.random.default_rng(5).random((300, 4)).tolist()
LONG = {"coordinates": CITIES, "time_limit": 600}
SHORT = {"coordinates": CITIES[:12], "time_limit": 0.05}
LATER = {"Prefer": "handling=strict, respond-async; wait=10"}
PATIENT = replace(LIMITS, seconds=600.0, cities=300)


@contextmanager
def client_of(*actors: Any, **options: Any) -> Iterator[httpx.Client]:
    workers = workers_of(planner_of(*actors, limits=PATIENT), seconds=600)
    app = app_of(*actors, limits=PATIENT, **{"workers": workers, **options})
    with serving(app) as url, httpx.Client(base_url=url, timeout=60) as client:
        yield client


@pytest.fixture(scope="module")
def client() -> Iterator[httpx.Client]:
    with client_of() as client:
        yield client


def later(client: httpx.Client, request: dict[str, Any] = SHORT, **headers: str) -> str:
    """The path of a front that will be found."""
    answer = client.post("/front", json=request, headers={**LATER, **headers})
    assert (answer.status_code, answer.headers["preference-applied"]) == (202, "respond-async")
    path = answer.headers["location"]
    assert path == f"/front/{answer.json()['id']}"
    assert answer.json()["status"] in ("queued", "running", "done")
    return path


def ended(client: httpx.Client, path: str) -> dict[str, Any]:
    while (found := client.get(path).json())["status"] in ("queued", "running"):
        time.sleep(0.02)
    return found


def until_found(client: httpx.Client, path: str) -> dict[str, Any]:
    """A front that is being planned, of which something has been found."""
    while not (found := client.get(path).json())["front"]:
        time.sleep(0.02)
    assert found["status"] == "running"
    return found


def check(found: dict[str, Any]) -> None:
    tours = np.array([item["tour"] for item in found["front"]])
    lengths = tour_lengths(Instance(coordinates=np.array(CITIES)[: found["cities"]]), tours)
    np.testing.assert_allclose([item["lengths"] for item in found["front"]], lengths)


def events(client: httpx.Client, path: str) -> list[tuple[str, dict[str, Any]]]:
    with connect_sse(client, "GET", f"{path}/events") as source:
        return [(event.event, event.json()) for event in source.iter_sse()]


def test_a_front_asked_for_later_is_the_one_that_would_have_been_answered(
    client: httpx.Client,
) -> None:
    at_once = client.post("/front", json=SHORT).json()
    found = ended(client, later(client))
    assert (found["status"], found["terminated"]) == ("done", at_once["terminated"])
    assert found["hypervolume"] >= at_once["hypervolume"] * 0.99
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


def test_before_anything_is_found_the_front_is_empty(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    with client_of(actor) as client:
        running, waiting = later(client), later(client)
        while not actor.started:
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
        (tmp_path / "gate").touch()
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
    path = later(client, {**LONG, "time_limit": 1.5})
    told = events(client, path)
    statuses = [data for name, data in told if name == "status"]
    id_ = path.rpartition("/")[2]
    assert statuses[-2:] == [{"id": id_, "status": each} for each in ("running", "done")]
    assert told[-1] == ("status", statuses[-1])
    progress = [data for name, data in told if name == "progress"]
    assert len(progress) > 1
    for before, after in pairwise(progress):
        assert before["seconds"] < after["seconds"]
        assert before["hypervolume"] <= after["hypervolume"]
    assert progress[0]["points"] > 0
    assert events(client, path) == [("status", statuses[-1])]


def test_events_end_when_the_job_is_cancelled(client: httpx.Client) -> None:
    path = later(client, LONG)
    with ThreadPoolExecutor() as listener:
        told = listener.submit(events, client, path)
        until_found(client, path)
        client.delete(path)
        assert told.result()[-1][1]["status"] == "cancelled"


def test_a_repeat_with_the_same_key_is_the_same_front(client: httpx.Client) -> None:
    key = {"Idempotency-Key": "same"}
    first = client.post("/front", json=SHORT, headers=key).json()
    assert first["status"] == "done"
    assert client.post("/front", json=SHORT, headers=key).json() == first
    assert later(client, SHORT, **key) == f"/front/{first['id']}"
    other = client.post("/front", json=LONG, headers=key)
    problem(other, 422, "idempotency-mismatch")
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


@pytest.mark.parametrize("length", [0, 256])
def test_a_key_that_is_none_is_refused(client: httpx.Client, length: int) -> None:
    headers = {"Idempotency-Key": "k" * length}
    problem(client.post("/front", json=SHORT, headers=headers), 422, "invalid-request")


def test_a_job_that_fails_says_why() -> None:
    with client_of(Broken()) as client:
        path = later(client)
        found = ended(client, path)
        assert (found["status"], found["front"]) == ("failed", [])
        assert (found["problem"]["status"], found["problem"]["code"]) == (500, "internal-error")
        assert "no tour" not in json.dumps(found)
        key = {"Idempotency-Key": "k"}
        for _ in range(2):
            problem(client.post("/front", json=SHORT, headers=key), 500, "internal-error")


def test_a_job_whose_worker_is_killed_ends_with_a_front() -> None:
    workers = workers_of(planner_of(limits=PATIENT), seconds=600)
    with client_of(workers=workers) as client:
        path = later(client, {**LONG, "time_limit": 1})
        until_found(client, path)
        [worker] = workers.pids
        assert worker is not None
        os.kill(worker, signal.SIGKILL)
        found = ended(client, path)
        assert (found["status"], found["terminated"]) == ("done", "time_limit")
        check(found)
        assert workers.pids != [worker]


def test_a_job_that_loses_two_workers_fails_with_the_best_front_so_far() -> None:
    workers = workers_of(planner_of(limits=PATIENT), seconds=600)
    with client_of(workers=workers) as client:
        path = later(client, LONG)
        until_found(client, path)
        killed: set[int | None] = set()
        while len(killed) < 2:
            if workers.working and not killed.issuperset(workers.pids):
                [worker] = workers.pids
                assert worker is not None
                os.kill(worker, signal.SIGKILL)
                killed.add(worker)
            time.sleep(0.02)
        found = ended(client, path)
        assert (found["status"], found["problem"]["code"]) == ("failed", "worker-lost")
        check(found)


def test_jobs_are_in_the_queue_like_everybody_else(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")
    workers = workers_of(planner_of(actor, limits=PATIENT), queue=0)
    with client_of(actor, workers=workers) as client:
        path = later(client, SHORT, **{"Idempotency-Key": "first"})
        refused = client.post("/front", json=SHORT, headers=LATER)
        problem(refused, 503, "queue-full")
        other = {**LATER, "Idempotency-Key": "other"}
        problem(client.post("/front", json=SHORT, headers=other), 503, "queue-full")
        # A repeat needs no place.
        assert later(client, SHORT, **{"Idempotency-Key": "first"}) == path
        (tmp_path / "gate").touch()
        assert ended(client, path)["status"] == "done"
        assert client.post("/front", json=SHORT, headers=other).status_code == 202


def test_what_was_unfinished_when_the_service_ended_is_done_by_the_next(tmp_path: Path) -> None:
    actor = Shuffler(tmp_path / "gate")

    def store() -> SqliteStore:
        return SqliteStore(str(tmp_path / "fronts.sqlite"), entries=10, max_age=60)

    with client_of(actor, store=store()) as client:
        paths = [later(client) for _ in range(2)]
        while not actor.started:
            time.sleep(0.01)
    (tmp_path / "gate").touch()
    with client_of(store=store()) as client:
        for path in paths:
            found = ended(client, path)
            assert found["status"] == "done"
            check(found)


def test_a_caller_sees_its_own_jobs_alone() -> None:
    (our_key, ours), (their_key, theirs) = new_key(), new_key()
    hashes = [KeyHash(caller="us", digest=ours), KeyHash(caller="them", digest=theirs)]
    with client_of(edge=Edge(access=Access(hashes))) as client:
        us, them = ({"Authorization": f"Bearer {key}"} for key in (our_key, their_key))
        path = later(client, SHORT, **us)
        for answer in (
            client.get(path, headers=them),
            client.delete(path, headers=them),
            client.get(f"{path}/events", headers=them),
        ):
            problem(answer, 404, "unknown-front")
        problem(client.get("/tour?angle=3", headers=them), 404, "no-front")
        with_key = {"Idempotency-Key": "k"}
        ids = {later(client, SHORT, **who, **with_key) for who in (us, them)}
        assert len(ids) == 2
        assert client.get(path, headers=us).status_code == 200
