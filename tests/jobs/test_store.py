"""Fronts kept for later, and how they make way."""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from redis.asyncio import Redis

from service.cluster.redis_store import RedisStore
from service.errors import Expired, IdempotencyMismatch, NotFound, StoreUnavailable
from service.jobs.record import Record
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.jobs.store import Store
from service.requests.task import TaskSource
from tests.helpers.puppet import document
from tests.helpers.redis_server import redis_server

Run = Callable[..., None]


class Clock:
    """A clock that is told the time."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def record(id_: str, caller: str = "us", **more: Any) -> Record:
    given = {"status": "done", "request_id": "r", "front": document("converged")}
    return Record(id=id_, caller=caller, **{**given, **more})


def job(id_: str, **more: Any) -> Record:
    return record(id_, **{"status": "queued", "source": TaskSource("front", b"{}", b"\0"), **more})


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


@pytest.fixture(params=["sqlite", "redis"])
def run(request: pytest.FixtureRequest) -> Run:
    """Runs a test with a store of either kind."""
    stores = sqlite_store
    if request.param == "redis":
        stores = partial(redis_store, request.getfixturevalue("redis").url)

    def run(test: Callable[[Store], Awaitable[None]], **options: Any) -> None:
        async def with_store() -> None:
            async with stores(**{"entries": 2, "max_age": 60, **options}) as store:
                await test(store)

        asyncio.run(with_store())

    return run


def test_what_was_put_is_given_again_as_it_was(run: Run) -> None:
    async def test(store: Store) -> None:
        a, b = record("a"), record("b", problem={"code": "overdue"})
        await store.put(a)
        await store.put(b)
        kept = await store.get("us", "a")
        assert (kept.json(), kept.front.nearest(30)) == (a.json(), a.front.nearest(30))
        assert (await store.latest("us")).json() == b.json()

    run(test)


def test_an_id_never_used_is_unknown(run: Run) -> None:
    async def test(store: Store) -> None:
        with pytest.raises(NotFound):
            await store.get("us", "a")
        with pytest.raises(NotFound):
            await store.latest("us")

    run(test)


def test_a_caller_sees_its_own_alone(run: Run) -> None:
    async def test(store: Store) -> None:
        await store.put(record("a", caller="us"))
        await store.put(record("b", caller="them"))
        assert (await store.latest("us")).id == "a"
        with pytest.raises(NotFound):
            await store.get("them", "a")
        await store.put(record("c", caller="them"))
        # It has made way, which is nobody else's business.
        with pytest.raises(Expired):
            await store.get("us", "a")
        with pytest.raises(NotFound):
            await store.get("them", "a")

    run(test)


def test_the_oldest_makes_way_when_the_store_is_full(run: Run) -> None:
    async def test(store: Store) -> None:
        for id_ in "abc":
            await store.put(record(id_))
        with pytest.raises(Expired):
            await store.get("us", "a")
        assert [(await store.get("us", id_)).id for id_ in "bc"] == ["b", "c"]

    run(test)


def test_asking_for_a_front_does_not_keep_it_longer(run: Run) -> None:
    clock = Clock()

    async def test(store: Store) -> None:
        await store.put(record("a"))
        clock.now = 60
        assert (await store.get("us", "a")).id == "a"
        clock.now = 61
        with pytest.raises(Expired):
            await store.get("us", "a")
        with pytest.raises(Expired):
            await store.latest("us")

    run(test, clock=clock)


def test_only_so_many_of_the_gone_are_remembered(run: Run) -> None:
    async def test(store: Store) -> None:
        for id_ in "abcd":
            await store.put(record(id_))
        with pytest.raises(NotFound):
            await store.get("us", "a")
        for id_ in "bc":
            with pytest.raises(Expired):
                await store.get("us", id_)

    run(test, entries=1, tombstones=2)


def test_what_is_forgotten_leaves_nothing(run: Run) -> None:
    async def test(store: Store) -> None:
        await store.put(record("a"))
        await store.delete(record("a"))
        with pytest.raises(NotFound):
            await store.get("us", "a")

    run(test)


def test_unfinished_work_never_makes_way_and_its_front_counts_as_new_when_it_is_done(
    run: Run,
) -> None:
    clock = Clock()

    async def test(store: Store) -> None:
        await store.put(job("a"))
        clock.now = 100
        for id_ in "bcd":
            await store.put(record(id_))
        [unfinished] = await store.unfinished()
        assert (unfinished.id, unfinished.source) == ("a", TaskSource("front", b"{}", b"\0"))
        assert (await store.latest("us")).id == "d"
        await store.put(replace(unfinished, status="done", source=None))
        assert (await store.latest("us")).id == "a"
        assert await store.unfinished() == []

    run(test, clock=clock)


def test_a_key_gives_the_record_that_it_was_first_used_for(run: Run) -> None:
    async def test(store: Store) -> None:
        first = job("a", key="k", digest="1")
        assert await store.admit(first) is first
        assert (await store.admit(job("b", key="k", digest="1"))).id == "a"
        with pytest.raises(IdempotencyMismatch):
            await store.admit(job("c", key="k", digest="2"))
        other = job("d", caller="them", key="k", digest="2")
        assert await store.admit(other) is other
        await store.put(replace(first, status="done", source=None))
        assert (await store.admit(job("e", key="k", digest="1"))).status == "done"
        await store.delete(first)
        assert (await store.admit(job("f", key="k", digest="2"))).id == "f"
        await store.put(job("f", key="k", digest="2", status="failed"))
        assert (await store.admit(job("g", key="k", digest="2"))).id == "g"
        assert (await store.get("us", "f")).status == "failed"

    run(test)


def test_what_is_in_a_file_is_there_after_a_restart(tmp_path: Path) -> None:
    path = str(tmp_path / "folder" / "fronts.sqlite")

    async def test() -> None:
        store = SqliteStore(path, entries=2, max_age=60)
        await store.put(record("a"))
        await store.put(job("b"))
        with pytest.raises(ValueError, match="must be a file of its own"):
            SqliteStore(path, entries=2, max_age=60)
        await store.close()
        again = SqliteStore(path, entries=2, max_age=60)
        assert (await again.get("us", "a")).json() == record("a").json()
        assert [each.id for each in await again.unfinished()] == ["b"]
        await again.close()

    asyncio.run(test())


def test_a_store_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=f"store must be a file of its own, {tmp_path} is not"):
        SqliteStore(str(tmp_path), entries=1, max_age=1)


def test_a_store_that_does_not_answer_is_unavailable(tmp_path: Path) -> None:
    async def test() -> None:
        with redis_server(tmp_path) as redis:
            async with redis_store(redis.url, entries=1, max_age=1) as store:
                redis.end()
                with pytest.raises(StoreUnavailable):
                    await store.get("us", "a")

    asyncio.run(test())
