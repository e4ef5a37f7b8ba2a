"""The store in Redis, which all replicas share."""

from collections.abc import Callable
from time import time
from typing import Any

from redis.asyncio import Redis

from service.cluster.records import GONE, SCRIPT, Argument, StoredRecord, arguments, kept_in
from service.errors import Expired, IdempotencyMismatch, NotFound, StoreUnavailable
from service.jobs.record import Record


class RedisStore:
    """At most `entries` finished records, none older than `max_age` seconds.

    Of what has made way it remembers the last `tombstones` ids. A record that it gives comes
    without its work, which only `unfinished` adds.
    """

    def __init__(
        self,
        redis: Redis,
        *,
        entries: int,
        max_age: float,
        tombstones: int = 10_000,
        clock: Callable[[], float] = time,
    ) -> None:
        self._redis = redis
        self._script = redis.register_script(SCRIPT)
        self._bounds = (max_age, entries, tombstones)
        self._clock = clock

    async def put(self, record: Record) -> None:
        """Keep a record, in place of an earlier one with its id."""
        await self.call("put", record.id, *arguments(record))
        await self._make_way()

    async def admit(self, record: Record) -> Record:
        """Keep a new record, or give the one that the caller has already under its key."""
        await self._make_way()
        about = (record.id, record.caller, record.key or "", record.digest)
        match await self.call("admit", *about, *arguments(record)):
            case b"new":
                return record
            case b"mismatch":
                raise IdempotencyMismatch
            case earlier:
                return kept_in(earlier).record

    async def get(self, caller: str, id: str) -> Record:  # noqa: A002
        """The caller's record with this id."""
        return (await self.kept("get", caller, id)).record

    async def latest(self, caller: str) -> Record:
        """The caller's record that was finished last."""
        return (await self.kept("latest", caller)).record

    async def forget(self, record: Record) -> None:
        """Keep the record no longer, and nothing in its place."""
        await self.call("forget", record.id)

    async def unfinished(self) -> list[Record]:
        """All records that still need work, the oldest first."""
        return [kept_in(*hashes).record for hashes in await self.call("unfinished")]

    async def close(self) -> None:
        """Let go of the connections."""
        await self._redis.aclose()

    async def call(self, verb: str, *about: Argument) -> Any:
        """What the script answers.

        Raises:
            StoreUnavailable: Redis does not.
        """
        try:
            return await self._script(args=[verb, self._clock(), *about])
        except GONE as error:
            raise StoreUnavailable from error

    async def kept(self, verb: str, *about: str) -> StoredRecord:
        """What is kept, as `get` or `latest` finds it."""
        await self._make_way()
        match await self.call(verb, *about):
            case b"unknown":
                raise NotFound
            case b"expired":
                raise Expired
            case found:
                return kept_in(found)

    async def _make_way(self) -> None:
        await self.call("make_way", *self._bounds)
