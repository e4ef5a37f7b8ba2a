"""The engine of a cluster: jobs are planned by workers on any machine, by way of Redis."""

import asyncio
import logging
from asyncio import Event, Future
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import suppress
from functools import partial
from time import time
from weakref import WeakValueDictionary

from redis.asyncio import Redis

from service.cluster.celery_app import QUEUE, make_celery, send_record
from service.cluster.records import STOP_REASONS, StoredRecord, record_arguments
from service.cluster.redis_store import RedisStore
from service.cluster.script import CHANNEL, LEASE, UNAVAILABLE, connect_redis
from service.errors import (
    Cancelled,
    DeadlineExceeded,
    Expired,
    NotFound,
    ShuttingDown,
    StoreUnavailable,
)
from service.jobs.cancelling import cancel_all
from service.jobs.deadline import Deadline
from service.jobs.engine import EngineStats, JobState, final_record
from service.jobs.record import UNFINISHED, Record, StopReason, as_ended, as_failed
from service.jobs.store import STORE_BYTES
from service.kinds.front_document import FrontDocument
from service.kinds.parts import Compiling
from service.requests.task import Task

_POLL = 2.0  # seconds without a notification after which a record is read all the same
_GRACE = 1.0  # seconds for a worker to stop by itself
_LISTEN_PAUSE = 0.2  # seconds between two tries to listen
_SILENT = 5.0  # seconds without a message after which the connection is tested
_SWEEP = 2.0  # seconds between two searches for jobs that lost their worker or message


class Subscriptions:
    """Tells those who wait when a record has changed, or may have changed.

    `on_finished` is called with the id of each record that is finished.
    """

    def __init__(self, redis: Redis, on_finished: Callable[[str], None]) -> None:
        self._redis = redis
        self._on_finished = on_finished
        self._changes = WeakValueDictionary[str, Event]()  # while somebody has them

    def next_change(self, id: str) -> Event:
        """Return an event that is set at the next change of a record."""
        return self._changes.setdefault(id, Event())

    async def listen(self) -> None:
        """Receive notifications, until the task is cancelled."""
        while True:
            try:
                await self._listen()
            except UNAVAILABLE:
                await asyncio.sleep(_LISTEN_PAUSE)

    async def _listen(self) -> None:
        async with self._redis.pubsub() as channel:
            await channel.subscribe(CHANNEL)
            # Messages that were sent before the subscription are lost.
            for id_ in list(self._changes):
                self._wake(id_)
            while True:
                message = await channel.get_message(timeout=_SILENT)
                if message is None:
                    await channel.ping()  # which raises where the connection is lost
                elif message["type"] == "message":
                    id_, _, status = message["data"].decode(errors="replace").partition(":")
                    self._handle(id_, status)

    def _handle(self, id: str, status: str) -> None:
        if status not in UNFINISHED:
            self._on_finished(id)
        self._wake(id)

    def _wake(self, id: str) -> None:
        if changed := self._changes.pop(id, None):
            changed.set()


class RedisEngine:
    """Sends the ids of records to workers, and follows the records in Redis.

    Args:
        redis: The connections for notifications.
        send: Called with the id of each record to plan, in a thread.
        queue: How many jobs may wait in addition to one for each worker.
        share: The share of all of these that one client may hold. It may always hold one more than
            there are workers.
        on_front: Called with every front that was planned, by one of the replicas.
    """

    def __init__(
        self,
        redis: Redis,
        store: RedisStore,
        send: Callable[[str], None],
        *,
        queue: int,
        share: float = 1.0,
        on_front: Callable[[FrontDocument], None] = lambda _: None,
    ) -> None:
        self._store = store
        self._send = send
        self._queue = queue
        self._share = share
        self._on_front = on_front
        self._subscriptions = Subscriptions(redis, lambda id_: self._spawn(self._claim(id_)))
        self._tasks: set[asyncio.Task[None]] = set()
        self._stats = EngineStats(waiting=0, working=0, lost=0, workers=0)
        self._closed = False
        self._log = logging.getLogger("paretour")

    async def start(self) -> None:
        """Listen for changes, and send unfinished jobs again that lost their worker."""
        self._spawn(self._subscriptions.listen())
        self._spawn(self._sweep())

    async def close(self) -> None:
        """Take no more jobs. Unfinished ones go on in the workers."""
        self._closed = True
        await cancel_all(self._tasks)

    async def stats(self) -> EngineStats:
        """Return the numbers of the whole cluster, as last known."""
        with suppress(StoreUnavailable):
            waiting, working, lost, workers = await self._store.call("standing")
            self._stats = EngineStats(waiting=waiting, working=working, lost=lost, workers=workers)
        return self._stats

    async def check_open(self) -> None:
        """Raise ShuttingDown when no more jobs are taken."""
        if self._closed:
            raise ShuttingDown

    async def check_place(self, client: str) -> None:
        """Raise QueueFull or ShareFull when no place is left for one more job of a client."""
        await self._store.check_place(client, self._queue, self._share)

    @property
    def compiling(self) -> Compiling | None:
        """None: workers compile, on other machines."""
        return None

    async def check_ready(self) -> None:
        """Raise ShuttingDown, NoWorker, or StoreUnavailable if Redis does not answer or is full."""
        await self.check_open()
        await self._store.check_ready()

    async def run(
        self,
        record: Record,
        task: Task,  # noqa: ARG002  # a worker reads it from the record
        disconnected: Future[None],
        deadline: Deadline,
    ) -> Record:
        """Run a new job while its client waits; when that disconnects, cancel it."""
        await self._submit(record, waits=True)
        ending = asyncio.ensure_future(final_record(self, record))
        try:
            await asyncio.wait(
                (ending, disconnected), timeout=deadline.left(), return_when=asyncio.FIRST_COMPLETED
            )
            if not ending.done():
                reason = Cancelled if disconnected.done() else DeadlineExceeded
                await self._stop(record, reason)
            record = await ending
        finally:
            ending.cancel()
        if record.status == "failed":
            await self._store.delete(record)
        return record

    async def submit(self, record: Record, task: Task) -> Record:  # noqa: ARG002  # as of run
        """Store and begin a job at once, or return the earlier one that it is a repeat of."""
        return await self._submit(record, waits=False)

    async def _submit(self, record: Record, waits: bool) -> Record:
        await self.check_open()
        first = await self._store.submit(record, self._queue, self._share, waits)
        if first.id == record.id:
            try:
                await asyncio.to_thread(self._send, record.id)
            except Exception:
                await self._store.delete(record)
                await self._store.call("messages", QUEUE)  # which repairs them, if that is why
                raise
        return first

    def state(self, record: Record) -> JobState:
        """Return the present state of a job, given its record in the store."""
        return JobState(record)

    async def release(self, record: Record) -> None:
        """Return at once: the task of a job is in Redis."""

    async def watch(self, record: Record) -> AsyncIterator[JobState]:
        """Yield the state of a job now and after each change, until it is finished."""
        last = None
        while True:
            changed = self._subscriptions.next_change(record.id)
            with suppress(StoreUnavailable):
                stored = await self._stored(record)
                record = stored.record
                if (record.status, stored.progress) != last:
                    last = record.status, stored.progress
                    yield stored
            if record.finished:
                return
            with suppress(TimeoutError):
                await asyncio.wait_for(changed.wait(), _POLL)

    async def cancel(self, record: Record) -> Record:
        """End a job at once, with what was found so far, and return its final record."""
        await self._stop(record, Cancelled)
        return await final_record(self, record)

    async def _stored(self, record: Record) -> StoredRecord:
        """Return the record in Redis; if it was deleted there, a failed one."""
        try:
            return await self._store.find("get", record.caller, record.id)
        except (NotFound, Expired):
            deleted = as_failed(record, Cancelled(), record.front)
            return StoredRecord(deleted, requested_at=0, attempts=0)

    async def _stop(self, record: Record, reason: StopReason) -> None:
        """Ask the worker to end a job; if it does not in time, end the job here."""
        await self._store.call("stop", record.id, STOP_REASONS[reason])
        if (await self._stored(record)).record.status == "running":
            with suppress(TimeoutError):
                async with asyncio.timeout(_GRACE):
                    await final_record(self, record)
        stored = await self._stored(record)
        if not stored.record.finished:
            seconds = time() - stored.requested_at
            ended = as_ended(stored.record, stored.record.front, reason, seconds)
            await self._store.call("finish", record.id, *record_arguments(ended))

    async def _sweep(self) -> None:
        while True:
            try:
                await self._send_stale()
            except StoreUnavailable:
                pass
            except Exception:
                # Otherwise nothing would ever be sent again.
                self._log.exception("jobs that lost their worker could not be sent again")
            await asyncio.sleep(_SWEEP)

    async def _send_stale(self) -> None:
        for id_ in await self._store.call("stale", LEASE, QUEUE):
            name = id_.decode(errors="replace")
            self._log.warning("front %s has lost its worker, sent again", name[:80])
            await asyncio.to_thread(self._send, name)

    async def _claim(self, id: str) -> None:
        """Pass a finished front on, unless another replica has."""
        with suppress(StoreUnavailable):
            fields = await self._store.call("claim", id)
            if fields and (stored := await self._store.read(id.encode(), fields)) is not None:
                self._on_front(stored.record.front)

    def _spawn(self, coroutine: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)


def connect(  # noqa: PLR0913  a setting each
    redis_url: str,
    *,
    entries: int,
    max_age: float,
    max_bytes: int = STORE_BYTES,
    queue: int,
    share: float = 1.0,
    seconds: float,
    on_front: Callable[[FrontDocument], None] = lambda _: None,
) -> tuple[RedisStore, RedisEngine]:
    """Return the store and the engine of a replica at this Redis."""
    redis = connect_redis(redis_url)
    store = RedisStore(redis, entries=entries, max_age=max_age, max_bytes=max_bytes)
    send = partial(send_record, make_celery(redis_url, seconds))
    return store, RedisEngine(redis, store, send, queue=queue, share=share, on_front=on_front)
