"""The store in a file, so that it outlives the process, or in memory: SQLite either way."""

import asyncio
import sqlite3
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import time
from typing import TypeVar

from service.errors import Expired, IdempotencyMismatch, NotFound
from service.jobs.record import Record
from service.jobs.store import COLUMNS, columns, record_of

T = TypeVar("T")
IN_MEMORY = ":memory:"
_COLUMNS = ", ".join(COLUMNS)
_UNFINISHED = "status IN ('queued', 'running')"
_SCHEMA = f"""
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
CREATE TABLE IF NOT EXISTS front (number INTEGER PRIMARY KEY, kept REAL, {_COLUMNS});
CREATE UNIQUE INDEX IF NOT EXISTS by_id ON front (id);
CREATE UNIQUE INDEX IF NOT EXISTS by_key ON front (caller, key) WHERE key IS NOT NULL;
CREATE INDEX IF NOT EXISTS by_caller ON front (caller, number);
CREATE INDEX IF NOT EXISTS finished ON front (number, kept) WHERE NOT {_UNFINISHED};
CREATE TABLE IF NOT EXISTS gone (number INTEGER PRIMARY KEY, id, caller);
CREATE INDEX IF NOT EXISTS gone_by_id ON gone (id);
"""
_MADE_WAY = f"""
SELECT id, caller FROM front WHERE NOT {_UNFINISHED} AND (kept < ? OR number <= (
    SELECT number FROM front WHERE NOT {_UNFINISHED} ORDER BY number DESC LIMIT 1 OFFSET ?
))
"""


class SqliteStore:
    """At most `entries` finished records, none older than `max_age` seconds.

    Of what has made way it remembers the last `tombstones` ids. The file belongs to one process.

    Raises:
        ValueError: the file cannot be opened, or another process has it.
    """

    def __init__(
        self,
        path: str,
        *,
        entries: int,
        max_age: float,
        tombstones: int = 10_000,
        clock: Callable[[], float] = time,
    ) -> None:
        self._entries = entries
        self._max_age = max_age
        self._tombstones = tombstones
        self._clock = clock
        # All that touches the file happens in one thread, in the order in which it was asked for.
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="store")
        try:
            self._database = _opened(path)
        except (OSError, sqlite3.Error) as error:
            raise ValueError(
                f"the store must be a file of its own, {path} is not: {error}"
            ) from error

    async def put(self, record: Record) -> None:
        """Keep a record, in place of an earlier one with its id."""
        await self._do(self._put, record)

    async def admit(self, record: Record) -> Record:
        """Keep a new record, or give the one that the caller has already under its key."""
        return await self._do(self._admit, record)

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """The caller's record with this id."""
        return await self._do(self._one, "caller = ? AND id = ?", caller, id)

    async def latest(self, caller: str) -> Record:
        """The caller's record that was finished last."""
        return await self._do(self._one, f"caller = ? AND NOT {_UNFINISHED}", caller)

    async def forget(self, record: Record) -> None:
        """Keep the record no longer, and nothing in its place."""
        await self._do(self._delete, record.id)

    async def unfinished(self) -> list[Record]:
        """All records that still need work, the oldest first."""
        return await self._do(self._all, _UNFINISHED)

    async def close(self) -> None:
        """Let go of the file."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._thread, self._database.close)
        self._thread.shutdown()

    async def _do(self, act: Callable[..., T], *arguments: object) -> T:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, partial(self._at_once, act, *arguments))

    def _at_once(self, act: Callable[..., T], *arguments: object) -> T:
        with self._database:
            return act(*arguments)

    def _put(self, record: Record) -> None:
        self._delete(record.id)
        values = columns(record).values()
        places = ", ".join("?" * (len(values) + 1))
        insert = f"INSERT INTO front (kept, {_COLUMNS}) VALUES ({places})"
        self._database.execute(insert, (self._clock(), *values))
        self._make_way()

    def _admit(self, record: Record) -> Record:
        self._make_way()
        if record.key is not None:
            for kept in self._all("caller = ? AND key = ?", record.caller, record.key):
                if kept.digest != record.digest:
                    raise IdempotencyMismatch
                if kept.status != "failed":
                    return kept
                self._put(replace(kept, key=None))
        self._put(record)
        return record

    def _one(self, where: str, caller: str, *values: str) -> Record:
        self._make_way()
        for record in self._all(f"{where} ORDER BY number DESC LIMIT 1", caller, *values):
            return record
        gone = "SELECT 1 FROM gone WHERE caller = ?" + (" AND id = ?" if values else "")
        known = self._database.execute(gone, (caller, *values)).fetchone()
        raise Expired if known else NotFound

    def _all(self, where: str, *values: str) -> list[Record]:
        rows = self._database.execute(f"SELECT {_COLUMNS} FROM front WHERE {where}", values)
        return [record_of(dict(zip(COLUMNS, row, strict=True))) for row in rows]

    def _delete(self, id: str) -> None:  # noqa: A002
        self._database.execute("DELETE FROM front WHERE id = ?", (id,))

    def _make_way(self) -> None:
        oldest = self._clock() - self._max_age
        made_way = self._database.execute(_MADE_WAY, (oldest, self._entries)).fetchall()
        if not made_way:
            return
        for id_, caller in made_way:
            self._database.execute("INSERT INTO gone (id, caller) VALUES (?, ?)", (id_, caller))
            self._delete(id_)
        few = "DELETE FROM gone WHERE number <= (SELECT max(number) FROM gone) - ?"
        self._database.execute(few, (self._tombstones,))


def _opened(path: str) -> sqlite3.Connection:
    if path != IN_MEMORY:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    database = sqlite3.connect(path, check_same_thread=False, timeout=1)
    database.executescript(_SCHEMA)
    return database
