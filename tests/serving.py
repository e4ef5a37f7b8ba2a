"""A live server in a thread, and an actor to put behind it."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import httpx
import numpy as np
import uvicorn
from fastapi import FastAPI

from service.actor import ActorFacts
from service.app import create_app
from service.edge import Edge
from service.fronts import NamedActor
from service.instance import Instance, Kind
from service.schemas import Limits
from service.serve import build
from service.settings import Settings
from service.store import Store
from service.workers import Workers

LIMITS = Limits(body_bytes=100_000, cities=50, preferences=20, size=30, seconds=0.2)


def facts_of(name: str, inputs: Kind) -> ActorFacts:
    return ActorFacts(
        name=name,
        digest="0" * 64,
        commit="0000000",
        inputs=inputs,
        sizes=[20, 60],
        angles=[0, 90],
        config={},
        figures={},
    )


@dataclass
class Shuffler:
    """An actor that shuffles the cities, each time the same way, and waits until it may go on."""

    may_go_on: threading.Event = field(default_factory=threading.Event)
    started: threading.Semaphore = field(default_factory=lambda: threading.Semaphore(0))
    facts: ActorFacts = field(default_factory=lambda: facts_of("pa-one", "coordinates"))

    def __post_init__(self) -> None:
        self.may_go_on.set()

    def tours(self, instance: Instance, preferences: np.ndarray) -> np.ndarray:
        self.started.release()
        assert self.may_go_on.wait(timeout=30)
        rng = np.random.default_rng(0)
        return np.array([rng.permutation(instance.n) for _ in preferences])


class Broken(Shuffler):
    """An actor with a bug."""

    def tours(self, instance: Instance, preferences: np.ndarray) -> np.ndarray:
        raise RuntimeError(f"no tour of {instance.n} cities for {len(preferences)} preferences")


def nothing() -> None:
    """A warm-up of nothing."""


def app_of(
    actor: Shuffler | None = None,
    store: Store | None = None,
    workers: Workers | None = None,
    limits: Limits = LIMITS,
    actors: Sequence[NamedActor] | None = None,
    edge: Edge | None = None,
) -> FastAPI:
    if actors is None:
        actors = [actor or Shuffler(), Shuffler(facts=facts_of("pa-one-matrix", "matrices"))]
    return create_app(
        {each.facts.name: each for each in actors},
        store or Store(entries=100, max_age=60),
        workers or Workers(workers=2, queue=8, warm_up=nothing),
        limits,
        "test",
        edge,
    )


@contextmanager
def serving(app: FastAPI, drain: int = 5) -> Iterator[str]:
    """The address of a server that answers as long as the block lasts."""
    listening = socket.create_server(("127.0.0.1", 0))
    server = uvicorn.Server(uvicorn.Config(app, log_config=None, timeout_graceful_shutdown=drain))
    thread = threading.Thread(target=server.run, args=[[listening]])
    thread.start()
    while not server.started:
        time.sleep(0.01)
    try:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@contextmanager
def serving_released() -> Iterator[str]:
    """The address of the service as it is released, once it takes work of every kind."""
    with serving(build(Settings())) as address:
        while httpx.get(f"{address}/health/ready").status_code == 503:
            time.sleep(0.05)
        yield address


@dataclass
class Running:
    """The command `paretour serve`, and what it has written to its log once it has ended."""

    url: str
    process: subprocess.Popen[bytes]
    log: bytes = b""


@contextmanager
def running(settings: Mapping[str, str]) -> Iterator[Running]:
    """The service as a process of its own, told to end when the block does."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "service", "serve", "--port", str(port)]
    # Nothing here waits for compiled code.
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", **settings}
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE) as process:
        service = Running(f"http://127.0.0.1:{port}", process)
        try:
            _wait_until_live(service.url)
            yield service
        finally:
            process.send_signal(signal.SIGTERM)
            _, service.log = process.communicate(timeout=30)


def _wait_until_live(url: str) -> None:
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        try:
            httpx.get(f"{url}/health/live").raise_for_status()
            return
        except httpx.ConnectError:
            time.sleep(0.05)
    raise TimeoutError("the server must start within 30 s")


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
