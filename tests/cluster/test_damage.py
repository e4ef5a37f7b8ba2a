"""A cluster without a worker says so, and keys of Redis that hold something else are made anew."""

import logging
import time
from collections.abc import Iterator
from itertools import cycle, product
from pathlib import Path
from typing import Any

import httpx
import pytest
import redis as redis_client

from service.cluster.celery_app import QUEUE
from service.cluster.redis_engine import connect
from tests.helpers.actors import Shuffler
from tests.helpers.celery_workers import celery_worker
from tests.helpers.jobs import LATER, ended
from tests.helpers.redis_server import Redis, redis_server
from tests.helpers.sampled import IS_WHOLE
from tests.helpers.serving import engine_app, problem, runner_of, serving

CITIES = {"coordinates": [[0, 0, 5, 5], [3, 0, 9, 1], [5, 2, 2, 8], [4, 5, 7, 7]]}
KEYS = [
    *("number", "lost", "turns", "turn", "workers", "unfinished", "finished", "gone", "entries"),
    *("bytes", "total", "counted", "written", "front:{id}", "work:{id}", "caller:{caller}"),
    *("client:{client}", "gone:{caller}", "key:{caller}:again"),
]

KINDS = ["text", "list", "hash"]
DAMAGES = [*(product(KEYS, KINDS) if IS_WHOLE else zip(KEYS, cycle(KINDS), strict=False))]
UNAVAILABLE = ("store-unavailable", "no-worker")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Redis]:
    with redis_server(tmp_path_factory.mktemp("redis")) as server:
        yield server


@pytest.fixture(scope="module")
def client(server: Redis) -> Iterator[httpx.Client]:
    store, engine = connect(server.url, entries=100, max_age=60, queue=8, seconds=30)
    with (
        celery_worker(server.url, runner_of(Shuffler()), 30, 1),
        serving(engine_app(store, engine, Shuffler())) as url,
        httpx.Client(base_url=url, timeout=300) as client,
    ):
        yield client


def test_without_a_worker_the_service_is_not_ready_and_nobody_waits(tmp_path: Path) -> None:
    with redis_server(tmp_path) as redis:
        store, engine = connect(redis.url, entries=9, max_age=60, queue=8, seconds=60)
        with (
            serving(engine_app(store, engine, Shuffler()), warm=False) as url,
            httpx.Client(base_url=url) as client,
        ):
            problem(client.get("/health/ready"), 503, "no-worker")
            answer = client.post("/front", json=CITIES)
            problem(answer, 503, "no-worker")
            assert int(answer.headers["Retry-After"]) > 0
            later = client.post("/front", json=CITIES, headers={"Prefer": "respond-async"})
            assert later.status_code == 202
            with celery_worker(redis.url, runner_of(Shuffler()), 30, 1):
                assert ended(client, later.headers["Location"])["status"] == "done"
                assert client.get("/health/ready").status_code == 200


@pytest.mark.parametrize(("key", "kind"), DAMAGES)
def test_a_key_that_holds_something_else_is_named_in_the_log_and_made_anew(
    server: Redis, client: httpx.Client, key: str, kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    connection = redis_client.Redis.from_url(server.url)
    again = {"Idempotency-Key": "again"}
    first = planned(client, headers=again)["id"]
    fields = connection.hgetall(f"paretour:front:{first}")
    name = "paretour:" + key.format(
        id=first, caller=fields[b"caller"].decode(), client=fields[b"client"].decode()
    )
    connection.delete(name)
    if kind == "text":
        connection.set(name, "not ours")
    elif kind == "list":
        connection.rpush(name, "not ours")
    else:
        connection.hset(name, "not", "ours")
    with caplog.at_level(logging.ERROR, "paretour"):
        for _ in range(4):
            for answer in (
                client.get("/health/ready"),
                client.post("/front", json=CITIES),
                client.post("/front", json=CITIES, headers=again),
                client.get(f"/front/{first}"),
                client.get("/tour", params={"knee": ""}),
                client.get("/metrics"),
            ):
                # Workers are counted again once they have shown themselves.
                assert answer.status_code < 500 or answer.json()["code"] in UNAVAILABLE
    until_mended(client)
    damaged = [record.getMessage() for record in caplog.records if "is damaged" in record.msg]
    assert all("paretour:" in message for message in damaged)
    connection.close()


def planned(client: httpx.Client, **options: Any) -> Any:
    """Return a front, once the service answers: keys that are rarely read are mended by the way."""
    ends = time.monotonic() + 30
    while time.monotonic() < ends:
        answer = client.post("/front", json=CITIES, **options)
        if answer.status_code == 200:
            return answer.json()
        assert answer.json()["code"] in UNAVAILABLE
        time.sleep(0.2)
    raise TimeoutError


def until_mended(client: httpx.Client) -> None:
    """Wait until a front is planned, kept and found again."""
    ends = time.monotonic() + 30
    while time.monotonic() < ends:
        found = client.get(f"/front/{planned(client)['id']}")
        job = client.post("/front", json=CITIES, headers=LATER)
        kept = found.status_code == 200 and job.status_code == 202
        # While other keys are mended, the service may not be able to say how a job ended.
        if kept and ended(client, job.headers["Location"])["status"] == "done":
            return
        time.sleep(0.2)
    raise TimeoutError


def test_messages_that_are_something_else_are_made_anew(
    server: Redis, client: httpx.Client
) -> None:
    connection = redis_client.Redis.from_url(server.url)
    connection.delete(QUEUE)
    connection.set(QUEUE, "not ours")
    answer = client.post("/front", json=CITIES)
    assert answer.status_code in (200, 503)
    until_mended(client)
    connection.close()
