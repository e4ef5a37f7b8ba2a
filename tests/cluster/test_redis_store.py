"""The store in Redis: it may be away, and other releases share it."""

import asyncio
import json
from pathlib import Path

import pytest
from redis.asyncio import Redis as AsyncRedis

from service.cluster.redis_store import RedisStore
from service.errors import StoreUnavailable
from service.requests.task import TaskSource
from service.search.improve import Progress
from tests.helpers.redis_server import Redis, redis_server
from tests.helpers.released_records import ANSWERS, REDIS_HASHES, REDIS_SETS
from tests.helpers.stores import redis_store


def test_a_store_that_does_not_answer_is_unavailable(tmp_path: Path) -> None:
    async def test() -> None:
        with redis_server(tmp_path) as redis:
            async with redis_store(redis.url, entries=1, max_age=1) as store:
                redis.end()
                with pytest.raises(StoreUnavailable):
                    await store.get("us", "a")

    asyncio.run(test())


def test_records_of_the_last_release_are_read(redis: Redis) -> None:
    async def test() -> None:
        connection = AsyncRedis.from_url(redis.url)
        await connection.flushall()
        for key, fields in REDIS_HASHES.items():
            await connection.hset(key, mapping=fields)
        for key, ids in REDIS_SETS.items():
            await connection.zadd(key, ids)
        store = RedisStore(connection, entries=9, max_age=60, clock=lambda: 1001.0)
        done = await store.get("us", "done")
        assert (done.json(), done.front.gained) == (ANSWERS["done"], 0.0625)
        assert (await store.latest("us")).id == "done"
        running = await store.find("get", "us", "running")
        assert running.record.json() == ANSWERS["running"]
        assert (running.requested_at, running.attempts) == (1000, 1)
        assert running.progress == Progress(seconds=0.5, hypervolume=0.4375, points=3)
        waiting, _ = await store.unfinished()
        assert json.loads(waiting.json()) == json.loads(ANSWERS["waiting"])
        assert waiting.source == TaskSource("coverage", b'{"cell_size": 1}', b"\x89PNG")
        await store.close()

    asyncio.run(test())
