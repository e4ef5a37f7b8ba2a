"""Records to store, and stores of either kind."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from redis.asyncio import Redis

from service.cluster.redis_store import RedisStore
from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.store import Store
from service.requests.task import TaskSource
from tests.helpers.scripted_runner import document


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
