"""Deliveries to webhooks, in stores of either kind: stored with the end, taken once, kept."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from service.errors import StoreUnavailable
from service.jobs.outbox import MOST_DELIVERIES
from service.jobs.record import Record
from service.jobs.webhook import Webhook
from tests.helpers.stores import job, record, redis_store, sqlite_store
from tests.jobs.test_store import Clock

HOOK = Webhook("https://hooks.example.com/ä?b", "/front/a")
LEASE = 60.0


@pytest.fixture(params=["sqlite", "redis"])
def run(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Runs a test with a store of either kind, and its clock."""
    stores = sqlite_store
    if request.param == "redis":
        stores = partial(redis_store, request.getfixturevalue("redis").url)

    def run(test: Callable[[Any, Clock], Awaitable[None]]) -> None:
        async def with_store() -> None:
            clock = Clock()
            clock.now = 1000.0
            async with stores(entries=20_000, max_age=1e9, clock=clock) as store:
                await test(store, clock)

        asyncio.run(with_store())

    return run


def ended(id_: str, status: str = "done", **more: Any) -> Record:
    return record(id_, status=status, webhook=HOOK, **more)


def test_a_delivery_is_there_once_the_job_has_ended(run: Callable[..., None]) -> None:
    async def test(store: Any, clock: Clock) -> None:
        await store.admit(job("a", webhook=HOOK))
        assert await store.due_deliveries(9, LEASE) == []
        [unfinished] = await store.unfinished()
        assert unfinished.webhook == HOOK
        clock.now += 5
        await store.put(replace(unfinished, status="failed"))
        [delivery] = await store.due_deliveries(9, LEASE)
        assert (delivery.id, delivery.webhook, delivery.status) == ("a", HOOK, "failed")
        assert (delivery.ended_at, delivery.attempts) == (1005, 1)
        assert (await store.get("us", "a")).webhook is None

    run(test)


def test_a_job_without_a_webhook_has_no_delivery(run: Callable[..., None]) -> None:
    async def test(store: Any, _: Clock) -> None:
        await store.put(record("a"))
        assert await store.due_deliveries(9, LEASE) == []

    run(test)


def test_a_delivery_that_was_taken_is_due_again_after_a_while(run: Callable[..., None]) -> None:
    async def test(store: Any, clock: Clock) -> None:
        await store.put(ended("a"))
        for attempt in (1, 2, 3):
            [delivery] = await store.due_deliveries(9, LEASE)
            assert delivery.attempts == attempt
            clock.now += LEASE - 1
            assert await store.due_deliveries(9, LEASE) == []
            clock.now += 2
        await store.due_deliveries(9, LEASE)
        await store.postpone("a", 500)
        clock.now += 499
        assert await store.due_deliveries(9, LEASE) == []
        clock.now += 2
        assert len(await store.due_deliveries(9, LEASE)) == 1
        await store.remove_delivery("a")
        await store.postpone("a", 0)
        clock.now += 2 * LEASE
        assert await store.due_deliveries(9, LEASE) == []

    run(test)


def test_of_many_those_are_taken_that_have_been_due_longest(run: Callable[..., None]) -> None:
    async def test(store: Any, clock: Clock) -> None:
        for name in "abcde":
            await store.put(ended(name))
            clock.now += 1
        taken = [[each.id for each in await store.due_deliveries(2, LEASE)] for _ in range(4)]
        assert [sorted(each) for each in taken] == [["a", "b"], ["c", "d"], ["e"], []]

    run(test)


def test_a_delivery_outlives_its_front(run: Callable[..., None]) -> None:
    async def test(store: Any, _: Clock) -> None:
        await store.put(ended("a"))
        await store.delete(await store.get("us", "a"))
        assert [each.id for each in await store.due_deliveries(9, LEASE)] == ["a"]

    run(test)


def test_a_repeat_of_what_failed_adds_no_delivery_to_the_first(run: Callable[..., None]) -> None:
    async def test(store: Any, _: Clock) -> None:
        first = job("a", webhook=HOOK, key="k", digest="d")
        await store.admit(first)
        await store.put(replace(first, status="failed", task=None))
        [delivery] = await store.due_deliveries(9, LEASE)
        await store.remove_delivery(delivery.id)
        again = job("b", webhook=HOOK, key="k", digest="d")
        assert (await store.admit(again)).id == "b"
        assert await store.due_deliveries(9, LEASE) == []
        await store.put(replace(again, status="done"))
        assert [each.id for each in await store.due_deliveries(9, LEASE)] == ["b"]

    run(test)


def test_a_damaged_delivery_is_dropped_and_the_others_are_made(
    run: Callable[..., None], caplog: pytest.LogCaptureFixture
) -> None:
    async def test(store: Any, clock: Clock) -> None:
        for name in "abcd":
            await store.put(ended(name))
        await _damage(store, "a", "webhook", "{")
        await _damage(store, "b", "webhook", '{"url": 1}')
        await _damage(store, "c", "status", "running")
        found = await store.due_deliveries(9, LEASE)
        assert [each.id for each in found] == ["d"]
        clock.now += 2 * LEASE
        assert [each.id for each in await store.due_deliveries(9, LEASE)] == ["d"]
        assert caplog.text.count("cannot be read and is dropped") == 3

    run(test)


async def _damage(store: Any, id_: str, name: str, value: str) -> None:
    if hasattr(store, "_database"):
        await store._in_thread(
            store._database.execute, f"UPDATE delivery SET {name} = ? WHERE id = ?", (value, id_)
        )
    else:
        await store._redis.hset(f"paretour:delivery:{id_}", name, value)


def test_beyond_a_number_those_due_last_are_given_up(run: Callable[..., None]) -> None:
    async def test(store: Any, clock: Clock) -> None:
        await store.put(ended("first"))
        await store.put(ended("last"))
        await store.postpone("last", 10 * LEASE)
        clock.now -= 1
        if hasattr(store, "_database"):
            rows = (
                "INSERT INTO delivery (id, due) WITH RECURSIVE n(i) AS"
                f" (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < {MOST_DELIVERIES - 1})"
                " SELECT i, 9e9 FROM n"
            )
            await store._in_thread(store._database.execute, rows)
        else:
            many = {str(i): 1000.0 for i in range(MOST_DELIVERIES - 1)}
            await store._redis.zadd("paretour:deliveries", many)
        clock.now += 1
        await store.put(ended("new"))
        if hasattr(store, "_database"):
            [[left]] = await store._in_thread(
                lambda: store._database.execute("SELECT count(*) FROM delivery").fetchall()
            )
            assert left == MOST_DELIVERIES
            found = await store.due_deliveries(9, LEASE)
            assert {each.id for each in found} == {"first", "new"}
        else:
            assert await store._redis.zcard("paretour:deliveries") == MOST_DELIVERIES
            assert await store._redis.zscore("paretour:deliveries", "last") is None
            assert not await store._redis.exists("paretour:delivery:last")

    run(test)


def test_a_list_of_deliveries_that_holds_something_else_is_made_anew(
    request: pytest.FixtureRequest,
) -> None:
    async def test() -> None:
        async with redis_store(
            request.getfixturevalue("redis").url, entries=9, max_age=1e9
        ) as store:
            await store._redis.set("paretour:deliveries", "x")
            with pytest.raises(StoreUnavailable):
                await store.due_deliveries(9, LEASE)
            await store.put(ended("a"))
            assert [each.id for each in await store.due_deliveries(9, LEASE)] == ["a"]

    asyncio.run(test())
