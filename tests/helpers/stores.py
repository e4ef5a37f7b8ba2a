"""Records to store, and stores of either kind."""

import asyncio
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from typing import Any, TypeVar

from redis.asyncio import Redis

from service.cluster.records import record_arguments
from service.cluster.redis_store import RedisStore, _identity
from service.cluster.script import connect_redis
from service.cluster.worker_store import WorkerStore
from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from tests.helpers.scripted_runner import document

T = TypeVar("T")


def record(id_: str, caller: str = "us", **more: Any) -> Record:
    given = {"status": "done", "request_id": "r", "front": document("converged")}
    return Record(id=id_, caller=caller, **{**given, **more})


def job(id_: str, **more: Any) -> Record:
    return record(id_, **{"status": "queued", "task": b"{}", **more})


class FullRedisStore(RedisStore):
    """The store in Redis, with what the engine of a single machine asks of a store too."""

    async def put(self, record: Record) -> None:
        """Store a record, in place of an earlier one with its id."""
        await self.call("put", record.id, *record_arguments(record))
        await self._evict()

    async def admit(self, record: Record) -> Record:
        """Store a new record and return it, or return the one that has its idempotency key."""
        await self._evict()
        arguments = (*_identity(record), *record_arguments(record))
        return await self._earlier(record.caller, "admit", *arguments) or record

    async def repeated(self, record: Record) -> Record | None:
        """Return the record that has the idempotency key of this one, if one has and succeeded."""
        return await self._earlier(record.caller, "repeated", *_identity(record)[1:])

    async def unfinished(self) -> list[Record]:
        """Return all unfinished records with their tasks, the oldest first."""
        found = [await self.read(*each, whole=True) for each in await self.call("unfinished")]
        return [stored.record for stored in found if stored is not None]


@asynccontextmanager
async def sqlite_store(**options: Any) -> AsyncIterator[Any]:
    store = SqliteStore(IN_MEMORY, **options)
    yield store
    await store.close()


@asynccontextmanager
async def redis_store(url: str, **options: Any) -> AsyncIterator[Any]:
    redis = Redis.from_url(url)
    await redis.flushall()
    store = FullRedisStore(redis, **options)
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
