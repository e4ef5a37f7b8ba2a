"""Either engine behind a live server, so that a test of one is a test of the other."""

import os
import signal
import time
from collections.abc import Callable, Hashable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import httpx
import pytest
import redis

from service.api.app import Edge
from service.cluster.redis_engine import connect
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.workers.worker_pool import WorkerPool
from service.kinds.kind import NamedActor
from tests.helpers.celery_workers import celery_worker
from tests.helpers.cluster_state import ClusterState
from tests.helpers.redis_server import Redis
from tests.helpers.serving import LIMITS, app_of, engine_app, runner_of, serving, workers_of

PATIENT = replace(LIMITS, seconds=600.0, cities=300)
SECONDS = 600.0


@dataclass(frozen=True)
class Served:
    """A client of a service, and the process that plans the front with an id, if one does.

    `searching` tells which of them have a tour already, and which process plans each.
    """

    client: httpx.Client
    planning: Callable[[str], int | None]
    searching: Callable[[], Mapping[Hashable, int]]
    redis_url: str = ""

    def kill(self, id: str, but: int | None = None) -> int:
        """Kill the process that plans a front, once it is another than this."""
        while (pid := self.planning(id)) in (None, but):
            time.sleep(0.02)
        assert pid is not None
        os.kill(pid, signal.SIGKILL)
        return pid


@dataclass(frozen=True)
class Embedded:
    """The engine of one process."""

    workers: int = 1

    @contextmanager
    def serve(
        self,
        *actors: NamedActor,
        queue: int = 8,
        folder: Path | None = None,
        edge: Edge | None = None,
        share: float = 1.0,
    ) -> Iterator[Served]:
        """A service with its workers. What it keeps in a folder outlives it."""
        make_runner = runner_of(*actors, limits=PATIENT)
        workers = workers_of(make_runner, self.workers, queue, SECONDS, share)
        path = IN_MEMORY if folder is None else str(folder / "fronts.sqlite")
        store = SqliteStore(path, entries=1000, max_age=SECONDS)
        app = app_of(*actors, limits=PATIENT, store=store, workers=workers, edge=edge)
        with serving(app) as url, httpx.Client(base_url=url, timeout=300) as client:
            planning = partial(_first_pid, workers)
            yield Served(client, planning, partial(_searching, workers))


@dataclass
class Clustered:
    """The engine of many machines, each a process here, at a Redis database of its own."""

    server: Redis
    celery_workers: ExitStack
    workers: int = 1
    _databases: dict[str, int] = field(default_factory=dict)

    @contextmanager
    def serve(
        self,
        *actors: NamedActor,
        queue: int = 8,
        folder: Path | None = None,
        edge: Edge | None = None,
        share: float = 1.0,
    ) -> Iterator[Served]:
        """A replica, and a worker that goes on for the next with these actors."""
        url = self._url(actors)
        kept = folder is not None and (folder / "begun").exists()
        connection = redis.Redis.from_url(url)
        if not kept:
            connection.flushdb()
        if folder is not None:
            (folder / "begun").touch()
        state = ClusterState(url)
        while not state.workers():
            time.sleep(0.02)
        store, engine = connect(
            url, entries=1000, max_age=SECONDS, queue=queue, share=share, seconds=SECONDS
        )
        app = engine_app(store, engine, *actors, limits=PATIENT, edge=edge)
        with serving(app) as address, httpx.Client(base_url=address, timeout=300) as client:
            yield Served(client, state.planning, state.searching, url)
        connection.close()

    def _url(self, actors: tuple[NamedActor, ...]) -> str:
        known = len(self._databases)
        database = self._databases.setdefault(repr(actors), known)
        url = f"{self.server.url.removesuffix('/0')}/{database}"
        if database == known:
            self.celery_workers.enter_context(
                celery_worker(url, runner_of(*actors, limits=PATIENT), SECONDS, self.workers)
            )
        return url


def _first_pid(workers: WorkerPool, _: str) -> int | None:
    return workers.pids[0] if workers.working else None


def _searching(workers: WorkerPool) -> Mapping[Hashable, int]:
    return {each: pid for each, pid in workers.running.items() if pid and each.progress}


@contextmanager
def engine_of(
    kind: str, request: pytest.FixtureRequest, workers: int = 1
) -> Iterator[Embedded | Clustered]:
    """Either engine; skips the test where there is no Redis."""
    if kind == "embedded":
        yield Embedded(workers)
        return
    with ExitStack() as celery_workers:
        yield Clustered(request.getfixturevalue("redis"), celery_workers, workers)
