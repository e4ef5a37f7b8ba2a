"""Which records have changed, as workers and replicas tell one another."""

import asyncio
from asyncio import Event
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from redis.asyncio import Redis

from service.cluster.records import GONE
from service.jobs.record import UNFINISHED

CHANNEL = "paretour:told"
_PAUSE = 0.2  # seconds between two tries to listen
_SILENT = 5.0  # seconds without news after which it is tried whether any could come


class Subscriptions:
    """Wakes up who waits for a record, whenever that has changed, or may have.

    `ended` is told of each that is finished.
    """

    def __init__(self, redis: Redis, ended: Callable[[str], None]) -> None:
        self._redis = redis
        self._ended = ended
        self._waiting: dict[str, set[Event]] = defaultdict(set)

    @contextmanager
    def about(self, id: str) -> Iterator[Event]:  # noqa: A002
        """An event that is set with each change of a record."""
        changed = Event()
        self._waiting[id].add(changed)
        try:
            yield changed
        finally:
            self._waiting[id].discard(changed)
            if not self._waiting[id]:
                del self._waiting[id]

    async def listen(self) -> None:
        """Listen until cancelled."""
        while True:
            try:
                await self._listen()
            except GONE:
                await asyncio.sleep(_PAUSE)

    async def _listen(self) -> None:
        async with self._redis.pubsub() as channel:
            await channel.subscribe(CHANNEL)
            # What was said meanwhile, nobody has heard.
            for id_ in list(self._waiting):
                self._wake(id_)
            while True:
                message = await channel.get_message(timeout=_SILENT)
                if message is None:
                    await channel.ping()  # which fails, once there is nobody to hear from
                elif message["type"] == "message":
                    self._hear(*message["data"].decode().split(":"))

    def _hear(self, id: str, status: str) -> None:  # noqa: A002
        if status not in UNFINISHED:
            self._ended(id)
        self._wake(id)

    def _wake(self, id: str) -> None:  # noqa: A002
        for changed in self._waiting.get(id, ()):
            changed.set()
