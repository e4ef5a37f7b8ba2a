"""The script of all records in Redis. Each call happens for everybody at once, or not at all."""

import json
import logging
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from time import sleep, time
from typing import Any
from urllib.parse import urlsplit

from redis import Redis as BlockingRedis
from redis import exceptions
from redis.asyncio import Redis
from redis.backoff import NoBackoff
from redis.exceptions import ResponseError
from redis.retry import Retry

from service.cluster.records import Argument, StoredRecord, stored_record
from service.errors import StoreUnavailable
from service.errors.printable import printable
from service.jobs.store import UnreadableRecord, log_dropped

SCRIPT = "".join(
    (Path(__file__).parent / name).read_text(encoding="utf-8")
    for name in ("stored_records.lua", "records.lua")
)
LEASE = 5.0  # seconds without a sign of life after which a worker is lost
CHANNEL = "paretour:told"  # where the script publishes "id:status" after each change
# Redis does not answer, is full, or is a read-only replica.
UNAVAILABLE = (
    exceptions.ConnectionError,
    exceptions.TimeoutError,
    exceptions.OutOfMemoryError,
    exceptions.ReadOnlyError,
)
# How errors begin where Redis cannot write to its disk, or to enough copies.
_REFUSES_WRITES = ("MISCONF", "NOREPLICAS")
# The script's error where a key holds foreign data, with the name of that key in JSON.
_DAMAGED = re.compile(r'damaged ("(?:[^"\\]|\\.)*")')
_SECONDS = 2.0  # the longest that one reply of Redis may take
_PATIENCE = 10.0  # seconds in which Redis must answer at the start
_PAUSE = 0.2  # seconds between two tries


def connect_redis(url: str) -> Redis:
    """Return the connections to this Redis."""
    # Tried once more, because the connection may be to a Redis that was restarted.
    retry = Retry(NoBackoff(), 1)
    return Redis.from_url(url, retry=retry, socket_timeout=_SECONDS, socket_keepalive=True)


def wait_for_redis(url: str, seconds: float = _PATIENCE) -> None:
    """Wait until Redis answers: it may be starting too.

    Raises:
        ValueError: It does not answer in time, or refuses the password.
    """
    ends = time() + seconds
    redis = BlockingRedis.from_url(url, socket_timeout=_SECONDS, socket_connect_timeout=_SECONDS)
    with redis:
        while True:
            try:
                redis.ping()
            except (exceptions.AuthenticationError, ResponseError) as error:
                raise _unusable(url, "must accept us", error) from None
            except exceptions.BusyLoadingError:
                return  # it is there, and soon ready
            except UNAVAILABLE as error:
                if time() > ends:
                    raise _unusable(url, f"must answer in {seconds:g} s", error) from None
            else:
                return
            sleep(_PAUSE)


def _unusable(url: str, demand: str, error: Exception) -> ValueError:
    parts = urlsplit(url)
    where = f"{parts.hostname}:{parts.port or 6379}"
    return ValueError(f"PARETOUR_REDIS_URL: the Redis at {where} {demand}: {error}")


class RecordScript:
    """The script at a Redis. Its verbs are in `records.lua`."""

    def __init__(self, redis: Redis, clock: Callable[[], float] = time) -> None:
        self._redis = redis
        self._clock = clock
        self._script = redis.register_script(SCRIPT)

    async def call(self, verb: str, *arguments: Argument) -> Any:
        """Run a verb of the script and return its reply.

        Raises:
            StoreUnavailable: Redis does not answer, or takes no more data where the verb writes.
        """
        try:
            return await self._script(args=[verb, self._clock(), *arguments])
        except UNAVAILABLE as error:
            raise StoreUnavailable from error
        except ResponseError as error:
            if not str(error).startswith(_REFUSES_WRITES):
                await self._repair(error)
            raise StoreUnavailable from error

    async def read(
        self, id: bytes, *hashes: Iterable[bytes], caller: str = "", whole: bool = False
    ) -> StoredRecord | None:
        """Return the record in these hashes; if it cannot be read, drop it and return None.

        Args:
            id: Its id, which may be missing in the hashes.
            hashes: The fields and values that HGETALL gives.
            caller: Its caller, if known.
            whole: Whether an unfinished record must have its task.
        """
        try:
            stored = stored_record(*hashes)
            if whole and stored.record.task is None:
                raise UnreadableRecord("what to plan is missing")
        except UnreadableRecord as error:
            log_dropped(id.decode(errors="replace")[:80], error)
            await self.call("drop", id, *([caller] if caller else []))
            return None
        return stored

    async def close(self) -> None:
        """Close the connections."""
        await self._redis.aclose()

    async def _repair(self, error: ResponseError) -> None:
        """Put the key aside at which the script failed; raise the error if it names none."""
        found = _DAMAGED.search(str(error))
        if found is None:
            raise error
        key = json.loads(found[1])
        logging.getLogger("paretour").error(
            "key %s of Redis is damaged, put aside as paretour:damaged and made anew: %s",
            printable(key)[:200],
            error,
        )
        await self._script(args=["repair", self._clock(), key])
