"""A live server in a thread, and an actor to put behind it."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import httpx
import numpy as np
import uvicorn
from fastapi import FastAPI

from service.actor import ActorFacts
from service.app import create_app
from service.instance import Instance
from service.schemas import Limits
from service.serve import build
from service.settings import Settings
from service.store import Store
from service.workers import Workers

LIMITS = Limits(body_bytes=100_000, cities=50, preferences=20, size=30, seconds=0.2)


@dataclass
class Shuffler:
    """An actor that shuffles the cities, each time the same way, and waits until it may go on."""

    may_go_on: threading.Event = field(default_factory=threading.Event)
    started: threading.Semaphore = field(default_factory=lambda: threading.Semaphore(0))
    facts: ActorFacts = field(
        default_factory=lambda: ActorFacts(
            name="pa-one",
            digest="0" * 64,
            commit="0000000",
            inputs="coordinates",
            sizes=[20, 60],
            angles=[0, 90],
            config={},
            figures={},
        )
    )

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
) -> FastAPI:
    actor = actor or Shuffler()
    return create_app(
        {actor.facts.name: actor},
        store or Store(entries=100, max_age=60),
        workers or Workers(workers=2, queue=8, warm_up=nothing),
        limits,
        "test",
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
