"""The engine of a single machine: jobs run in the worker processes of this service."""

import asyncio
from asyncio import Future
from collections.abc import AsyncIterator, Coroutine
from dataclasses import replace

from service.errors import Cancelled, Expired, NotFound, QueueFull, ShuttingDown, WarmingUp
from service.jobs.engine import EngineStats, JobState, final_record
from service.jobs.record import Record, Status, as_cancelled, as_failed, as_finished
from service.jobs.store import Store
from service.jobs.submission import Submission
from service.jobs.worker_pool import WorkerPool

_PAUSE = 0.5  # seconds between two tries to resume the job of an earlier process


class _Job:
    """A record with its submission, and an event for those who watch it."""

    def __init__(self, record: Record, workers: WorkerPool) -> None:
        assert record.source is not None
        self._record = record
        self._changed = asyncio.Event()
        self.ended = False
        self.submission: Submission = workers.submit(record.source, self._notify, patient=True)

    @property
    def state(self) -> JobState:
        """The present state."""
        if self._record.finished:
            return JobState(self._record)
        status: Status = "running" if self.submission.attempts else "queued"
        front = self.submission.best_front or self._record.front
        return JobState(replace(self._record, status=status, front=front), self.submission.progress)

    @property
    def changed(self) -> asyncio.Event:
        """An event that is set at the next change."""
        return self._changed

    def end(self, record: Record) -> None:
        """Take the final record."""
        self._record = record
        self.ended = True
        self._notify()

    def _notify(self) -> None:
        changed, self._changed = self._changed, asyncio.Event()
        changed.set()


class LocalEngine:
    """Runs jobs in a pool of worker processes.

    Jobs that are unfinished when the service ends stay in the store; the next service with that
    store resumes them.
    """

    def __init__(self, workers: WorkerPool, store: Store) -> None:
        self._workers = workers
        self._store = store
        self._jobs: dict[str, _Job] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Start the workers, and resume the jobs that an earlier process left unfinished."""
        await self._workers.start()
        if unfinished := await self._store.unfinished():
            self._spawn(self._resume(unfinished))

    async def close(self) -> None:
        """Close the workers. Unfinished jobs stay in the store."""
        await self._workers.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def stats(self) -> EngineStats:
        """Return the numbers for the metrics."""
        workers = self._workers
        return EngineStats(waiting=workers.waiting, working=workers.working, lost=workers.lost)

    async def check_open(self) -> None:
        """Raise ShuttingDown when no more jobs are taken."""
        self._workers.check_open()

    async def check_place(self) -> None:
        """Raise QueueFull when no place is left for one more job."""
        self._workers.check_place()

    async def check_warm(self) -> None:
        """Raise WarmingUp until the search is compiled."""
        self._workers.check_warm()

    async def check_ready(self) -> None:
        """Raise ShuttingDown or WarmingUp when some task would be refused at the moment."""
        self._workers.check_ready()

    async def run(self, record: Record, disconnected: Future[None]) -> Record:
        """Run a new job while its client waits; when that disconnects, cancel it."""
        assert record.source is not None
        submission = self._workers.submit(record.source)
        try:
            await submission.wait(disconnected)
        finally:
            self._workers.stop(submission)
        record = replace(record, status="done", front=await submission.front(), source=None)
        await self._store.put(record)
        return record

    async def submit(self, record: Record) -> None:
        """Begin a job that is in the store, and return at once."""
        job = self._jobs[record.id] = _Job(record, self._workers)
        self._spawn(self._store_result(record, job))

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

    async def cancel(self, record: Record) -> Record:
        """End a job at once, with what was found so far, and return its final record."""
        if job := self._jobs.get(record.id):
            self._workers.stop(job.submission)
        return await final_record(self, record)

    async def _stored(self, record: Record) -> Record:
        """Return the record in the store; if it was deleted there, a cancelled one."""
        if record.finished:
            return record
        try:
            return await self._store.get(record.caller, record.id)
        except (NotFound, Expired):
            return as_cancelled(record)

    def _spawn(self, coroutine: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(coroutine)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _resume(self, unfinished: list[Record]) -> None:
        for record in unfinished:
            while True:
                try:
                    self._workers.check_warm()
                    await self.submit(record)
                    break
                except (QueueFull, WarmingUp):
                    await asyncio.sleep(_PAUSE)

    async def _store_result(self, record: Record, job: _Job) -> None:
        try:
            ended = await self._result(record, job.submission)
            await self._store.put(ended)
            job.end(ended)
        except ShuttingDown:
            job.end(record)
        finally:
            del self._jobs[record.id]

    async def _result(self, record: Record, submission: Submission) -> Record:
        try:
            return as_finished(record, await submission.front(), submission.stop_reason)
        except Cancelled:
            return as_cancelled(record)
        except ShuttingDown:
            raise
        except Exception as error:
            return as_failed(record, error, submission.best_front or record.front)
