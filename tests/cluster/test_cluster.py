"""Many machines and what may befall them: real processes, a real Redis, and kill -9."""

import asyncio
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import Any

import httpx
import pytest
import redis

from service.__main__ import main
from service.cluster import worker_store
from service.cluster.celery_app import QUEUE
from tests.helpers.cluster_state import ClusterState
from tests.helpers.command import paretour
from tests.helpers.jobs import (
    CITIES,
    LATER,
    LONG,
    SHORT,
    check,
    ended,
    events,
    id_of,
    later,
    until_found,
)
from tests.helpers.processes import ServeProcess, serve_process, work_process
from tests.helpers.redis_server import LASTING, Redis, redis_server
from tests.helpers.serving import problem


def takes_work(redis_url: str) -> bool:
    return asyncio.run(worker_store.takes_work(redis_url))


SOME_SECONDS: dict[str, Any] = {"coordinates": CITIES, "time_limit": 1.5}


@dataclass
class Machines:
    """A Redis that lasts, and commands that work with it, each as if on a machine of its own."""

    redis: Redis
    stack: ExitStack
    actors: dict[str, str]
    workers: list[subprocess.Popen[bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.connection = redis.Redis.from_url(self.redis.url)
        self.state = ClusterState(self.redis.url)
        self._settings = {
            "PARETOUR_REDIS_URL": self.redis.url,
            "PARETOUR_WORKERS": "1",
            "PARETOUR_DRAIN_SECONDS": "1",
            **self.actors,
        }

    def start_worker(self) -> None:
        before = self.state.workers()
        self.workers.append(self.stack.enter_context(work_process(self._settings)))
        while self.state.workers() <= before:
            time.sleep(0.05)

    @contextmanager
    def replica(self) -> Iterator[tuple[ServeProcess, httpx.Client]]:
        with serve_process(self._settings) as service, httpx.Client(base_url=service.url) as client:
            client.timeout = 60
            yield service, client


@pytest.fixture(scope="module")
def machines(
    tmp_path_factory: pytest.TempPathFactory, quick_actors: dict[str, str]
) -> Iterator[Machines]:
    with (
        redis_server(tmp_path_factory.mktemp("redis"), LASTING) as redis,
        ExitStack() as stack,
    ):
        machines = Machines(redis, stack, quick_actors)
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
        path = later(other, {**LONG, "time_limit": 6})
        until_found(client, path)
        service.process.kill()
        service.process.wait()
    told = events(client, path)
    assert told[0] == ("progress", told[0][1]) or told[0][1]["status"] == "running"
    assert told[-1] == ("status", {"id": id_of(path), "status": "done"})
    done(client, path)


@pytest.mark.parametrize("with_its_processes", [False, True])
def test_when_a_worker_is_lost_its_job_ends_with_a_front(
    machines: Machines, client: httpx.Client, with_its_processes: bool
) -> None:
    path = later(client, {**SOME_SECONDS, "time_limit": 4})
    until_found(client, path)
    planner = machines.state.planning(id_of(path))
    assert planner is not None
    machines.workers[-1].kill()
    if with_its_processes:
        os.kill(planner, signal.SIGKILL)
    machines.start_worker()
    done(client, path)


def test_a_worker_that_is_told_to_end_hands_its_job_back(
    machines: Machines, client: httpx.Client
) -> None:
    lost = machines.state.lost()
    path = later(client, {**LONG, "time_limit": 4})
    until_found(client, path)
    machines.workers[-1].terminate()
    assert machines.workers[-1].wait(timeout=30) == 0
    assert client.get(path).json()["status"] == "queued"
    machines.start_worker()
    done(client, path)
    assert machines.state.lost() == lost


def test_stops_have_their_ids_and_names_from_another_machine(client: httpx.Client) -> None:
    stops = [{"id": f"order-{i}", "location": [i / 9, i**2 / 50]} for i in range(8)]
    plane = [[i % 3, i % 5] for i in range(8)]
    way = {"name": "way", "from": "great_circle"}
    objectives = [way, {"name": "risk", "unit": "%", "coordinates": plane}]
    request = {"stops": stops, "objectives": objectives, "start": "order-5", "time_limit": 0.05}
    found = client.post("/front", json=request).json()
    assert found["status"] == "done", found
    assert found == ended(client, later(client, request)) | {
        name: found[name] for name in ("id", "timings_ms")
    }
    assert (found["stops"], found["objectives"][0]) == (stops, {"name": "way", "unit": "m"})
    for item in found["front"]:
        assert item["stops"] == [f"order-{city}" for city in item["tour"]]
        assert item["stops"][0] == "order-5"


def test_a_day_and_the_rest_of_it_are_planned_on_another_machine(client: httpx.Client) -> None:
    ids = ("depot", "school", "office", "shop")
    times = [[0, 60, 80, 95], [60, 0, 40, 85], [75, 45, 0, 30], [90, 80, 30, 0]]
    request = {
        "stops": [{"id": id_, "service": 300 * (id_ != "depot")} for id_ in ids],
        "objectives": [
            {"name": "time", "matrix": times, "over_the_day": [[25_200, 1], [25_500, 2]]},
            {"name": "risk", "slices": [{"from": 0, "matrix": times[::-1]}]},
        ],
        "departure": {"earliest": 25_200, "latest": 25_600},
        "time_limit": 0.1,
    }
    front = client.post("/front", json=request).json()
    for each in front["front"]:
        assert each["times"][0] == each["departure"]
        assert each["times"][-1] == each["departure"] + each["lengths"][0]
    changes = {"done": ["depot", "shop"], "now": 27_000}
    path = f"/front/{front['id']}/replan"
    rest = client.post(path, json=changes, headers=LATER)
    answer = ended(client, rest.headers["Location"])
    assert {each["departure"] for each in answer["front"]} == {27_000}
    # By the office, 2 x 30 s, or by the school, 2 x 80 s; 300 s at both, and back.
    shortest = min(2 * (30 + 45 + 60), 2 * (80 + 40 + 75)) + 600
    assert min(each["lengths"][0] for each in answer["front"]) == shortest


def test_a_worker_that_takes_no_work_is_found(machines: Machines, client: httpx.Client) -> None:
    worker, url = machines.workers[-1], machines.redis.url
    assert takes_work(url)
    worker.send_signal(signal.SIGSTOP)
    try:
        path = later(client)
        # What it was waiting for it may still be given; what is sent again, nobody takes.
        while not machines.connection.llen(QUEUE):
            time.sleep(0.05)
        assert not takes_work(url)
    finally:
        worker.send_signal(signal.SIGCONT)
    assert ended(client, path)["status"] == "done"
    assert takes_work(url)


def test_where_there_is_no_worker_the_command_says_so(redis: Redis) -> None:
    empty = f"{redis.url.removesuffix('/0')}/15"
    asked = paretour("work", "--alive", PARETOUR_REDIS_URL=empty)
    assert (asked.returncode, asked.stdout) == (1, "")
    assert "no worker on this machine" in asked.stderr


def test_when_redis_is_full_no_more_is_taken_until_there_is_room(
    machines: Machines, client: httpx.Client
) -> None:
    found = client.post("/front", json=SHORT).json()
    machines.connection.config_set("maxmemory", 1)
    try:
        problem(client.post("/front", json=SHORT), 503, "store-unavailable")
        problem(client.post("/front", json=SHORT, headers=LATER), 503, "store-unavailable")
        assert client.get(f"/front/{found['id']}").json() == found
        assert takes_work(machines.redis.url)
    finally:
        machines.connection.config_set("maxmemory", 0)
    assert machines.state.unfinished() == {}
    assert client.post("/front", json=SHORT).json()["status"] == "done"


def test_a_job_that_ends_when_redis_is_full_ends_once_there_is_room(
    machines: Machines, client: httpx.Client
) -> None:
    path = later(client, SOME_SECONDS)
    until_found(client, path)
    machines.connection.config_set("maxmemory", 1)
    try:
        problem(client.post("/front", json=SHORT), 503, "store-unavailable")
        time.sleep(
            SOME_SECONDS["time_limit"] + 3
        )  # the job is over, and its worker said so in vain
    finally:
        machines.connection.config_set("maxmemory", 0)
    done(client, path)
    done(client, later(client, SOME_SECONDS))
    assert machines.workers[-1].poll() is None


def test_when_redis_is_restarted_all_goes_on(machines: Machines, client: httpx.Client) -> None:
    with ThreadPoolExecutor() as waiting:
        path, next_path = later(client, SOME_SECONDS), later(client, SOME_SECONDS)
        answer = waiting.submit(client.post, "/front", json=SOME_SECONDS)
        listener = waiting.submit(events, client, path)
        until_found(client, path)
        machines.redis.end()
        unavailable(client, path)
        # That is not the worker's fault.
        assert takes_work(machines.redis.url)
        machines.redis.begin()
        # The first answers of a Redis that comes back may take too long, and not only the first.
        for asked in ("/health/ready", path, next_path):
            while (found := client.get(asked)).status_code == 503 or unfinished(found):
                time.sleep(0.05)
        done(client, path)
        done(client, next_path)
        assert answer.result().json()["status"] == "done"
        assert listener.result()[-1][1]["status"] == "done"
    done(client, later(client, SOME_SECONDS))


def unfinished(answer: httpx.Response) -> bool:
    return answer.json().get("status") in ("queued", "running")


def unavailable(client: httpx.Client, path: str) -> None:
    """Without Redis everything that needs it says so, and the replica lives."""
    for answer in (
        client.get(path),
        client.delete(path),
        client.get(f"{path}/events"),
        client.get("/tour?angle=30"),
        client.post("/front", json=SOME_SECONDS),
        client.get("/health/ready"),
    ):
        problem(answer, 503, "store-unavailable")
        assert answer.headers["retry-after"]
    assert client.get("/health/live").status_code == 200
    assert client.get("/metrics").status_code == 200


@pytest.mark.parametrize("command", ["serve", "work"])
def test_without_the_extra_redis_is_refused_at_the_start(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PARETOUR_REDIS_URL", "redis://127.0.0.1:1/0")
    monkeypatch.setitem(sys.modules, "celery", None)
    with pytest.raises(SystemExit) as stopped:
        main([command])
    assert stopped.value.code == 2
    assert "PARETOUR_REDIS_URL needs the extra paretour[cluster]" in capsys.readouterr().err


def test_without_the_extra_the_service_is_what_it_was() -> None:
    code = (
        "import sys; sys.modules['celery'] = sys.modules['redis'] = None; "
        "from service.server import Ending, build; from service.settings import Settings; "
        "build(Settings(), Ending())"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_worker_needs_a_redis_to_work_for(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stopped:
        main(["work"])
    assert stopped.value.code == 2
    assert "PARETOUR_REDIS_URL must say for which Redis to work" in capsys.readouterr().err
