"""Records to store, and stores of either kind."""

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any, TypeVar

from redis.asyncio import Redis

from service.cluster.redis_store import RedisStore
from service.cluster.script import connect_redis
from service.cluster.worker_store import WorkerStore
from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.store import Store
from service.requests.task import TaskSource
from tests.helpers.scripted_runner import document

T = TypeVar("T")


def record(id_: str, caller: str = "us", **more: Any) -> Record:
    given = {"status": "done", "request_id": "r", "front": document("converged")}
    return Record(id=id_, caller=caller, **{**given, **more})


def job(id_: str, **more: Any) -> Record:
    source = TaskSource("front", b"{}", b"\0")
    return record(id_, **{"status": "queued", "source": source, **more})


@asynccontextmanager
async def sqlite_store(**options: Any) -> AsyncIterator[Store]:
    store = SqliteStore(IN_MEMORY, **options)
    yield store
    await store.close()


@asynccontextmanager
async def redis_store(url: str, **options: Any) -> AsyncIterator[Store]:
    redis = Redis.from_url(url)
    await redis.flushall()
    store = RedisStore(redis, **options)
    yield store
    await store.close()


class Worker:
    """A worker of the cluster at this Redis, for tests that are not asynchronous."""

    def __init__(self, url: str, name: str) -> None:
        self._store = lambda: WorkerStore(connect_redis(url), name)

    def begin(self, message: str, known_lost: bool = False) -> str | None:
        stored = self._act(lambda store: store.begin(message, known_lost))
        return stored and stored.record.id

    def finish(self, record: Record) -> None:
        self._act(lambda store: store.finish(record))

    def hand_back(self, id_: str) -> None:
        self._act(lambda store: store.hand_back(id_))

    def _act(self, act: Callable[[WorkerStore], Coroutine[Any, Any, T]]) -> T:
        async def with_store() -> T:
            store = self._store()
            try:
                return await act(store)
            finally:
                await store.close()

        return asyncio.run(with_store())
