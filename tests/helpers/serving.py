"""The application with stand-ins for its actors, and live servers in a thread of the test."""

import json
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI

from service.api.app import Edge, create_app
from service.api.transport.connections import ConnectionLimits, Connections
from service.api.transport.listener import bound_sockets
from service.jobs.engine import Engine
from service.jobs.local_engine import LocalEngine
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.store import Store
from service.jobs.task_runner import TaskRunner
from service.jobs.workers.worker_pool import WorkerPool
from service.jobs.workers.worker_process import MakeRunner
from service.kinds.kind import NamedActor
from service.kinds.parts import Compiling, Part
from service.requests.limits import Limits
from service.server import Ending, build, make_server
from service.settings import Settings
from tests.helpers.actors import Shuffler, info_of
from tests.helpers.processes import UNLIMITED

LIMITS = Limits(body_bytes=100_000, cities=50, cells=900, preferences=20, size=30, seconds=0.2)
ACTORS = (Shuffler(), Shuffler(info=info_of("pa-one-matrix", "matrices")))


@dataclass(frozen=True)
class ColdRunner(TaskRunner):
    """A runner whose warm-up lasts until the file `warm` exists."""

    warm: Path = Path("/nowhere")

    def warm_up(self, parts: Collection[Part], tell: Callable[[Part | Compiling], None]) -> None:
        """Wait until the file exists."""
        while not self.warm.exists():
            tell(Compiling(0.4, 20.0))
            time.sleep(0.02)
        for part in parts:
            tell(part)


def runner_of(
    *actors: NamedActor, limits: Limits = LIMITS, warm: Path | None = None
) -> Callable[[], TaskRunner]:
    """Return a picklable factory of runners with these actors, by default two that shuffle.

    With `warm`, the path of a file, their warm-up lasts until it exists.
    """
    by_name = {actor.info.name: actor for actor in actors or ACTORS}
    if warm is None:
        return partial(TaskRunner, by_name, limits)
    return partial(ColdRunner, by_name, limits, warm=warm)


def workers_of(
    make_runner: MakeRunner | None = None,
    workers: int = 1,
    queue: int = 8,
    seconds: float = 60.0,
    share: float = 1.0,
) -> WorkerPool:
    """Return a pool of one process with a queue of eight, unless others are asked for."""
    make_runner = make_runner or runner_of()
    return WorkerPool(make_runner, workers=workers, queue=queue, seconds=seconds, share=share)


def app_of(
    *actors: NamedActor,
    store: SqliteStore | None = None,
    workers: WorkerPool | None = None,
    limits: Limits = LIMITS,
    edge: Edge | None = None,
) -> FastAPI:
    """Return the application with the engine of one machine and, by default, a store in memory."""
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
    """Return the application with this engine and this store."""
    info = {actor.info.name: actor.info for actor in actors or ACTORS}
    return create_app(info, store, engine, limits, "test", edge)


@contextmanager
def serving(
    app: FastAPI,
    drain: int = 5,
    warm: bool = True,
    connections: ConnectionLimits = ConnectionLimits(),  # noqa: B008  # it is frozen
    root_path: str = "",
) -> Iterator[str]:
    """Serve an application in a thread until the block ends, and yield its address.

    Args:
        app: the application.
        drain: seconds that open requests have when it is told to stop.
        warm: whether to wait until its workers are warm.
        connections: the limits of its connections.
        root_path: the path under which a proxy serves it.
    """
    [listening] = bound_sockets("127.0.0.1", 0)
    server = make_server(app, Connections(connections), drain, root_path)
    thread = threading.Thread(target=server.run, args=[[listening]])
    thread.start()
    url = f"http://127.0.0.1:{listening.getsockname()[1]}"
    try:
        while not server.started or (warm and httpx.get(f"{url}/health/ready").status_code == 503):
            time.sleep(0.02)
        yield url
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@contextmanager
def serving_released() -> Iterator[str]:
    """Serve the service as it is released, and yield its address once its worker is warm.

    The fixture `released` of tests/conftest.py is such a server for a whole session.
    """
    with serving(build(Settings(workers=1, rate=UNLIMITED), Ending())) as address:
        yield address


@contextmanager
def serving_settings(settings: Mapping[str, str], warm: bool = False) -> Iterator[str]:
    """Serve the service with these environment variables, and yield its address.

    Where nothing is asked of the command itself, this takes a tenth of what its process takes.
    With `warm`, the address is yielded once its workers are.
    """
    with pytest.MonkeyPatch.context() as environment:
        for name, value in {"PARETOUR_RATE": UNLIMITED, **settings}.items():
            environment.setenv(name, value)
        with serving(build(Settings(), Ending()), warm=warm) as address:
            yield address


def problem(
    response: httpx.Response, status: int, code: str, root_path: str = ""
) -> dict[str, Any]:
    """Return the problem document of a response, after a check of the members that all have."""
    assert response.status_code == status, response.text
    assert response.headers["content-type"] == "application/problem+json"
    document = response.json()
    assert document["status"] == status
    assert document["code"] == code
    assert document["type"] == f"{root_path}/guide/errors#{code}"
    assert document["title"]
    assert document["detail"]
    assert document["request_id"] == response.headers["x-request-id"]
    return document


def events_of(client: httpx.Client, front: str) -> Iterator[tuple[str, Any]]:
    """Yield the events of a job, until it ends or nobody listens."""
    with client.stream("GET", f"/front/{front}/events") as stream:
        name = ""
        for line in stream.iter_lines():
            field, _, value = line.partition(": ")
            if field == "event":
                name = value
            elif field == "data":
                yield name, json.loads(value)
