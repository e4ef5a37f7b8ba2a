"""A worker of the cluster: Celery brings messages, and a pool of processes plans their records.

The pool is that of the local engine. It starts, watches, replaces, stops and kills the processes.
Here a record is taken from Redis for each message, given to the pool, and followed: its progress
goes to Redis, and the pool stops it when its caller cancels it.
"""

import asyncio
import logging
import os
import uuid
from asyncio import AbstractEventLoop
from collections.abc import Coroutine
from contextlib import suppress
from dataclasses import dataclass, field
from socket import gethostname, socketpair
from threading import Thread
from time import time
from typing import Any

from celery import Celery, current_task
from celery.concurrency.thread import TaskPool
from celery.exceptions import Reject
from celery.signals import setup_logging, worker_shutting_down

from service.cluster.celery_app import TASK
from service.cluster.records import StoredRecord
from service.cluster.script import connect_redis
from service.cluster.worker_store import TakenOver, WorkerStore
from service.errors import Cancelled, NoWorker, WarmingUp, WorkerLost
from service.jobs.cancelling import cancel_all
from service.jobs.record import as_failed
from service.jobs.submission import MOST_ATTEMPTS, Submission
from service.jobs.workers.worker_pool import WorkerPool
from service.jobs.workers.worker_process import MakeRunner
from service.requests.task_codec import decode_task
from service.roads.client import RoadClient

_CHECK_EVERY = 0.05  # seconds between two checks whether a record is still wanted
_HEARTBEAT_EVERY = 1.0  # seconds between two signs of life


class Draining(Cancelled):
    """The worker shuts down and leaves its record to another."""


class RecordWorker:
    """Plans the fronts of records in an event loop, as many at a time as it has processes.

    A process that is lost is counted in Redis, so the pool leaves it to this worker to try again.

    Args:
        make_runner: Called in each process; it must be picklable.
        seconds: The time limit of a record.
        roads: The client of a routing engine.
    """

    def __init__(
        self,
        make_runner: MakeRunner,
        redis_url: str,
        *,
        workers: int,
        seconds: float,
        roads: RoadClient | None = None,
    ) -> None:
        self._pool = WorkerPool(
            make_runner,
            workers=workers,
            queue=workers,
            seconds=seconds,
            attempts=1,
            roads=roads,
            on_failed=self._fail,
        )
        self._failure = ""
        machine = f"{gethostname()}:{os.getpid()}"
        self._stores = [
            WorkerStore(connect_redis(redis_url), f"{machine}:{uuid.uuid4().hex}")
            for _ in range(workers)
        ]
        self._free = list(self._stores)
        self.workers = workers
        self._draining = False

    async def start(self) -> None:
        """Start the processes, wait until one is ready, and send heartbeats from then on.

        Raises:
            NoWorker: No process gets ready in three tries.
        """
        await self._pool.start()
        while not self._is_ready():
            if self._failure:
                await self._pool.close()
                raise NoWorker(self._failure)
            await asyncio.sleep(_CHECK_EVERY)
        self._heartbeats = asyncio.create_task(self._send_heartbeats())

    async def close(self) -> None:
        """End the heartbeats and the processes."""
        await cancel_all([self._heartbeats])
        await self._pool.close()

    def drain(self) -> None:
        """Hand the records back that are being planned."""
        self._draining = True

    async def plan(self, id: str, known_lost: bool) -> None:
        """Plan the front of the record that is next, if one waits.

        Args:
            id: The id in the message. The message stands for a turn, not for that record.
            known_lost: Whether the worker that had the message before is lost.

        Raises:
            Draining: The worker shuts down; the record is queued again.
        """
        store = self._free.pop()
        try:
            while (stored := await store.begin(id, known_lost)) is not None:
                if stored.attempts > MOST_ATTEMPTS:
                    await store.finish(as_failed(stored.record, WorkerLost(), stored.record.front))
                    return
                try:
                    await self._plan(store, stored)
                except WorkerLost:
                    known_lost = True
                else:
                    return
        finally:
            self._free.append(store)

    async def _plan(self, store: WorkerStore, stored: StoredRecord) -> None:
        """Plan a record and store what became of it.

        Raises:
            WorkerLost: The process was lost.
            Draining: The worker shuts down; the record is queued again.
        """
        record = stored.record
        assert record.task is not None
        try:
            task = await asyncio.to_thread(decode_task, record.task)
            submission = self._pool.submit(task)
        except Exception as error:
            await store.finish(as_failed(record, error, record.front))
            return
        submission.waited = time() - stored.requested_at
        await self._follow(store, record.id, submission)
        if submission.stop_reason is Draining:
            await store.hand_back(record.id)
        elif submission.stop_reason is not TakenOver:
            await store.finish(await submission.final(record))
        # A process that does not stop at once is given no other record meanwhile.
        while submission in self._pool.running:
            await asyncio.sleep(_CHECK_EVERY)
        if submission.stop_reason is Draining:
            raise Draining

    async def _follow(self, store: WorkerStore, id: str, submission: Submission) -> None:
        """Report on a submission, and stop it once it is not wanted, until it ends."""
        ended = asyncio.Event()
        submission.when_ended(ended.set)
        reported: object = None, None
        while True:
            with suppress(TimeoutError):
                await asyncio.wait_for(ended.wait(), _CHECK_EVERY)
            if submission.ended:
                return
            reason = Draining if self._draining else await store.stop_reason(id)
            if reason is not None:
                self._pool.stop(submission, reason)
            process, progress = self._pool.running.get(submission), submission.progress
            if (process, progress) != reported:
                reported = process, progress
                await store.report(id, process, progress, submission.best_front)

    def _fail(self, reason: str) -> None:
        self._failure = reason

    def _is_ready(self) -> bool:
        with suppress(NoWorker, WarmingUp):
            self._pool.check_ready()
            return True
        return False

    async def _send_heartbeats(self) -> None:
        while True:
            try:
                for store in self._stores if self._is_ready() else ():
                    await store.send_heartbeat()
            except Exception:
                # Otherwise this worker would never be counted again.
                logging.getLogger("paretour").exception("a sign of life could not be sent")
            await asyncio.sleep(_HEARTBEAT_EVERY)


class _Threads(TaskPool):  # type: ignore[misc]  # Celery has no types
    """Celery's pool of threads; each thread waits for a record.

    It wakes Celery's event loop after each record, to fetch the next message at once.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._waking, self._awoken = socketpair()

    def register_with_event_loop(self, hub: Any) -> None:
        """Have the event loop wake up when a record has ended."""
        hub.add_reader(self._awoken, self._awoken.recv, 1)

    def on_apply(self, *args: Any, **options: Any) -> Any:
        """Run a task in a thread."""
        result = super().on_apply(*args, **options)
        result.f.add_done_callback(lambda _: self._waking.send(b"\0"))
        return result


@dataclass(frozen=True, kw_only=True)
class CeleryWorker:
    """A Celery worker, which gives each message to a worker of records.

    After it was told to shut down, it finishes its records for `drain_seconds`, and then hands back
    those that are left.
    """

    celery: Celery
    records: RecordWorker
    drain_seconds: float
    loop: AbstractEventLoop = field(default_factory=asyncio.new_event_loop)

    def start(self) -> None:
        """Start the processes, and wait until one is ready.

        Raises:
            NoWorker: No process gets ready in three tries.
        """
        Thread(target=self.loop.run_forever, name="records", daemon=True).start()
        self._wait_for(self.records.start())

    def run(self) -> int:
        """Plan records until told to shut down, and return the exit status."""
        self.celery.task(self._plan, name=TASK)
        worker_shutting_down.connect(self._drain_soon)
        setup_logging.connect(_keep_logging)
        worker = self.celery.Worker(
            hostname=f"paretour@{gethostname()}-{os.getpid()}",
            pool=_Threads,
            concurrency=self.records.workers,
            quiet=True,
            without_gossip=True,
            without_mingle=True,
            without_heartbeat=True,
        )
        worker.start()
        self._wait_for(self.records.close())
        return int(worker.exitcode or 0)

    def _plan(self, id: str) -> None:
        """Plan a record. If its message was delivered before, that worker was lost."""
        redelivered = bool(current_task.request.delivery_info.get("redelivered"))
        try:
            self._wait_for(self.records.plan(id, known_lost=redelivered))
        except Draining:
            raise Reject(requeue=True) from None

    def _drain_soon(self, **_: Any) -> None:
        self.loop.call_soon_threadsafe(self.loop.call_later, self.drain_seconds, self.records.drain)

    def _wait_for(self, coroutine: Coroutine[Any, Any, None]) -> None:
        asyncio.run_coroutine_threadsafe(coroutine, self.loop).result()


def _keep_logging(**_: Any) -> None:
    """Keep Celery from configuring logging, which the caller has done."""
