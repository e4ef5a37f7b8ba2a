"""The engine of a replica: fronts are planned by whichever worker of the cluster is free."""

import asyncio
import logging
from asyncio import Event, Future
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import suppress
from dataclasses import replace
from functools import partial
from time import time

from redis.asyncio import Redis
from redis.backoff import NoBackoff
from redis.retry import Retry

from service.cluster.celery_app import QUEUE, queue_at, send
from service.cluster.pubsub import Subscriptions
from service.cluster.records import LEASE, STOP_REASONS, StoredRecord, arguments, kept_in
from service.cluster.redis_store import RedisStore
from service.errors import (
    Cancelled,
    DeadlineExceeded,
    Expired,
    NotFound,
    QueueFull,
    ShuttingDown,
    StoreUnavailable,
)
from service.jobs.engine import EngineStats, JobState, finished
from service.jobs.front_document import FrontDocument
from service.jobs.record import Record, as_planned, ended

_AGAIN = 2.0  # seconds without news after which a record is looked at all the same
_LISTENED = 1.0  # seconds for a worker to end what it is told to end
_SWEEP = 2.0  # seconds between two looks for work that has lost its worker or its message


class RedisEngine:
    """Hands the ids of records to `send`, and follows in Redis what becomes of them.

    So many may wait beside those that there are workers for. Nobody waits for more than so many
    seconds. Of each front `planned` is told in one of all replicas.
    """

    def __init__(
        self,
        redis: Redis,
        store: RedisStore,
        send: Callable[[str], None],
        *,
        queue: int,
        seconds: float,
        planned: Callable[[FrontDocument], None] = lambda _: None,
    ) -> None:
        self._store = store
        self._send = send
        self._queue = queue
        self._seconds = seconds
        self._planned = planned
        self._news = Subscriptions(redis, self._ended)
        self._tasks: set[asyncio.Task[None]] = set()
        self._standing = EngineStats(waiting=0, working=0, lost=0)
        self._closed = False
        self._log = logging.getLogger("paretour")

    async def start(self) -> None:
        """Listen, and look after what is unfinished, whoever began it."""
        for work in (self._news.listen(), self._sweep()):
            self._spawn(work)

    async def close(self) -> None:
        """Take no more work. What is unfinished goes on."""
        self._closed = True
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def standing(self) -> EngineStats:
        """How all replicas and workers are together, as last known."""
        with suppress(StoreUnavailable):
            waiting, working, lost = await self._store.call("standing")
            self._standing = EngineStats(waiting=waiting, working=working, lost=lost)
        return self._standing

    async def check_open(self) -> None:
        """Nothing, if work is taken."""
        if self._closed:
            raise ShuttingDown

    async def check_place(self) -> None:
        """Nothing, if there is a place for one more front."""
        if not await self._store.call("has_place", self._queue):
            raise QueueFull

    async def check_warm(self) -> None:
        """Nothing: workers take no work before they are warm, and until then it waits."""

    async def check_ready(self) -> None:
        """Nothing, if work is taken: Redis answers."""
        await self.check_open()
        await self._store.call("standing")

    async def run(self, record: Record, left: Future[None]) -> Record:
        """What becomes of work that somebody waits for, until he has left."""
        await self._store.admit(record)
        try:
            await self.begin(record)
        except Exception:
            await self._store.forget(record)
            raise
        ending = asyncio.ensure_future(finished(self, record))
        try:
            await asyncio.wait(
                (ending, left), timeout=self._seconds, return_when=asyncio.FIRST_COMPLETED
            )
            if not ending.done():
                await self._stop(record, Cancelled if left.done() else DeadlineExceeded)
            record = await ending
        finally:
            ending.cancel()
        if record.status == "failed":
            await self._store.forget(record)
        return record

    async def begin(self, record: Record) -> None:
        """Begin the work of a record that is in the store, whoever waits."""
        await self.check_open()
        if not await self._store.call("has_place", self._queue, record.id):
            raise QueueFull
        await self._have_done(record.id)

    def state(self, record: Record) -> JobState:
        """How a record from the store stands."""
        return JobState(record)

    async def watch(self, record: Record) -> AsyncIterator[JobState]:
        """How it stands now, and after each change, until it is finished."""
        told = None
        with self._news.about(record.id) as changed:
            while True:
                changed.clear()
                with suppress(StoreUnavailable):
                    kept = await self._now(record)
                    record, progress = kept.record, kept.progress
                    standing = record.status, progress and progress.seconds
                    if standing != told:
                        told = standing
                        yield JobState(record, progress)
                if record.finished:
                    return
                await _within(_AGAIN, changed)

    async def cancel(self, record: Record) -> Record:
        """End the work of a record at once; what was found so far is kept."""
        await self._stop(record, Cancelled)
        return await finished(self, record)

    async def _now(self, record: Record) -> StoredRecord:
        """How it stands in Redis; once it is forgotten, as if it had been cancelled."""
        try:
            return await self._store.kept("get", record.caller, record.id)
        except (NotFound, Expired):
            gone = replace(record, status="cancelled", work=None)
            return StoredRecord(record=gone, asked=0, attempts=0, progress=None)

    async def _stop(self, record: Record, why: type[Cancelled | DeadlineExceeded]) -> None:
        """Have the worker end it, if it has one that listens, and end it anyway."""
        await self._store.call("stop", record.id, STOP_REASONS[why])
        if (await self._now(record)).record.status == "running":
            with suppress(TimeoutError):
                async with asyncio.timeout(_LISTENED):
                    await finished(self, record)
        kept = await self._now(record)
        if not kept.record.finished:
            over = ended(kept.record, kept.record.front, why, time() - kept.asked)
            await self._store.call("finish", record.id, *arguments(over))

    async def _have_done(self, id: str) -> None:  # noqa: A002
        await asyncio.to_thread(self._send, id)

    async def _sweep(self) -> None:
        while True:
            with suppress(StoreUnavailable):
                for id_ in await self._store.call("stale", LEASE, QUEUE):
                    self._log.warning("front %s has lost its worker, sent again", id_.decode())
                    await self._have_done(id_.decode())
            await asyncio.sleep(_SWEEP)

    def _ended(self, id: str) -> None:  # noqa: A002
        self._spawn(self._count(id))

    async def _count(self, id: str) -> None:  # noqa: A002
        with suppress(StoreUnavailable):
            if found := await self._store.call("claim", id):
                self._planned(as_planned(kept_in(found).record.front))

    def _spawn(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


async def _within(seconds: float, changed: Event) -> None:
    with suppress(TimeoutError):
        async with asyncio.timeout(seconds):
            await changed.wait()


_SECONDS = 2.0  # that one answer of Redis may take


def replica(
    redis_url: str,
    *,
    entries: int,
    max_age: float,
    queue: int,
    seconds: float,
    planned: Callable[[FrontDocument], None] = lambda _: None,
) -> tuple[RedisStore, RedisEngine]:
    """What all replicas at this Redis do alike."""
    # Tried once more, because a connection may be of a Redis that has been replaced.
    redis = Redis.from_url(
        redis_url, retry=Retry(NoBackoff(), 1), socket_timeout=_SECONDS, socket_keepalive=True
    )
    store = RedisStore(redis, entries=entries, max_age=max_age)
    sending = partial(send, queue_at(redis_url, seconds))
    return store, RedisEngine(redis, store, sending, queue=queue, seconds=seconds, planned=planned)
