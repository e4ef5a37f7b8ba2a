"""The engine of a single machine: jobs run in the worker processes of this service."""

import asyncio
import logging
from asyncio import Future
from collections.abc import AsyncIterator, Coroutine
from contextlib import suppress
from dataclasses import replace

from service.errors import (
    Cancelled,
    Expired,
    NotFound,
    QueueFull,
    Refusal,
    ShuttingDown,
    StoreUnavailable,
    WorkerLost,
)
from service.jobs.cancelling import cancel_all
from service.jobs.deadline import Deadline
from service.jobs.engine import EngineStats, JobState, final_record
from service.jobs.record import Record, Status, as_cancelled, as_failed, as_finished
from service.jobs.sqlite_store import SqliteStore
from service.jobs.submission import Submission
from service.jobs.workers.worker_pool import WorkerPool
from service.kinds.parts import Compiling
from service.requests.task import Task
from service.requests.task_codec import decode_task

_PAUSE = 0.5  # seconds between tries to resume the job of an earlier process
_PATIENCE = 600.0  # seconds for which storing a front is tried
_SAVE_PAUSE = 2.0  # seconds between two tries
_LOG = logging.getLogger("paretour")


class _Job:
    """An unfinished job: its record, its submission once it has one, and an event for watchers."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.ended = False
        self.submission: Submission | None = None
        self.changed = asyncio.Event()  # which is set at the next change

    @property
    def state(self) -> JobState:
        """The present state."""
        record, submission = self.record, self.submission
        if record.finished or submission is None:
            return JobState(record)
        status: Status = "running" if submission.attempts else "queued"
        front = submission.best_front or record.front
        record = replace(record, status=status, front=front)
        return JobState(record, submission.progress, submission.compiling)

    def reserve(self, workers: WorkerPool, task: Task) -> None:
        """Take a place in the queue for its task; it raises what WorkerPool.reserve raises."""
        self.submission = workers.reserve(task, self._notify, client=self.record.client)

    def end(self, record: Record) -> None:
        """Take the final record."""
        self.record = record
        self.ended = True
        self._notify()

    def _notify(self) -> None:
        changed, self.changed = self.changed, asyncio.Event()
        changed.set()


class UnsavedRecords:
    """Saves records that the store did not accept at first."""

    def __init__(self, store: SqliteStore, patience: float = _PATIENCE) -> None:
        self._store = store
        self._patience = patience
        self._ids: set[str] = set()

    def check_none(self) -> None:
        """Raise StoreUnavailable while the store has not accepted some record."""
        if self._ids:
            raise StoreUnavailable

    async def save(self, record: Record, error: Exception) -> None:
        """Try to store a finished record until the store accepts it.

        After some minutes the front is given up, and a failed record is stored instead.

        Args:
            error: What the store raised at first.
        """
        self._ids.add(record.id)
        _LOG.error("front %s cannot be stored, and is tried again", record.id, exc_info=error)
        deadline = Deadline.after(self._patience)
        try:
            while not await self._is_saved(record):
                if deadline.over() and record.front.tours:
                    empty = record.front.without_tours()
                    record = as_failed(record, StoreUnavailable(), empty)
                await asyncio.sleep(_SAVE_PAUSE)
        finally:
            self._ids.discard(record.id)
        _LOG.info("front %s is stored", record.id)

    async def _is_saved(self, record: Record) -> bool:
        try:
            await self._store.put(record)
        except Exception:
            return False
        return True


class LocalEngine:
    """Runs jobs in a pool of worker processes.

    Jobs that are unfinished when the service ends stay in the store; the next service with that
    store resumes them. If the store does not accept a finished record, its front is reported all
    the same and stored later; until then no new job is accepted.
    """

    def __init__(self, workers: WorkerPool, store: SqliteStore) -> None:
        self._workers = workers
        self._store = store
        self._unsaved = UnsavedRecords(store)
        self._jobs: dict[str, _Job] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Start the workers, and resume the jobs that an earlier process left unfinished."""
        await self._workers.start()
        resumed = [_Job(record) for record in await self._store.unfinished()]
        self._jobs.update({job.record.id: job for job in resumed})
        if resumed:
            self._spawn(self._resume(resumed))

    async def close(self) -> None:
        """Close the workers. Unfinished jobs stay in the store."""
        await self._workers.close()
        await cancel_all(self._tasks)

    async def stats(self) -> EngineStats:
        """Return the numbers for the metrics."""
        workers = self._workers
        return EngineStats(
            waiting=workers.waiting,
            working=workers.working,
            lost=workers.lost,
            workers=workers.live,
        )

    async def check_open(self) -> None:
        """Raise ShuttingDown when no more jobs are taken."""
        self._workers.check_open()

    async def check_place(self, client: str) -> None:
        """Raise QueueFull or ShareFull when no place is left, StoreUnavailable when it is full."""
        self._unsaved.check_none()
        self._workers.check_place(client)

    @property
    def compiling(self) -> Compiling | None:
        """The progress of compiling code; None before it and after it."""
        return self._workers.compiling

    async def check_ready(self) -> None:
        """Raise a refusal when some kinds of tasks would be refused at the moment."""
        self._workers.check_ready()
        self._unsaved.check_none()

    async def run(
        self, record: Record, task: Task, disconnected: Future[None], deadline: Deadline
    ) -> Record:
        """Run a new job while its client waits; when that disconnects, cancel it."""
        self._unsaved.check_none()
        submission = self._workers.submit(task, deadline=deadline, client=record.client)
        disconnected.add_done_callback(lambda _: self._workers.stop(submission))
        try:
            front = await submission.front()
        finally:
            self._workers.stop(submission)
        record = as_finished(record, front, None)
        try:
            await self._store.put(record)
        except Exception as error:
            self._spawn(self._unsaved.save(record, error))
        return record

    async def submit(self, record: Record, task: Task) -> Record:
        """Store and begin a job at once, or return the earlier one that it is a repeat of."""
        job = _Job(record)
        try:
            self._unsaved.check_none()
            job.reserve(self._workers, task)
        except (QueueFull, StoreUnavailable):
            # A repeat needs no place.
            if earlier := await self._store.repeated(record):
                return earlier
            raise
        # Before it is stored: a client that sees it in the store must find it here too.
        self._jobs[record.id] = job
        first = None
        try:
            first = await self._admit(record)
            return first
        finally:
            assert job.submission is not None
            if first is not None and first.id == record.id:
                self._begin(job)
            else:
                del self._jobs[record.id]
                self._workers.give_back(job.submission)

    def state(self, record: Record) -> JobState:
        """Return the present state of a job, given its record in the store."""
        job = self._jobs.get(record.id)
        return job.state if job else JobState(record)

    async def watch(self, record: Record) -> AsyncIterator[JobState]:
        """Yield the state of a job now and after each change, until it is finished."""
        job = self._jobs.get(record.id)
        while job is not None and not job.ended:
            changed = job.changed
            yield job.state
            await changed.wait()
        yield job.state if job else JobState(await self._stored(record))

    async def release(self, record: Record) -> None:
        """Wait until a job is finished: until then its task is in its record."""
        async for _ in self.watch(record):
            pass

    async def cancel(self, record: Record) -> Record:
        """End a job at once, with what was found so far, and return its final record."""
        if job := self._jobs.get(record.id):
            if job.submission is None:
                await self._end(job, as_cancelled(job.record))
            else:
                self._workers.stop(job.submission)
        return await final_record(self, record)

    async def _stored(self, record: Record) -> Record:
        """Return the record in the store; if it was deleted there, a failed one."""
        if record.finished:
            return record
        try:
            return await self._store.get(record.caller, record.id)
        except (NotFound, Expired):
            return as_failed(record, Cancelled(), record.front)

    async def _admit(self, record: Record) -> Record:
        """Store a new record and return it, or return the one that has its idempotency key."""
        try:
            return await self._store.admit(record)
        except Refusal:
            raise
        except Exception as error:
            _LOG.error("front %s cannot be stored", record.id, exc_info=error)
            raise StoreUnavailable from error

    def _begin(self, job: _Job) -> None:
        assert job.submission is not None
        self._workers.queue(job.submission)
        self._spawn(self._follow(job))

    def _spawn(self, coroutine: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _resume(self, jobs: list[_Job]) -> None:
        """Begin the jobs of an earlier process, except those cancelled meanwhile."""
        for job in jobs:
            try:
                assert job.record.task is not None
                task = await asyncio.to_thread(decode_task, job.record.task)
                while not job.ended and not self._is_resumed(job, task):
                    await asyncio.sleep(_PAUSE)
            except Exception as error:
                await self._end(job, as_failed(job.record, error, job.record.front))

    def _is_resumed(self, job: _Job, task: Task) -> bool:
        """Begin a job, and return whether there was a place for it."""
        with suppress(QueueFull, ShuttingDown):
            job.reserve(self._workers, task)
            self._begin(job)
        return job.submission is not None

    async def _follow(self, job: _Job) -> None:
        """Wait for the front of a job, and end it."""
        try:
            await self._end(job, await self._result(job))
        except ShuttingDown:
            _LOG.info("front %s is left for the next start", job.record.id)
        finally:
            if not job.ended:
                job.end(job.record)
            self._jobs.pop(job.record.id, None)

    async def _end(self, job: _Job, ended: Record) -> None:
        """Store the final record of a job, then report it; if it cannot be stored, report it first.

        The job remains, with its final record, until that is stored.
        """
        try:
            await self._store.put(ended)
        except Exception as error:
            job.end(ended)
            await self._unsaved.save(ended, error)
        job.end(ended)
        self._jobs.pop(job.record.id, None)

    async def _result(self, job: _Job) -> Record:
        assert job.submission is not None
        try:
            return await job.submission.final(job.record)
        except WorkerLost as error:
            return as_failed(job.record, error, job.submission.best_front or job.record.front)
