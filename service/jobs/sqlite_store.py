"""The store in SQLite: in a file, which outlives the process, or in memory."""

import asyncio
import logging
import sqlite3
from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from time import time
from typing import TypeVar

from service.errors import Expired, IdempotencyMismatch, NotFound, StoreUnavailable
from service.jobs.listing import ListedFront
from service.jobs.outbox import Delivery
from service.jobs.record import Record
from service.jobs.sqlite_outbox import SqliteOutbox
from service.jobs.sqlite_schema import IN_MEMORY, UNFINISHED, copy_file, open_file
from service.jobs.store import (
    COLUMNS,
    SHORT,
    STORE_BYTES,
    TASK_COLUMNS,
    TASK_SHARE,
    UnreadableRecord,
    listed_from,
    log_dropped,
    record_columns,
    record_from,
    record_size,
    task_from,
)

__all__ = ["IN_MEMORY", "SqliteStore"]

T = TypeVar("T")
_COLUMNS = ", ".join(COLUMNS)
# The task of a finished record is not read with it: it may be long.
_READ = ", ".join(
    f"CASE WHEN {UNFINISHED} THEN {name} END" if name in TASK_COLUMNS else name for name in COLUMNS
)
_AT_ONCE = 16  # records that are written together
_SLACK = 16  # records may exceed the limits by a sixteenth until some are read
_LOG = logging.getLogger("paretour")

_FINISHED = f"NOT {UNFINISHED}"
_SUMS = f"SELECT count(*), total(size), min(kept), max(size) FROM front WHERE {_FINISHED}"
_PAGE = """
SELECT number, kept, id, status, members FROM front
WHERE caller = ? AND client = ? AND number < ? ORDER BY number DESC LIMIT ?
"""
# The records dropped by dropping the oldest of the client with most again and again.
_FIRST_OUT = f"""
SELECT number FROM (
    SELECT number, row_number() OVER (PARTITION BY client ORDER BY number DESC) AS place
    FROM front WHERE {_FINISHED}
) ORDER BY place DESC, number LIMIT ?
"""
# The oldest of the client that takes most bytes; if nobody has two, of those with one.
_LARGEST_OUT = f"""
SELECT min(number) FROM front WHERE {_FINISHED} GROUP BY client
ORDER BY count(*) > 1 DESC, sum(size) DESC, min(number) LIMIT 1
"""


class SqliteStore:
    """Keeps at most `entries` finished records of `max_bytes`, none older than `max_age` seconds.

    Of the records that were dropped it remembers the last `tombstones` ids. The file belongs to one
    process at a time.

    Raises:
        ValueError: The file cannot be opened, another process has it, or it is of a later release.
    """

    def __init__(
        self,
        path: str,
        *,
        entries: int,
        max_age: float,
        max_bytes: int = STORE_BYTES,
        tombstones: int = 10_000,
        clock: Callable[[], float] = time,
    ) -> None:
        self._path = path
        self._entries = entries
        self._max_age = max_age
        self._max_bytes = max_bytes
        self._tombstones = tombstones
        self._clock = clock
        # All calls that touch the file are made in this thread, in their order.
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="store")
        # Short records that are not yet written, with the time when they were put. Nothing in
        # memory can be lost by that, and writing many at once takes less time for each.
        self._unwritten: deque[tuple[float, Record]] = deque()
        self._most_unwritten = _AT_ONCE if path == IN_MEMORY else 0
        self._puts = self._bytes_put = 0  # since records were last evicted
        try:
            self._database = open_file(path)
            self._outbox = SqliteOutbox(self._database)
        except (OSError, ValueError, sqlite3.Error) as error:
            raise ValueError(
                f"the store must be a file of its own, {path} is not: {error}"
            ) from error

    async def put(self, record: Record) -> None:
        """Store a record, in place of an earlier one with its id."""
        if len(self._unwritten) < self._most_unwritten and _is_short(record):
            self._unwritten.append((self._clock(), record))
        else:
            await self._in_thread(self._put, record, self._clock())

    async def admit(self, record: Record) -> Record:
        """Store a new record and return it, or return the one that has its idempotency key.

        A failed record loses its key, so that a repeat is a new try.

        Raises:
            IdempotencyMismatch: The caller used the key for another body.
        """
        return await self._in_thread(self._admit, record)

    async def repeated(self, record: Record) -> Record | None:
        """Return the record that has the idempotency key of this one, if one has and succeeded.

        Raises:
            IdempotencyMismatch: The caller used the key for another body.
        """
        return await self._in_thread(self._repeated, record)

    async def get(self, caller: str, id: str) -> Record:
        """Return the caller's record with this id."""
        return await self._found("caller = ? AND id = ?", caller, id)

    async def task(self, record: Record) -> bytes | None:
        """Return the task of a finished record; None if it is not kept."""
        return await self._in_thread(self._task, record.id)

    async def latest(self, caller: str, client: str) -> Record:
        """Return the caller's record that was finished last for this client."""
        return await self._found("caller = ? AND client = ?", caller, client, among=_FINISHED)

    async def fronts(self, caller: str, client: str, below: int, most: int) -> list[ListedFront]:
        """Return the caller's newest records for this client, as `Store.fronts` does."""
        return await self._in_thread(self._fronts, caller, client, below, most)

    async def delete(self, record: Record) -> None:
        """Delete a record, and leave no trace of it."""
        await self._in_thread(self._delete, record.id)

    async def unfinished(self) -> list[Record]:
        """Return all unfinished records with their tasks, the oldest first."""
        return await self._in_thread(self._select, f"{UNFINISHED} ORDER BY number")

    async def due_deliveries(self, most: int, seconds: float) -> list[Delivery]:
        """Take deliveries that are due; after some seconds they are due again."""
        return await self._in_thread(self._outbox.take, most, self._clock(), seconds)

    async def postpone(self, id: str, seconds: float) -> None:
        """Have the delivery of a job tried again after some seconds."""
        await self._in_thread(self._outbox.postpone, id, self._clock() + seconds)

    async def remove_delivery(self, id: str) -> None:
        """Remove the delivery of a job."""
        await self._in_thread(self._outbox.remove, id)

    async def back_up(self) -> None:
        """Copy the file to one beside it, `.backup` behind its name, in place of an earlier copy.

        What is asked of the store meanwhile waits. An error is logged.
        """
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._thread, self._back_up)

    async def close(self) -> None:
        """Close the file."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._thread, self._database.close)
        self._thread.shutdown()

    async def _found(self, where: str, *values: str, among: str = "TRUE") -> Record:
        found = await self._in_thread(self._newest, where, among, *values)
        if isinstance(found, Record):
            return found
        raise found

    async def _in_thread(self, act: Callable[..., T], *arguments: object) -> T:
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(
            self._thread, partial(self._in_transaction, act, *arguments)
        )

    def _in_transaction(self, act: Callable[..., T], *arguments: object) -> T:
        """Run an action on the file as one transaction, and return its result.

        Raises:
            StoreUnavailable: The file cannot be read or written, mostly because the disk is full.
        """
        try:
            self._write_unwritten()  # in a transaction of its own: the action may fail
            with self._database:
                return act(*arguments)
        except sqlite3.Error as error:
            _LOG.error("the file of the store cannot be used: %s", error)
            raise StoreUnavailable from error

    def _back_up(self) -> None:
        try:
            copy_file(self._database, self._path)
        except (OSError, ValueError, sqlite3.Error) as error:
            _LOG.error("the store cannot be backed up: %s", error)
        else:
            _LOG.info("the store is backed up to %s.backup", self._path)

    def _write_unwritten(self) -> None:
        """Write the records put before; skip one that cannot be encoded."""
        unwritten = list(self._unwritten)
        with self._database:
            for kept, record in unwritten:
                try:
                    self._put(record, kept)
                except sqlite3.Error:
                    raise
                except Exception as error:
                    _LOG.error("front %s cannot be stored", record.id, exc_info=error)
        for _ in unwritten:
            self._unwritten.popleft()

    def _put(self, record: Record, kept: float) -> None:
        self._delete(record.id)
        columns = record_columns(record)
        task_size = record_size({name: columns[name] for name in TASK_COLUMNS})
        if record.finished and task_size > self._max_bytes // TASK_SHARE:
            columns |= dict.fromkeys(TASK_COLUMNS)
        webhook = record.webhook
        if record.finished and webhook is not None:
            self._outbox.add(record.id, webhook, record.status, kept)
            webhook = None
        places = ", ".join("?" * (len(columns) + 4))
        insert = f"INSERT INTO front (kept, size, client, webhook, {_COLUMNS}) VALUES ({places})"
        beside = (
            *(kept, record_size(columns), record.client or record.caller),
            webhook and webhook.json(),
        )
        self._database.execute(insert, (*beside, *columns.values()))
        self._puts += 1
        self._bytes_put += beside[1]
        if self._puts > self._entries // _SLACK or self._bytes_put > self._max_bytes // _SLACK:
            self._evict()

    def _admit(self, record: Record) -> Record:
        self._evict()
        if earlier := self._repeated(record):
            return earlier
        for failed in self._with_key_of(record):
            self._put(replace(failed, key=None), self._clock())
        self._put(record, self._clock())
        return record

    def _repeated(self, record: Record) -> Record | None:
        for earlier in self._with_key_of(record):
            if earlier.digest != record.digest:
                raise IdempotencyMismatch
            if earlier.status != "failed":
                return earlier
        return None

    def _with_key_of(self, record: Record) -> list[Record]:
        if record.key is None:
            return []
        return self._select("caller = ? AND key = ?", record.caller, record.key)

    def _newest(self, where: str, among: str, *values: str) -> Record | type[LookupError]:
        """Return the newest record, or the error to raise once the transaction is done."""
        self._evict()
        newest = f"{where} AND {among} ORDER BY number DESC LIMIT 1"
        count = f"SELECT count(*) FROM front WHERE {where} AND {among}"
        while self._database.execute(count, values).fetchone() != (0,):
            for record in self._select(newest, *values):
                return record
        known = self._database.execute(f"SELECT 1 FROM gone WHERE {where}", values).fetchone()
        return Expired if known else NotFound

    def _fronts(self, *bounds: str | int) -> list[ListedFront]:
        """Return a page of records; those that cannot be read are dropped."""
        self._evict()
        found, damaged = [], []
        for number, kept, id_, status, members in self._database.execute(_PAGE, bounds):
            try:
                found.append(listed_from(number, kept, id_, status, members))
            except UnreadableRecord as error:
                log_dropped(str(id_)[:80], error)
                damaged.append(number)
        for number in damaged:
            self._drop("number = ?", number)
        return self._fronts(*bounds) if damaged else found

    def _select(self, where: str, *values: str) -> list[Record]:
        """Return the records that can be read; the others are dropped."""
        query = f"SELECT number, client, webhook, {_READ} FROM front WHERE {where}"
        rows = self._database.execute(query, values).fetchall()
        found = (
            self._read(number, client, webhook, dict(zip(COLUMNS, row, strict=True)))
            for number, client, webhook, *row in rows
        )
        return [record for record in found if record is not None]

    def _read(
        self, number: int, client: str, webhook: str | None, columns: dict[str, object]
    ) -> Record | None:
        try:
            record = replace(record_from(columns, webhook), client=client)
            if not record.finished and record.task is None:
                raise UnreadableRecord("it is unfinished, and what to plan is missing")
        except UnreadableRecord as error:
            log_dropped(str(columns["id"])[:80], error)
            self._drop("number = ?", number)
            return None
        return record

    def _task(self, id: str) -> bytes | None:
        query = f"SELECT {', '.join(TASK_COLUMNS)} FROM front WHERE id = ?"
        row = self._database.execute(query, (id,)).fetchone()
        return task_from(dict(zip(TASK_COLUMNS, row, strict=True))) if row else None

    def _delete(self, id: str) -> None:
        self._database.execute("DELETE FROM front WHERE id = ?", (id,))

    def _evict(self) -> None:
        """Drop finished records that are too old, too many or too large."""
        self._puts = self._bytes_put = 0
        oldest = self._clock() - self._max_age
        while True:
            count, size, first, longest = self._database.execute(_SUMS).fetchone()
            if count and (first < oldest or longest > self._max_bytes):
                self._drop(f"{_FINISHED} AND (kept < ? OR size > ?)", oldest, self._max_bytes)
            elif count > self._entries:
                self._drop(f"number IN ({_FIRST_OUT})", count - self._entries)
            elif size > self._max_bytes:
                self._drop(f"number = ({_LARGEST_OUT})")
            else:
                return

    def _drop(self, where: str, *values: float) -> None:
        """Delete records, but remember that they were there."""
        bury = (
            "INSERT INTO gone (id, caller, client)"
            f" SELECT id, caller, client FROM front WHERE {where}"
        )
        if self._database.execute(bury, values).rowcount:
            self._database.execute(f"DELETE FROM front WHERE {where}", values)
            forget = "DELETE FROM gone WHERE number <= (SELECT max(number) FROM gone) - ?"
            self._database.execute(forget, (self._tombstones,))


def _is_short(record: Record) -> bool:
    """Return whether a record is short enough to be written later, with others."""
    return len(record.task or b"") + len(record.front.tours) <= SHORT
