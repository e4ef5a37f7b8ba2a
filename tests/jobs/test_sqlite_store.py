"""The store in a file: it outlives the process, and the release."""

import asyncio
import json
import resource
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from service.errors import Expired, NotFound, StoreUnavailable
from service.jobs.sqlite_store import IN_MEMORY, SqliteStore
from service.kinds.parsing import parse_replan
from service.kinds.table import kind_of
from service.requests.limits import Limits
from service.requests.replan.way import ReplanSource, StoredFront
from service.requests.task_codec import decode_task
from tests.helpers.actors import info_of
from tests.helpers.stores import job, record
from tests.helpers.version_before import ANSWERS, CALLER, NOW, UNFINISHED, write_store

LIMITS = Limits(body_bytes=2**20, cities=50, cells=100, preferences=99, size=99, seconds=99)
INFOS = {kind: info_of(kind, kind) for kind in ("coordinates", "matrices")}


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


def test_without_keys_the_records_of_one_address_leave_those_of_another(tmp_path: Path) -> None:
    path = str(tmp_path / "fronts.sqlite")

    async def test() -> None:
        store = SqliteStore(path, entries=4, max_age=60)
        await store.admit(record("a", client="192.0.2.1", key="k", digest="1"))
        await store.admit(job("b", client="192.0.2.1"))
        for id_ in map(str, range(9)):
            await store.put(record(id_, client="192.0.2.2"))
        assert (await store.get("us", "a")).client == "192.0.2.1"
        assert (await store.admit(job("c", key="k", digest="1"))).id == "a"
        await store.close()
        again = SqliteStore(path, entries=4, max_age=60)
        [unfinished] = await again.unfinished()
        assert unfinished.client == "192.0.2.1"
        await again.put(record("b", client=unfinished.client))
        assert (await again.latest("us", "192.0.2.1")).id == "b"
        for id_ in ("a", "7", "8"):
            assert (await again.get("us", id_)).id == id_
        await again.close()

    asyncio.run(test())


@contextmanager
def full_disk() -> Iterator[None]:
    """Let no file of this process grow until the block ends."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_store_whose_disk_is_full_is_unavailable_until_there_is_room(tmp_path: Path) -> None:
    async def test() -> None:
        store = SqliteStore(str(tmp_path / "fronts.sqlite"), entries=9, max_age=60)
        await store.put(record("a"))
        with full_disk():
            for change in (
                store.put(record("b")),
                store.admit(job("c")),
                store.delete(record("a")),
            ):
                with pytest.raises(StoreUnavailable):
                    await change
            assert (await store.get("us", "a")).json() == record("a").json()
        await store.delete(record("a"))
        with pytest.raises(NotFound):
            await store.get("us", "a")
        await store.close()

    asyncio.run(test())


def test_fronts_of_the_version_before_are_answered_and_replanned(tmp_path: Path) -> None:
    path = write_store(tmp_path / "fronts.sqlite")

    async def test() -> None:
        store = SqliteStore(str(path), entries=99, max_age=60, clock=lambda: NOW)
        for id_, answer in ANSWERS.items():
            stored = await store.get(CALLER, id_)
            assert json.loads(stored.json()) == answer
            task = await store.task(stored)
            assert task is not None
            if answer["kind"] != "robots":
                changes = b'{"now": 26000}' if id_ in ("day", "fleet") else b"{}"
                asked = ReplanSource(changes, StoredFront(id_, task, stored.front))
                assert kind_of(parse_replan(asked, LIMITS, INFOS)).name == answer["kind"]
        [waiting] = await store.unfinished()
        assert waiting.id == UNFINISHED
        assert waiting.task is not None
        assert decode_task(waiting.task).options.time_limit == 60
        await store.close()

    asyncio.run(test())


@pytest.mark.parametrize(
    "damage",
    [
        "members = '{'",
        "members = '[]'",
        "tours = x'00'",
        "ends = x'00'",
        "members = json_set(CAST(members AS TEXT), '$.lengths', json('[]'))",
        "problem = x'ff'",
        "status = 'lost'",
        "kind = 'front', body = NULL, members = NULL",
        "caller = 'us', digest = 7",
        "request_id = CAST(x'ff' AS TEXT), members = ''",
    ],
)
def test_a_record_that_cannot_be_read_is_dropped_and_logged_once(
    tmp_path: Path, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    path = str(tmp_path / "fronts.sqlite")

    async def test() -> None:
        store = SqliteStore(path, entries=9, max_age=60)
        for each in (record("a"), record("b"), job("c"), job("d", key="k", digest="1")):
            await store.put(each)
        await store.close()
        with closing(sqlite3.connect(path)) as database:
            database.execute(f"UPDATE front SET {damage} WHERE id IN ('b', 'd')")
            database.commit()
        again = SqliteStore(path, entries=9, max_age=60)
        assert [each.id for each in await again.unfinished()] == ["c"]
        assert (await again.latest("us", "us")).id == "a"
        for _ in range(2):
            for id_ in "bd":
                with pytest.raises(Expired):
                    await again.get("us", id_)
        assert (await again.admit(job("e", key="k", digest="1"))).id == "e"
        await again.close()

    asyncio.run(test())
    said = sorted(entry.getMessage() for entry in caplog.records)
    assert [line[:37] for line in said] == [
        f"front {id_} cannot be read and is dropped" for id_ in "bd"
    ]


def test_unfinished_work_without_a_body_is_dropped(tmp_path: Path) -> None:
    path = str(tmp_path / "fronts.sqlite")

    async def test() -> None:
        store = SqliteStore(path, entries=9, max_age=60)
        await store.put(job("a"))
        await store.put(job("b", task=None))
        assert [each.id for each in await store.unfinished()] == ["a"]
        await store.close()

    asyncio.run(test())


def test_in_memory_every_record_is_found_however_many_came_at_once() -> None:
    async def test() -> None:
        store = SqliteStore(IN_MEMORY, entries=100, max_age=60)
        for number in range(50):
            await store.put(record(str(number)))
        assert (await store.latest("us", "us")).id == "49"
        for number in range(50):
            assert (await store.get("us", str(number))).id == str(number)
        await store.close()

    asyncio.run(test())


def test_in_memory_a_record_that_cannot_be_encoded_keeps_no_other_from_being_read(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def test() -> None:
        store = SqliteStore(IN_MEMORY, entries=9, max_age=60)
        await store.put(record("a"))
        await store.put(record("b", problem={"unknown": object()}))
        await store.put(record("c"))
        assert [(await store.get("us", id_)).id for id_ in ("a", "c")] == ["a", "c"]
        with pytest.raises(NotFound):
            await store.get("us", "b")
        await store.close()

    asyncio.run(test())
    assert "front b cannot be stored" in caplog.text
