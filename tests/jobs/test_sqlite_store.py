"""The store in a file: it outlives the process, and the release."""

import asyncio
import json
import sqlite3
from pathlib import Path

import pytest

from service.jobs.sqlite_store import SqliteStore
from service.requests.task import TaskSource
from tests.helpers.released_records import ANSWERS, SQLITE_ROWS, SQLITE_SCHEMA
from tests.helpers.stores import job, record


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


def test_a_file_of_the_last_release_is_read(tmp_path: Path) -> None:
    path = tmp_path / "fronts.sqlite"
    with sqlite3.connect(path) as database:
        database.executescript(SQLITE_SCHEMA)
        for row in SQLITE_ROWS:
            places = ", ".join("?" * len(row))
            database.execute(f"INSERT INTO front VALUES ({places})", tuple(row.values()))
    database.close()

    async def test() -> None:
        store = SqliteStore(str(path), entries=9, max_age=60, clock=lambda: 1001.0)
        done = await store.get("us", "done")
        assert done.json() == ANSWERS["done"]
        assert json.loads(done.front.nearest(20))["tour"] == [0, 2, 1]
        for id_ in ("waiting", "lost"):
            stored = await store.get("us", id_)
            assert json.loads(stored.json()) == json.loads(ANSWERS[id_])
        [waiting] = await store.unfinished()
        assert waiting.source == TaskSource("coverage", b'{"cell_size": 1}', b"\x89PNG")
        await store.close()

    asyncio.run(test())
