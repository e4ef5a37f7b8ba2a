"""Stores of either kind: what is stored, found, dropped and deleted."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import pytest

from service.errors import Expired, IdempotencyMismatch, NotFound
from service.jobs.record import Record
from service.jobs.store import TASK_SHARE
from tests.helpers.stores import job, record, redis_store, sqlite_store

Run = Callable[..., None]


def large(id_: str, size: int = 10_000, **more: Any) -> Record:
    return record(id_, problem={"detail": "x" * size}, **more)


class Clock:
    """A clock that is told the time."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture(params=["sqlite", "redis"])
def run(request: pytest.FixtureRequest) -> Run:
    """Runs a test with a store of either kind."""
    stores = sqlite_store
    if request.param == "redis":
        stores = partial(redis_store, request.getfixturevalue("redis").url)

    def run(test: Callable[[Any], Awaitable[None]], **options: Any) -> None:
        async def with_store() -> None:
            async with stores(**{"entries": 2, "max_age": 60, **options}) as store:
                await test(store)

        asyncio.run(with_store())

    return run


def test_what_was_put_is_given_again_as_it_was(run: Run) -> None:
    async def test(store: Any) -> None:
        a, b = record("a"), record("b", problem={"code": "overdue"})
        await store.put(a)
        await store.put(b)
        kept = await store.get("us", "a")
        assert (kept.json(), kept.front.tour(0)) == (a.json(), a.front.tour(0))
        assert (await store.latest("us", "us")).json() == b.json()

    run(test)


def test_an_id_never_used_is_unknown(run: Run) -> None:
    async def test(store: Any) -> None:
        with pytest.raises(NotFound):
            await store.get("us", "a")
        with pytest.raises(NotFound):
            await store.latest("us", "us")

    run(test)


def test_a_caller_sees_its_own_alone(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(record("a", caller="us"))
        await store.put(record("b", caller="them"))
        assert (await store.latest("us", "us")).id == "a"
        with pytest.raises(NotFound):
            await store.get("them", "a")
        await store.put(record("c", caller="us"))
        # It has made way, which is nobody else's business.
        with pytest.raises(Expired):
            await store.get("us", "a")
        with pytest.raises(NotFound):
            await store.get("them", "a")

    run(test)


def test_the_latest_of_a_client_is_not_that_of_another_without_a_key(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(record("a", client="192.0.2.1"))
        await store.put(record("b", client="192.0.2.2"))
        assert (await store.latest("us", "192.0.2.1")).id == "a"
        assert (await store.latest("us", "192.0.2.2")).id == "b"
        for nobody in ("192.0.2.3", "us"):
            with pytest.raises(NotFound):
                await store.latest("us", nobody)
        with pytest.raises(NotFound):  # a caller that has the name of an address
            await store.latest("192.0.2.1", "192.0.2.1")
        await store.put(record("c", client="192.0.2.2"))
        await store.put(record("d", client="192.0.2.3"))
        assert (await store.latest("us", "192.0.2.1")).id == "a"
        clock.now += 100
        for gone in ("192.0.2.1", "192.0.2.2"):
            with pytest.raises(Expired):
                await store.latest("us", gone)
        with pytest.raises(NotFound):
            await store.latest("us", "192.0.2.4")

    clock = Clock()
    run(test, clock=clock, entries=3)


def test_the_records_of_a_client_are_listed_page_by_page_the_newest_first(run: Run) -> None:
    async def test(store: Any) -> None:
        for name in "abc":
            await store.put(record(name, client="192.0.2.1"))
        await store.put(record("d", client="192.0.2.2"))
        await store.admit(job("e", client="192.0.2.1"))
        page = await store.fronts("us", "192.0.2.1", 2**53, 3)
        assert [each.id for each in page] == ["e", "c", "b"]
        assert [each.status for each in page] == ["queued", "done", "done"]
        [rest] = await store.fronts("us", "192.0.2.1", page[-1].number, 3)
        assert rest.id == "a"
        assert await store.fronts("us", "192.0.2.1", rest.number, 3) == []
        assert await store.fronts("them", "192.0.2.1", 2**53, 3) == []

    run(test, entries=9)


def test_the_oldest_makes_way_when_the_store_is_full(run: Run) -> None:
    async def test(store: Any) -> None:
        for id_ in "abc":
            await store.put(record(id_))
        with pytest.raises(Expired):
            await store.get("us", "a")
        assert [(await store.get("us", id_)).id for id_ in "bc"] == ["b", "c"]

    run(test)


async def kept(store: Any, caller: str, ids: Iterable[str]) -> list[str]:
    found = []
    for id_ in ids:
        with suppress(Expired):
            found.append((await store.get(caller, id_)).id)
    return found


def test_many_records_of_one_caller_leave_those_of_another(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.admit(record("a", key="k", digest="1"))
        for id_ in map(str, range(300)):
            await store.put(record(id_, caller="them"))
        assert (await store.get("us", "a")).id == (await store.latest("us", "us")).id == "a"
        assert (await store.admit(job("b", key="k", digest="1"))).id == "a"
        assert await kept(store, "them", map(str, range(300))) == ["297", "298", "299"]
        for id_ in "bcd":
            await store.put(record(id_))
        # Of those with as many, the one with the oldest makes way.
        assert await kept(store, "us", "abcd") == ["c", "d"]
        assert await kept(store, "them", ("298", "299")) == ["298", "299"]

    run(test, entries=4)


def test_large_records_of_one_caller_leave_those_of_another(run: Run) -> None:
    async def test(store: Any) -> None:
        for id_ in "abc":
            await store.put(record(id_))
        for id_ in "defg":
            await store.put(large(id_, caller="them"))
        assert await kept(store, "us", "abc") == ["a", "b", "c"]
        assert await kept(store, "them", "defg") == ["f", "g"]

    run(test, entries=100, max_bytes=25_000)


def test_the_last_record_of_a_caller_is_kept_while_others_have_two(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(large("a"))
        for id_ in "bcd":
            await store.put(large(id_, 2_000, caller="them"))
        assert await kept(store, "us", "a") == ["a"]
        assert await kept(store, "them", "bcd") == ["d"]
        await store.put(large("e", 9_000, caller="others"))
        # All have one: the largest goes.
        assert await kept(store, "us", "a") == []
        assert await kept(store, "them", "d") == ["d"]

    run(test, entries=100, max_bytes=14_000)


def test_a_record_that_no_store_could_hold_moves_no_other(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(record("a"))
        await store.put(large("b", 30_000, caller="them"))
        with pytest.raises(Expired):
            await store.get("them", "b")
        assert await kept(store, "us", "a") == ["a"]

    run(test, entries=100, max_bytes=25_000)


def test_what_is_deleted_or_stored_anew_is_counted_no_longer(run: Run) -> None:
    async def test(store: Any) -> None:
        for _ in range(9):
            await store.put(large("a"))
            await store.put(large("b"))
            await store.delete(record("b"))
        await store.put(large("c"))
        assert await kept(store, "us", "ac") == ["a", "c"]

    run(test, entries=100, max_bytes=25_000)


def test_asking_for_a_front_does_not_keep_it_longer(run: Run) -> None:
    clock = Clock()

    async def test(store: Any) -> None:
        await store.put(record("a"))
        clock.now = 60
        assert (await store.get("us", "a")).id == "a"
        clock.now = 61
        with pytest.raises(Expired):
            await store.get("us", "a")
        with pytest.raises(Expired):
            await store.latest("us", "us")

    run(test, clock=clock)


def test_only_so_many_of_the_gone_are_remembered(run: Run) -> None:
    async def test(store: Any) -> None:
        for id_ in "abcd":
            await store.put(record(id_))
        with pytest.raises(NotFound):
            await store.get("us", "a")
        for id_ in "bc":
            with pytest.raises(Expired):
                await store.get("us", id_)

    run(test, entries=1, tombstones=2)


def test_what_is_forgotten_leaves_nothing(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(record("a"))
        await store.delete(record("a"))
        with pytest.raises(NotFound):
            await store.get("us", "a")

    run(test)


def test_unfinished_work_never_makes_way_and_its_front_counts_as_new_when_it_is_done(
    run: Run,
) -> None:
    clock = Clock()

    async def test(store: Any) -> None:
        await store.put(job("a"))
        clock.now = 100
        for id_ in "bcd":
            await store.put(record(id_))
        [unfinished] = await store.unfinished()
        assert (unfinished.id, unfinished.task) == ("a", b"{}")
        assert (await store.latest("us", "us")).id == "d"
        await store.put(replace(unfinished, status="done", task=None))
        assert (await store.latest("us", "us")).id == "a"
        assert await store.unfinished() == []

    run(test, clock=clock)


def test_a_key_gives_the_record_that_it_was_first_used_for(run: Run) -> None:
    async def test(store: Any) -> None:
        first = job("a", key="k", digest="1")
        assert await store.admit(first) is first
        assert (await store.admit(job("b", key="k", digest="1"))).id == "a"
        with pytest.raises(IdempotencyMismatch):
            await store.admit(job("c", key="k", digest="2"))
        other = job("d", caller="them", key="k", digest="2")
        assert await store.admit(other) is other
        await store.put(replace(first, status="done", task=None))
        assert (await store.admit(job("e", key="k", digest="1"))).status == "done"
        await store.delete(first)
        assert (await store.admit(job("f", key="k", digest="2"))).id == "f"
        await store.put(job("f", key="k", digest="2", status="failed"))
        assert (await store.admit(job("g", key="k", digest="2"))).id == "g"
        assert (await store.get("us", "f")).status == "failed"

    run(test)


def test_a_finished_record_has_its_task_beside_it(run: Run) -> None:
    async def test(store: Any) -> None:
        await store.put(record("a", task=b"{}"))
        await store.put(record("b"))
        a, b = await store.get("us", "a"), await store.get("us", "b")
        assert (a.task, await store.task(a), await store.task(b)) == (None, b"{}", None)
        await store.delete(a)
        assert await store.task(a) is None

    run(test)


def test_a_task_too_large_for_its_share_is_not_kept_and_its_record_is(run: Run) -> None:
    async def test(store: Any) -> None:
        most = 100_000 // TASK_SHARE
        small = b" " * (most - 5)
        await store.put(record("a", task=small))
        await store.put(record("b", task=b" " * most))
        a, b = await store.get("us", "a"), await store.get("us", "b")
        assert (await store.task(a), await store.task(b)) == (small, None)

    run(test, max_bytes=100_000)


def test_tasks_count_among_the_bytes_of_a_store(run: Run) -> None:
    async def test(store: Any) -> None:
        for id_ in "abcdef":
            await store.put(record(id_, task=b" " * 24_900))
        assert await kept(store, "us", "abcdef") == ["d", "e", "f"]

    run(test, entries=9, max_bytes=100_000)
