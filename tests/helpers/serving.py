"""A live server in a thread, and an actor to put behind it."""

import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import uvicorn
from fastapi import FastAPI

from service.actor import ActorInfo
from service.api.app import Edge, create_app
from service.instance import Instance, Kind
from service.jobs.engine import Engine
from service.jobs.local_engine import LocalEngine
from service.jobs.runner import MakeRunner, NamedActor, TaskRunner
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.store import Store
from service.jobs.worker_pool import WorkerPool
from service.requests.limits import Limits
from service.server import build
from service.settings import Settings

LIMITS = Limits(body_bytes=100_000, cities=50, cells=900, preferences=20, size=30, seconds=0.2)


def info_of(name: str, inputs: Kind) -> ActorInfo:
    return ActorInfo(
        name=name,
        digest="0" * 64,
        commit="0000000",
        inputs=inputs,
        sizes=[20, 60],
        angles=[0, 90],
        config={},
        figures={},
    )


@dataclass(frozen=True)
class Shuffler:
    """An actor that shuffles the cities, each time the same way.

    With a gate it leaves a mark beside it, and waits until the gate is there.
    """

    gate: Path | None = None
    info: ActorInfo = field(default_factory=lambda: info_of("pa-one", "coordinates"))

    @property
    def started(self) -> bool:
        assert self.gate is not None
        return self.gate.with_suffix(".started").exists()

    def open(self) -> None:
        assert self.gate is not None
        self.gate.touch()

    def close(self) -> None:
        assert self.gate is not None
        for mark in (self.gate, self.gate.with_suffix(".started")):
            mark.unlink(missing_ok=True)

    def tours(self, instance: Instance, preferences: np.ndarray) -> np.ndarray:
        if self.gate is not None:
            self.gate.with_suffix(".started").touch()
            while not self.gate.exists():
                time.sleep(0.005)
        rng = np.random.default_rng(0)
        return np.array([rng.permutation(instance.n) for _ in preferences])


class Broken(Shuffler):
    """An actor with a bug."""

    def tours(self, instance: Instance, preferences: np.ndarray) -> np.ndarray:
        raise RuntimeError(f"no tour of {instance.n} cities for {len(preferences)} preferences")


ACTORS = (Shuffler(), Shuffler(info=info_of("pa-one-matrix", "matrices")))


@dataclass(frozen=True)
class ColdRunner(TaskRunner):
    """A runner that is warm once there is a file."""

    warm: Path = Path("/nowhere")

    def warm_up(self) -> None:
        while not self.warm.exists():
            time.sleep(0.005)


def runner_of(*actors: NamedActor, limits: Limits = LIMITS, warm: Path | None = None) -> MakeRunner:
    by_name = {actor.info.name: actor for actor in actors or ACTORS}
    if warm is None:
        return partial(TaskRunner, by_name, limits)
    return partial(ColdRunner, by_name, limits, warm)


def workers_of(
    make_runner: MakeRunner | None = None,
    workers: int = 1,
    queue: int = 8,
    seconds: float = 60.0,
) -> WorkerPool:
    make_runner = make_runner or runner_of()
    return WorkerPool(make_runner, workers=workers, queue=queue, seconds=seconds)


def app_of(
    *actors: NamedActor,
    store: SqliteStore | None = None,
    workers: WorkerPool | None = None,
    limits: Limits = LIMITS,
    edge: Edge | None = None,
) -> FastAPI:
    store = store or SqliteStore(IN_MEMORY, entries=100, max_age=60)
    workers = workers or workers_of(runner_of(*actors, limits=limits))
    return engine_app(store, LocalEngine(workers, store), *actors, limits=limits, edge=edge)


def engine_app(
    store: Store,
    engine: Engine,
    *actors: NamedActor,
    limits: Limits = LIMITS,
    edge: Edge | None = None,
) -> FastAPI:
    info = {actor.info.name: actor.info for actor in actors or ACTORS}
    return create_app(info, store, engine, limits, "test", edge)


@contextmanager
def serving(app: FastAPI, drain: int = 5, warm: bool = True) -> Iterator[str]:
    """The address of a server that answers as long as the block lasts."""
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=drain))
    thread = threading.Thread(target=server.run, args=[[listening]])
    thread.start()
    url = f"http://127.0.0.1:{listening.getsockname()[1]}"
    try:
        while not server.started or (warm and httpx.get(f"{url}/health/ready").status_code == 503):
            time.sleep(0.01)
        yield url
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@contextmanager
def serving_released() -> Iterator[str]:
    """The address of the service as it is released, once it takes work of every kind."""
    with serving(build(Settings(workers=1))) as address:
        yield address


@dataclass
class Running:
    """The command `paretour serve`, and what it has written to its log once it has ended."""

    url: str
    process: subprocess.Popen[bytes]
    log: bytes = b""


@contextmanager
def running(settings: Mapping[str, str], ready: bool = False) -> Iterator[Running]:
    """The service as a process of its own, which answers, or is ready, and ends with the block."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service", "serve", "--port", str(port)]
    # Whoever does not wait until it is ready has no use for compiled code.
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "0" if ready else "1", **settings}
    with (
        tempfile.TemporaryFile() as log,
        subprocess.Popen(command, env=environment, stderr=log) as process,
    ):
        service = Running(f"http://127.0.0.1:{port}", process)
        try:
            _wait_for(f"{service.url}/health/{'ready' if ready else 'live'}")
            yield service
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)
            log.seek(0)
            service.log = log.read()


@contextmanager
def working(settings: Mapping[str, str]) -> Iterator[subprocess.Popen[bytes]]:
    """The command `paretour work`, which ends with the block."""
    command = [sys.executable, "-m", "service", "work"]
    environment = {**os.environ, **settings}
    with subprocess.Popen(command, env=environment, stderr=subprocess.DEVNULL) as process:
        try:
            yield process
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)


def _wait_for(url: str) -> None:
    deadline = time.monotonic() + 300
    while time.monotonic() < deadline:
        with suppress(httpx.ConnectError):
            if httpx.get(url).status_code == 200:
                return
        time.sleep(0.05)
    raise TimeoutError(f"{url} must answer within five minutes")


def problem(response: httpx.Response, status: int, code: str) -> dict[str, Any]:
    """The problem document, checked for what every one of them must say."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["code"] == code
    assert document["title"]
    assert document["detail"]
    assert document["request_id"] == response.headers["x-request-id"]
    return document
