"""Clients take turns in the cluster: a message is a turn, whichever record it was sent for."""

import asyncio
from collections.abc import Iterator
from typing import Any

import pytest
import redis as redis_client
from hypothesis import HealthCheck, example, given, settings
from redis.asyncio import Redis as AsyncRedis

from service.cluster.script import LEASE
from service.jobs.record import Record
from tests.helpers.redis_server import Redis
from tests.helpers.sampled import third
from tests.helpers.stores import FullRedisStore, Worker, job, record
from tests.helpers.turns import EVENTS, clients_by_policy

pytestmark = pytest.mark.usefixtures("connection")


@pytest.fixture
def connection(redis: Redis) -> Iterator[Any]:
    with redis_client.Redis.from_url(redis.url) as connection:
        connection.flushall()
        yield connection


def submitted(url: str, *ids: str) -> None:
    """Submit a job for each id, of the client that its first letter names."""

    async def submit() -> None:
        store = FullRedisStore(AsyncRedis.from_url(url), entries=9, max_age=60)
        for id_ in ids:
            await store.submit(job(id_, client=id_[0]), queue=99, share=1.0)
        await store.close()

    asyncio.run(submit())


def finished(id_: str) -> Record:
    return record(id_)


@settings(max_examples=third(30), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(events=EVENTS)
@example("aaa.b.-.c..")
@example("aab..b--.a.")
def test_turns_follow_the_policy(redis: Redis, events: str) -> None:
    worker, running, turns = Worker(redis.url, "host:1:aa"), list[str](), ""
    with redis_client.Redis.from_url(redis.url) as connection:
        connection.flushall()
    for number, event in enumerate(events):
        if event == "-":
            for id_ in running[:1]:
                worker.finish(finished(id_))
            del running[:1]
        elif event != ".":
            submitted(redis.url, f"{event}{number}")
        elif id_ := worker.begin(f"turn {number}"):
            running.append(id_)
            turns += id_[0]
    assert turns == clients_by_policy(events)


def test_turns_of_many_clients_take_little_memory(redis: Redis, connection: Any) -> None:
    connection.zadd("paretour:turns", {f"client {number}": number for number in range(3000)})
    connection.set("paretour:turn", 3000)
    submitted(redis.url, "a1")
    assert Worker(redis.url, "host:1:aa").begin("a1") == "a1"
    assert connection.zcard("paretour:turns") == 1000
    assert connection.zscore("paretour:turns", "a") == 3001


def test_a_record_that_was_handed_back_is_next(redis: Redis) -> None:
    submitted(redis.url, "a1", "b1")
    one, other = Worker(redis.url, "host:1:aa"), Worker(redis.url, "host:2:bb")
    assert one.begin("a1") == "a1"
    one.hand_back("a1")
    assert [other.begin(each) for each in ("a1", "b1")] == ["a1", "b1"]


def test_a_message_whose_worker_is_lost_is_of_the_record_that_it_had(
    redis: Redis, connection: Any
) -> None:
    submitted(redis.url, "a1", "a2", "b1")
    one, other = Worker(redis.url, "host:1:aa"), Worker(redis.url, "host:2:bb")
    assert one.begin("a1") == "a1"
    assert one.begin("a2") == "b1"
    # Not the record it is named for, which waits, but the one that was under way.
    assert other.begin("a2", known_lost=True) == "b1"
    assert connection.hget("paretour:front:b1", "attempts") == b"2"
    assert connection.get("paretour:lost") == b"1"
    # The worker of a1 is there: this is a turn like any other.
    assert other.begin("b1", known_lost=True) == "a2"
    assert other.begin("b1", known_lost=False) is None


def test_a_record_that_nobody_was_seen_at_for_a_while_is_begun_again(
    redis: Redis, connection: Any
) -> None:
    submitted(redis.url, "a1", "b1")
    worker = Worker(redis.url, "host:1:aa")
    assert [worker.begin(each) for each in ("b1", "a1")] == ["a1", "b1"]
    connection.hincrbyfloat("paretour:front:b1", "seen", -LEASE - 1)
    assert worker.begin("b1") == "b1"  # sent again by its own name
    assert worker.begin("b1") is None


def test_what_ended_while_it_waited_takes_no_turn(redis: Redis) -> None:
    submitted(redis.url, "a1", "a2", "b1")
    worker = Worker(redis.url, "host:1:aa")
    worker.finish(finished("a1"))
    assert [worker.begin(each) for each in ("a1", "a2", "b1")] == ["a2", "b1", None]


def test_jobs_that_name_no_client_take_turns_by_their_callers(redis: Redis) -> None:
    async def put() -> None:
        store = FullRedisStore(AsyncRedis.from_url(redis.url), entries=9, max_age=60)
        await store.put(job("old", caller="us"))
        await store.close()

    submitted(redis.url, "a1", "a2")
    asyncio.run(put())
    worker = Worker(redis.url, "host:1:aa")
    assert [worker.begin(each) for each in ("a1", "a2", "old")] == ["a1", "old", "a2"]


def test_what_a_worker_finishes_keeps_its_task_unless_it_failed(redis: Redis) -> None:
    worker = Worker(redis.url, "host:1:aa")
    submitted(redis.url, "a", "b")
    for id_, status in (("a", "done"), ("b", "failed")):
        assert worker.begin(id_) == id_
        worker.finish(record(id_, status=status))

    async def tasks() -> list[Any]:
        store = FullRedisStore(AsyncRedis.from_url(redis.url), entries=9, max_age=60)
        found = [await store.task(record(id_)) for id_ in "ab"]
        await store.close()
        return found

    assert asyncio.run(tasks()) == [job("a").task, None]
