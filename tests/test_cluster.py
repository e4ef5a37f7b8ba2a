"""Many machines and what may befall them: real processes, a real Redis, and kill -9."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import httpx
import pytest
import redis
from redis.asyncio import Redis as AsyncRedis

from service.cluster.engine import Cluster
from service.cluster.replica import replica
from service.cluster.store import RedisStore
from tests.engines import PATIENT, Clustered, crew, engine_of, planning
from tests.redis_server import Redis, redis_server
from tests.serving import (
    Running,
    Shuffler,
    engine_app,
    planner_of,
    problem,
    running,
    serving,
    working,
)
from tests.test_jobs import CITIES, LONG, check, ended, events, id_of, later, until_found

pytest.importorskip("celery", reason="celery is not installed")
SOME_SECONDS = {"coordinates": CITIES, "time_limit": 2}


@dataclass
class Machines:
    """A Redis that lasts, and commands that work with it, each as if on a machine of its own."""

    redis: Redis
    stack: ExitStack
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.connection = redis.Redis.from_url(self.redis.url)
        self._settings = {
            "PARETOUR_REDIS_URL": self.redis.url,
            "PARETOUR_WORKERS": "1",
            "PARETOUR_DRAIN_SECONDS": "1",
        }

    def start_worker(self) -> None:
        self.connection.delete("paretour:workers")
        self.workers.append(self.stack.enter_context(working(self._settings)))
        while not self.connection.zcard("paretour:workers"):
            time.sleep(0.05)

    @contextmanager
    def replica(self) -> Iterator[tuple[Running, httpx.Client]]:
        with running(self._settings) as service, httpx.Client(base_url=service.url) as client:
            client.timeout = 60
            yield service, client


@pytest.fixture(scope="module")
def machines(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Machines]:
    with (
        redis_server(tmp_path_factory.mktemp("redis"), lasting=True) as redis,
        ExitStack() as stack,
    ):
        machines = Machines(redis, stack)
        machines.start_worker()
        yield machines


@pytest.fixture(scope="module")
def client(machines: Machines) -> Iterator[httpx.Client]:
    with machines.replica() as (_, client):
        yield client


def done(client: httpx.Client, path: str) -> None:
    found = ended(client, path)
    assert (found["status"], found["terminated"]) == ("done", "time_limit")
    check(found)


def test_what_a_replica_has_begun_another_tells_of_when_it_is_killed(
    machines: Machines, client: httpx.Client
) -> None:
    with machines.replica() as (service, other):
        path = later(other, SOME_SECONDS)
        until_found(client, path)
        service.process.kill()
        service.process.wait()
    told = events(client, path)
    assert told[0] == ("progress", told[0][1]) or told[0][1]["status"] == "running"
    assert told[-1] == ("status", {"id": id_of(path), "status": "done"})
    done(client, path)


def test_when_a_worker_and_all_its_processes_are_lost_another_does_its_job(
    machines: Machines, client: httpx.Client
) -> None:
    path = later(client, SOME_SECONDS)
    until_found(client, path)
    planner = planning(machines.connection, id_of(path))
    machines.workers[-1].kill()
    machines.start_worker()
    assert not Path(f"/proc/{planner}").exists()
    done(client, path)


def test_a_worker_that_is_told_to_end_hands_its_job_back(
    machines: Machines, client: httpx.Client
) -> None:
    path = later(client, {**LONG, "time_limit": 4})
    until_found(client, path)
    machines.workers[-1].terminate()
    assert machines.workers[-1].wait(timeout=30) == 0
    assert client.get(path).json()["status"] == "queued"
    machines.start_worker()
    done(client, path)
    assert int(machines.connection.get("paretour:lost") or 0) <= 1


def test_when_redis_is_restarted_all_goes_on(machines: Machines, client: httpx.Client) -> None:
    with ThreadPoolExecutor() as waiting:
        path, next_path = later(client, SOME_SECONDS), later(client, SOME_SECONDS)
        answer = waiting.submit(client.post, "/front", json=SOME_SECONDS)
        listener = waiting.submit(events, client, path)
        until_found(client, path)
        machines.redis.end()
        unavailable(client, path)
        machines.redis.begin()
        while client.get("/health/ready").status_code != 200:
            time.sleep(0.05)
        done(client, path)
        done(client, next_path)
        assert answer.result().json()["status"] == "done"
        assert listener.result()[-1][1]["status"] == "done"
    done(client, later(client, SOME_SECONDS))


def unavailable(client: httpx.Client, path: str) -> None:
    """Without Redis everything that needs it says so, and the replica lives."""
    for answer in (
        client.get(path),
        client.post("/front", json=SOME_SECONDS),
        client.get("/health/ready"),
    ):
        problem(answer, 503, "store-unavailable")
        assert answer.headers["retry-after"]
    assert client.get("/health/live").status_code == 200
    assert client.get("/metrics").status_code == 200


@pytest.fixture(scope="module")
def cluster(request: pytest.FixtureRequest) -> Iterator[Clustered]:
    with engine_of("cluster", request) as cluster:
        assert isinstance(cluster, Clustered)
        yield cluster


def test_who_waits_too_long_is_given_the_best_front_so_far(cluster: Clustered) -> None:
    with cluster.serve(seconds=1.0) as served:
        answer = served.client.post("/front", json=LONG).json()
        assert (answer["status"], answer["terminated"]) == ("done", "time_limit")
        check(answer)


def test_work_that_found_nothing_in_time_is_504_and_its_worker_is_free_again(
    cluster: Clustered, tmp_path: Path
) -> None:
    actor = Shuffler(tmp_path / "gate")
    with cluster.serve(actor, seconds=1.0) as served:
        problem(served.client.post("/front", json=LONG), 504, "overdue")
        actor.open()
        assert ended(served.client, later(served.client))["status"] == "done"


def test_a_client_that_goes_away_frees_its_worker(cluster: Clustered) -> None:
    with cluster.serve() as served:
        with pytest.raises(httpx.ReadTimeout):
            served.client.post("/front", json=LONG, timeout=1)
        assert ended(served.client, later(served.client))["status"] == "done"


def test_a_job_whose_message_was_lost_is_done_all_the_same(cluster: Clustered) -> None:
    with cluster.serve() as served:
        connection = AsyncRedis.from_url(served.redis_url)
        store = RedisStore(connection, entries=9, max_age=60)
        forgetful = Cluster(connection, store, lambda _: None, queue=8, seconds=600)
        app = engine_app(store, forgetful, limits=PATIENT)
        with serving(app) as url, httpx.Client(base_url=url) as client:
            path = later(client)
        assert ended(served.client, path)["status"] == "done"


def test_ten_kills_under_load_lose_no_job(redis: Redis) -> None:
    url = f"{redis.url.removesuffix('/0')}/9"
    request = {"coordinates": CITIES[:60], "time_limit": 0.4}
    store, engine = replica(url, entries=100, max_age=60, queue=40, seconds=600)
    app = engine_app(store, engine, limits=PATIENT)
    with (
        crew(url, planner_of(limits=PATIENT), 600, workers=2),
        serving(app) as address,
        httpx.Client(base_url=address, timeout=60) as client,
        ThreadPoolExecutor(4) as callers,
    ):
        answers = [callers.submit(client.post, "/front", json=request) for _ in range(12)]
        paths = [later(client, request) for _ in range(20)]
        kill_ten(url, paths)
        for path in paths:
            found = ended(client, path)
            assert (found["status"], bool(found["front"])) == ("done", True)
            check(found)
        for answer in answers:
            answered(answer)


def kill_ten(url: str, paths: list[str]) -> None:
    """Kill the process that plans, ten times, each time with another job."""
    connection = redis.Redis.from_url(url)
    killed: set[str] = set()
    while len(killed) < 10:
        for path in set(paths) - killed:
            if (pid := planning(connection, id_of(path))) and len(killed) < 10:
                os.kill(pid, signal.SIGKILL)
                killed.add(path)
        time.sleep(0.05)


def answered(answer: Future[httpx.Response]) -> None:
    """With a front, or with a clear refusal."""
    if answer.result().status_code == 200:
        check(answer.result().json())
    else:
        assert answer.result().json()["code"] in ("queue-full", "worker-lost")


def without(*packages: str, code: str) -> subprocess.CompletedProcess[str]:
    missing = "".join(f"sys.modules[{name!r}] = None; " for name in packages)
    return subprocess.run(
        [sys.executable, "-c", f"import sys; {missing}{code}"], capture_output=True, text=True
    )


@pytest.mark.parametrize("command", ["serve", "work"])
def test_without_the_extra_redis_is_refused_at_the_start(
    command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PARETOUR_REDIS_URL", "redis://127.0.0.1:1/0")
    code = f"from service.__main__ import main; main([{command!r}])"
    refused = without("celery", code=code)
    assert refused.returncode == 2
    assert "PARETOUR_REDIS_URL needs the extra paretour[cluster]" in refused.stderr


def test_without_the_extra_the_service_is_what_it_was() -> None:
    code = "from service.serve import build; from service.settings import Settings; "
    assert without("celery", "redis", code=f"{code}build(Settings())").returncode == 0


def test_a_worker_needs_a_redis_to_work_for() -> None:
    refused = without(code="from service.__main__ import main; main(['work'])")
    assert refused.returncode == 2
    assert "PARETOUR_REDIS_URL must say for which Redis to work" in refused.stderr
