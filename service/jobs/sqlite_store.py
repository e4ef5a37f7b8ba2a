"""The store in SQLite: in a file, which outlives the process, or in memory."""

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
from service.jobs.store import COLUMNS, record_columns, record_from

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
_EVICTABLE = f"""
SELECT id, caller FROM front WHERE NOT {_UNFINISHED} AND (kept < ? OR number <= (
    SELECT number FROM front WHERE NOT {_UNFINISHED} ORDER BY number DESC LIMIT 1 OFFSET ?
))
"""


class SqliteStore:
    """Keeps at most `entries` finished records, none older than `max_age` seconds.

    Of those that were dropped it remembers the last `tombstones` ids. The file belongs to one
    process at a time.

    Raises:
        ValueError: The file cannot be opened, or another process has it.
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
        # All calls that touch the file are made in this thread, in their order.
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="store")
        try:
            self._database = _open(path)
        except (OSError, sqlite3.Error) as error:
            raise ValueError(
                f"the store must be a file of its own, {path} is not: {error}"
            ) from error

    async def put(self, record: Record) -> None:
        """Store a record, in place of an earlier one with its id."""
        await self._in_thread(self._put, record)

    async def admit(self, record: Record) -> Record:
        """Store a new record and return it, or return the one that has its idempotency key."""
        return await self._in_thread(self._admit, record)

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """Return the caller's record with this id."""
        return await self._in_thread(self._newest, "caller = ? AND id = ?", caller, id)

    async def latest(self, caller: str) -> Record:
        """Return the caller's record that was finished last."""
        return await self._in_thread(self._newest, f"caller = ? AND NOT {_UNFINISHED}", caller)

    async def delete(self, record: Record) -> None:
        """Delete a record, and leave no trace of it."""
        await self._in_thread(self._delete, record.id)

    async def unfinished(self) -> list[Record]:
        """Return all unfinished records with their sources, the oldest first."""
        return await self._in_thread(self._select, _UNFINISHED)

    async def close(self) -> None:
        """Close the file."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._thread, self._database.close)
        self._thread.shutdown()

    async def _in_thread(self, act: Callable[..., T], *arguments: object) -> T:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(
            self._thread, partial(self._in_transaction, act, *arguments)
        )

    def _in_transaction(self, act: Callable[..., T], *arguments: object) -> T:
        with self._database:
            return act(*arguments)

    def _put(self, record: Record) -> None:
        self._delete(record.id)
        values = record_columns(record).values()
        places = ", ".join("?" * (len(values) + 1))
        insert = f"INSERT INTO front (kept, {_COLUMNS}) VALUES ({places})"
        self._database.execute(insert, (self._clock(), *values))
        self._evict()

    def _admit(self, record: Record) -> Record:
        self._evict()
        if record.key is not None:
            for earlier in self._select("caller = ? AND key = ?", record.caller, record.key):
                if earlier.digest != record.digest:
                    raise IdempotencyMismatch
                if earlier.status != "failed":
                    return earlier
                self._put(replace(earlier, key=None))
        self._put(record)
        return record

    def _newest(self, where: str, caller: str, *values: str) -> Record:
        self._evict()
        for record in self._select(f"{where} ORDER BY number DESC LIMIT 1", caller, *values):
            return record
        gone = "SELECT 1 FROM gone WHERE caller = ?" + (" AND id = ?" if values else "")
        known = self._database.execute(gone, (caller, *values)).fetchone()
        raise Expired if known else NotFound

    def _select(self, where: str, *values: str) -> list[Record]:
        rows = self._database.execute(f"SELECT {_COLUMNS} FROM front WHERE {where}", values)
        return [record_from(dict(zip(COLUMNS, row, strict=True))) for row in rows]

    def _delete(self, id: str) -> None:  # noqa: A002
        self._database.execute("DELETE FROM front WHERE id = ?", (id,))

    def _evict(self) -> None:
        oldest = self._clock() - self._max_age
        evicted = self._database.execute(_EVICTABLE, (oldest, self._entries)).fetchall()
        if not evicted:
            return
        for id_, caller in evicted:
            self._database.execute("INSERT INTO gone (id, caller) VALUES (?, ?)", (id_, caller))
            self._delete(id_)
        forget = "DELETE FROM gone WHERE number <= (SELECT max(number) FROM gone) - ?"
        self._database.execute(forget, (self._tombstones,))


def _open(path: str) -> sqlite3.Connection:
    if path != IN_MEMORY:
        Path(path).parent.mkdir(parents=True, exist_ok=True)
    database = sqlite3.connect(path, check_same_thread=False, timeout=1)
    database.executescript(_SCHEMA)
    return database
