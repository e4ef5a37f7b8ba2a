"""The store in Redis, shared by all replicas."""

import asyncio
from collections.abc import Callable, Sequence
from time import time
from typing import Any

from redis.asyncio import Redis

from service.cluster.records import (
    Argument,
    StoredRecord,
    delivery_from,
    listed_front,
    record_arguments,
    stored_task,
)
from service.cluster.script import RecordScript
from service.errors import Expired, IdempotencyMismatch, NotFound, NoWorker, QueueFull, ShareFull
from service.jobs.listing import ListedFront
from service.jobs.outbox import Delivery
from service.jobs.record import Record
from service.jobs.store import STORE_BYTES, UnreadableRecord, log_dropped

NOBODY = "none of the cluster was there in the last 5 s"


class RedisStore(RecordScript):
    """Keeps at most `entries` finished records of `max_bytes`, none older than `max_age` seconds.

    Of those that were dropped it remembers the last `tombstones` ids.
    """

    def __init__(
        self,
        redis: Redis,
        *,
        entries: int,
        max_age: float,
        max_bytes: int = STORE_BYTES,
        tombstones: int = 10_000,
        clock: Callable[[], float] = time,
    ) -> None:
        super().__init__(redis, clock)
        self._bounds = (max_age, entries, tombstones, max_bytes)

    async def submit(self, record: Record, queue: int, share: float, waits: bool = False) -> Record:
        """Admit a record if there is a place for it; a repeat needs none.

        Args:
            queue: How many records may be unfinished in addition to one for each worker.
            share: The share of all of these that one client may hold.
            waits: Whether the client waits for the front, so that a worker must run now.

        Raises:
            NoWorker: The client waits, and no worker runs.
            QueueFull: No place is left.
            ShareFull: The client holds its share of the places.
            IdempotencyMismatch: The caller used the key for another body.
            StoreUnavailable: Redis does not answer.
        """
        await self._evict()
        place = (queue, share, record.client or record.caller, "waits" if waits else "")
        arguments = (*place, *_identity(record), *record_arguments(record))
        return await self._earlier(record.caller, "submit", *arguments) or record

    async def check_place(self, client: str, queue: int, share: float) -> None:
        """Raise QueueFull or ShareFull when no place is left for one more record of a client."""
        _check_reply(await self.call("check_place", queue, share, client))

    async def get(self, caller: str, id: str) -> Record:
        """Return the caller's record with this id."""
        return (await self.find("get", caller, id)).record

    async def task(self, record: Record) -> bytes | None:
        """Return the task of a finished record; None if it is not kept."""
        return stored_task(await self.call("source", record.id))

    async def latest(self, caller: str, client: str) -> Record:
        """Return the caller's record that was finished last for this client."""
        return (await self.find("latest", caller, client)).record

    async def fronts(self, caller: str, client: str, below: int, most: int) -> list[ListedFront]:
        """Return the caller's newest records for this client, as `Store.fronts` does."""
        await self._evict()
        while True:
            rows = await self.call("page", caller, client, below, most)
            # One by one, because the members of a record may be long.
            found = [listed for row in rows if (listed := await self._listed(caller, row))]
            if len(found) == len(rows):
                return found

    async def delete(self, record: Record) -> None:
        """Delete a record, and leave no trace of it."""
        await self.call("forget", record.id)

    async def check_ready(self) -> None:
        """Raise StoreUnavailable if Redis accepts no more data, NoWorker if no worker runs."""
        if await self.call("write") == 0:
            raise NoWorker(NOBODY)

    async def due_deliveries(self, most: int, seconds: float) -> list[Delivery]:
        """Take deliveries that are due; after some seconds they are due again."""
        found = []
        for parts in await self.call("due_deliveries", most, seconds):
            try:
                found.append(delivery_from(parts))
            except UnreadableRecord as error:
                log_dropped(parts[0].decode(errors="replace")[:80], error)
                await self.call("remove_delivery", parts[0])
        return found

    async def postpone(self, id: str, seconds: float) -> None:
        """Have the delivery of a job tried again after some seconds."""
        await self.call("postpone", id, seconds)

    async def remove_delivery(self, id: str) -> None:
        """Remove the delivery of a job."""
        await self.call("remove_delivery", id)

    async def find(self, verb: str, *arguments: str) -> StoredRecord:
        """Return the record that the verb `get` or `latest` finds.

        Raises:
            NotFound: There never was one, or it was deleted.
            Expired: It was dropped.
            StoreUnavailable: Redis does not answer.
        """
        await self._evict()
        while True:
            match await self.call(verb, *arguments):
                case b"unknown":
                    raise NotFound
                case b"expired":
                    raise Expired
                case [id_, *hashes]:
                    stored = await self.read(id_, *hashes, caller=arguments[0])
                    if stored is not None:
                        return stored

    async def _listed(self, caller: str, row: Sequence[bytes]) -> ListedFront | None:
        """Return what a list says of a record; None if it is gone, or damaged and dropped now."""
        id_ = row[0]
        members = await self.call("members", id_)
        if members is None:
            return None
        try:
            return await asyncio.to_thread(listed_front, row, members)
        except UnreadableRecord as error:
            log_dropped(id_.decode(errors="replace")[:80], error)
            await self.call("drop", id_, caller)
            return None

    async def _earlier(self, caller: str, verb: str, *arguments: Argument) -> Record | None:
        """Return the earlier record that an admission finds, if there is one that can be read."""
        while True:
            reply = await self.call(verb, *arguments)
            if reply == b"new":
                return None
            _check_reply(reply)
            id_, *hashes = reply
            if (stored := await self.read(id_, *hashes, caller=caller)) is not None:
                return stored.record

    async def _evict(self) -> None:
        await self.call("make_way", *self._bounds)


def _identity(record: Record) -> tuple[str, str, str, str]:
    return record.id, record.caller, record.key or "", record.digest


def _check_reply(reply: Any) -> None:
    """Raise a refusal if the reply to an admission is one; see `RedisStore.submit`."""
    match reply:
        case b"mismatch":
            raise IdempotencyMismatch
        case b"full":
            raise QueueFull
        case b"alone":
            raise NoWorker(NOBODY)
        case int(places):
            raise ShareFull(places)
