"""The store in Redis: it may be away, and other releases share it."""

import asyncio
import json
import sqlite3
from dataclasses import replace
from pathlib import Path

import pytest
import redis as redis_client
from redis.asyncio import Redis as AsyncRedis

from service.cluster.redis_engine import connect
from service.cluster.script import connect_redis, wait_for_redis
from service.cluster.worker_store import WorkerStore
from service.errors import Expired, StoreUnavailable
from service.requests.task_codec import decode_task
from tests.helpers.ports import free_port
from tests.helpers.redis_server import FORGETFUL, Redis, redis_server
from tests.helpers.stores import FullRedisStore, Worker, job, record, redis_store
from tests.helpers.version_before import ANSWERS, CALLER, NOW, UNFINISHED, write_store


def test_a_store_that_does_not_answer_is_unavailable(tmp_path: Path) -> None:
    async def test() -> None:
        with redis_server(tmp_path) as redis:
            async with redis_store(redis.url, entries=1, max_age=1) as store:
                redis.end()
                with pytest.raises(StoreUnavailable):
                    await store.get("us", "a")

    asyncio.run(test())


def test_records_of_the_version_before_are_read(redis: Redis, tmp_path: Path) -> None:
    database = sqlite3.connect(write_store(tmp_path / "fronts.sqlite"))
    database.row_factory = sqlite3.Row
    rows = [dict(row) for row in database.execute("SELECT * FROM front")]
    database.close()

    async def test() -> None:
        connection = AsyncRedis.from_url(redis.url)
        await connection.flushall()
        for row in rows:
            id_, number = row["id"], row["number"]
            given = {name: value for name, value in row.items() if value is not None}
            work = {name: given.pop(name) for name in ("kind", "body")}
            await connection.hset(f"paretour:front:{id_}", mapping=given)
            await connection.hset(f"paretour:work:{id_}", mapping=work)
            those = "unfinished" if id_ == UNFINISHED else "finished"
            await connection.zadd(f"paretour:{those}", {id_: number})
        store = FullRedisStore(connection, entries=99, max_age=60, clock=lambda: NOW)
        for id_, answer in ANSWERS.items():
            stored = await store.get(CALLER, id_)
            assert json.loads(stored.json()) == answer
            decode_task(await store.task(stored) or b"")
        [waiting] = await store.unfinished()
        decode_task(waiting.task or b"")
        await store.close()

    asyncio.run(test())


DAMAGE = [
    {"members": b"{"},
    {"members": b"[]"},
    {"tours": b"?"},
    {"ends": b"?"},
    {"problem": b"\xff"},
    {"request_id": b"\xff"},
    {"status": b"lost"},
    {"kept": b"yesterday"},
    {"gained": b"much"},
    {"attempts": b"few"},
    {"progress": b"[1]"},
    {"size": b"large", "members": b""},
]


@pytest.mark.parametrize("damage", DAMAGE, ids=str)
def test_a_record_that_cannot_be_read_is_dropped_and_logged_once(
    redis: Redis, damage: dict[str, bytes], caplog: pytest.LogCaptureFixture
) -> None:
    async def test() -> None:
        async with redis_store(redis.url, entries=9, max_age=60) as store:
            for each in (record("a"), record("b"), job("c"), job("d", key="k", digest="1")):
                await store.put(each)
            connection = AsyncRedis.from_url(redis.url)
            for id_ in "bd":
                await connection.hset(f"paretour:front:{id_}", mapping=damage)
            await connection.aclose()
            assert [each.id for each in await store.unfinished()] == ["c"]
            assert (await store.latest("us", "us")).id == "a"
            for _ in range(2):
                for id_ in "bd":
                    with pytest.raises(Expired):
                        await store.get("us", id_)
            assert (await store.admit(job("e", key="k", digest="1"))).id == "e"

    asyncio.run(test())
    said = [entry.getMessage() for entry in caplog.records]
    # One that is older than any clock is as gone as the others.
    dropped = {line[:37] for line in said}
    assert dropped <= {f"front {id_} cannot be read and is dropped" for id_ in "bd"}
    assert "front d cannot be read and is dropped" in dropped or damage == {"status": b"lost"}
    assert len(said) == len(dropped)


def test_a_list_leaves_out_what_cannot_be_read_and_drops_it(
    redis: Redis, caplog: pytest.LogCaptureFixture
) -> None:
    async def test() -> None:
        async with redis_store(redis.url, entries=9, max_age=60) as store, asyncio.timeout(60):
            for id_ in "abc":
                await store.put(record(id_))
            connection = AsyncRedis.from_url(redis.url)
            await connection.hset("paretour:front:b", "members", b"{")
            await connection.aclose()
            for _ in range(2):
                listed = await store.fronts("us", "us", below=2**53, most=9)
                assert [each.id for each in listed] == ["c", "a"]
            with pytest.raises(Expired):
                await store.get("us", "b")

    asyncio.run(test())
    [said] = [entry.getMessage() for entry in caplog.records]
    assert said.startswith("front b cannot be read and is dropped")


def test_a_worker_drops_a_record_that_it_cannot_read_and_whoever_waits_is_told(
    redis: Redis, caplog: pytest.LogCaptureFixture
) -> None:
    async def put() -> None:
        async with redis_store(redis.url, entries=9, max_age=60) as store:
            await store.put(job("a"))
            await store.put(job("b", task=None))

    asyncio.run(put())
    connection = redis_client.Redis.from_url(redis.url)
    connection.hset("paretour:front:a", "members", b"{")
    with connection.pubsub() as channel:
        channel.subscribe("paretour:told")
        channel.get_message(timeout=1)
        worker = Worker(redis.url, "host:1:aa")
        for id_ in "ab":
            assert worker.begin(id_, known_lost=False) is None
            assert worker.begin(id_, known_lost=True) is None
        told = [channel.get_message(timeout=60)["data"] for _ in range(4)]
    assert told == [b"a:running", b"a:failed", b"b:running", b"b:failed"]
    assert connection.zcard("paretour:unfinished") == 0
    assert len(caplog.records) == 2
    connection.close()


def test_without_keys_the_records_of_one_address_leave_those_of_another(redis: Redis) -> None:
    async def test() -> None:
        async with redis_store(redis.url, entries=4, max_age=60) as store:
            await store.put(record("a", client="192.0.2.1"))
            await store.put(job("b", client="192.0.2.1"))
            for id_ in map(str, range(9)):
                await store.put(record(id_, client="192.0.2.2"))
            assert (await store.get("us", "a")).client == "192.0.2.1"
            worker = WorkerStore(connect_redis(redis.url), "host:1:aa")
            begun = await worker.begin("b", known_lost=False)
            await worker.close()
            assert begun is not None
            assert begun.record.client == "192.0.2.1"
            await store.put(replace(begun.record, status="done", task=None))
            for id_ in ("a", "b", "7", "8"):
                assert (await store.get("us", id_)).id == id_
            for id_ in map(str, range(7)):
                with pytest.raises(Expired):
                    await store.get("us", id_)
            assert (await store.latest("us", "192.0.2.1")).id == "b"

    asyncio.run(test())


def test_a_redis_that_takes_no_more_is_unavailable(tmp_path: Path) -> None:
    async def test() -> None:
        with redis_server(tmp_path) as redis:
            store, engine = connect(redis.url, entries=9, max_age=60, queue=1, seconds=60)
            await store.submit(record("a"), queue=1, share=1.0)
            connection = redis_client.Redis.from_url(redis.url)
            worker = WorkerStore(connect_redis(redis.url), "a worker")
            await worker.send_heartbeat()
            await worker.close()
            for refuse, accept in (
                (("maxmemory", 1), ("maxmemory", 0)),
                (("min-replicas-to-write", 1), ("min-replicas-to-write", 0)),
            ):
                connection.config_set(*refuse)
                with pytest.raises(StoreUnavailable):
                    await engine.check_ready()
                connection.config_set(*accept)
                await engine.check_ready()
            connection.replicaof("127.0.0.1", 1)
            with pytest.raises(StoreUnavailable):
                await engine.check_ready()
            connection.close()
            await store.close()

    asyncio.run(test())


def test_a_worker_counts_as_alive_for_five_seconds_after_its_last_sign(redis: Redis) -> None:
    seconds = iter([100.0, 104.0, 106.0])

    async def count() -> list[int]:
        async with redis_store(
            redis.url, entries=9, max_age=60, clock=lambda: next(seconds)
        ) as store:
            await store.call("present", "machine:1")
            return [(await store.call("standing"))[3] for _ in range(2)]

    assert asyncio.run(count()) == [1, 0]


def test_a_redis_that_is_not_there_is_named_at_the_start_without_its_password(
    redis: Redis, tmp_path: Path
) -> None:
    wait_for_redis(redis.url)
    url = f"redis://:sesame@127.0.0.1:{free_port()}/0"
    with pytest.raises(ValueError, match=r"the Redis at 127\.0\.0\.1:\d+ must answer") as absent:
        wait_for_redis(url, seconds=0.1)
    assert "sesame" not in str(absent.value)
    with redis_server(tmp_path, (*FORGETFUL, "--requirepass", "right")) as locked:
        with pytest.raises(ValueError, match="must accept us"):
            wait_for_redis(locked.url.replace("//", "//:wrong@"))
        wait_for_redis(locked.url.replace("//", "//:right@"))
