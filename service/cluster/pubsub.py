"""Notifications of changed records, over a channel of Redis."""

import asyncio
from asyncio import Event
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from redis.asyncio import Redis

from service.cluster.script import CHANNEL, UNAVAILABLE
from service.jobs.record import UNFINISHED

_PAUSE = 0.2  # seconds between two tries to listen
_SILENT = 5.0  # seconds without a message after which the connection is tested


class Subscriptions:
    """Sets the events of waiting tasks whenever their record has changed, or may have changed.

    `on_finished` is called with the id of each record that is finished.
    """

    def __init__(self, redis: Redis, on_finished: Callable[[str], None]) -> None:
        self._redis = redis
        self._on_finished = on_finished
        self._waiting: dict[str, set[Event]] = defaultdict(set)

    @contextmanager
    def changes(self, id: str) -> Iterator[Event]:  # noqa: A002
        """Return an event that is set at each change of a record."""
        changed = Event()
        self._waiting[id].add(changed)
        try:
            yield changed
        finally:
            self._waiting[id].discard(changed)
            if not self._waiting[id]:
                del self._waiting[id]

    async def listen(self) -> None:
        """Receive notifications, until the task is cancelled."""
        while True:
            try:
                await self._listen()
            except UNAVAILABLE:
                await asyncio.sleep(_PAUSE)

    async def _listen(self) -> None:
        async with self._redis.pubsub() as channel:
            await channel.subscribe(CHANNEL)
            # Messages that were sent before the subscription are lost.
            for id_ in list(self._waiting):
                self._wake(id_)
            while True:
                message = await channel.get_message(timeout=_SILENT)
                if message is None:
                    await channel.ping()  # which raises where the connection is lost
                elif message["type"] == "message":
                    id_, _, status = message["data"].decode(errors="replace").partition(":")
                    self._handle(id_, status)

    def _handle(self, id: str, status: str) -> None:  # noqa: A002
        if status not in UNFINISHED:
            self._on_finished(id)
        self._wake(id)

    def _wake(self, id: str) -> None:  # noqa: A002
        for changed in self._waiting.get(id, ()):
            changed.set()
