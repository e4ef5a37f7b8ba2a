"""Work that outlives the request that asked for it, on the workers of this process."""

import asyncio
from asyncio import Future
from collections.abc import AsyncIterator, Coroutine
from dataclasses import replace

from service.errors import Cancelled, Expired, NotFound, QueueFull, ShuttingDown, WarmingUp
from service.jobs.engine import EngineStats, JobState, finished
from service.jobs.record import Record, Status, cancelled, done, failed
from service.jobs.store import Store
from service.jobs.submission import Submission
from service.jobs.worker_pool import WorkerPool

_PAUSE = 0.5  # seconds between two tries to take up the work of an earlier process


class _Job:
    """A record that is worked on, and whoever waits for it to change."""

    def __init__(self, record: Record, workers: WorkerPool) -> None:
        assert record.work is not None
        self._record = record
        self._changed = asyncio.Event()
        self.ended = False
        self.order: Submission = workers.order(record.work, self._tell, patient=True)

    @property
    def state(self) -> JobState:
        """How it stands."""
        if self._record.finished:
            return JobState(self._record)
        snapshot = self.order.snapshot
        status: Status = "running" if self.order.attempts else "queued"
        front = snapshot.front if snapshot else self._record.front
        return JobState(replace(self._record, status=status, front=front), snapshot)

    @property
    def changed(self) -> asyncio.Event:
        """What is set once it stands differently from now."""
        return self._changed

    def end(self, record: Record) -> None:
        """This is what became of it."""
        self._record = record
        self.ended = True
        self._tell()

    def _tell(self) -> None:
        told, self._changed = self._changed, asyncio.Event()
        told.set()


class LocalEngine:
    """Does the work of records, and keeps what comes of it in the store.

    What is unfinished when the service ends stays in the store, and is begun again by the next
    service that has that store.
    """

    def __init__(self, workers: WorkerPool, store: Store) -> None:
        self._workers = workers
        self._store = store
        self._jobs: dict[str, _Job] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    async def start(self) -> None:
        """Start the workers, and take up what an earlier process has left unfinished."""
        await self._workers.start()
        if unfinished := await self._store.unfinished():
            self._spawn(self._resume(unfinished))

    async def close(self) -> None:
        """Close the workers, and leave the work where it is."""
        await self._workers.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def standing(self) -> EngineStats:
        """How it is, for whoever watches."""
        workers = self._workers
        return EngineStats(waiting=workers.waiting, working=workers.working, lost=workers.lost)

    async def check_open(self) -> None:
        """Nothing, if work is taken."""
        self._workers.check_open()

    async def check_place(self) -> None:
        """Nothing, if there is a place for one more front."""
        self._workers.check_place()

    async def check_warm(self) -> None:
        """Nothing, if work may need compiled code."""
        self._workers.check_warm()

    async def check_ready(self) -> None:
        """Nothing, if work of every kind is taken."""
        self._workers.check_ready()

    async def run(self, record: Record, left: Future[None]) -> Record:
        """What becomes of work that somebody waits for, until he has left."""
        assert record.work is not None
        order = self._workers.order(record.work)
        try:
            await order.ended_or(left)
        finally:
            self._workers.stop(order)
        record = replace(record, status="done", front=await order.front(), work=None)
        await self._store.put(record)
        return record

    async def begin(self, record: Record) -> None:
        """Begin the work of a record that is in the store, whoever waits."""
        job = self._jobs[record.id] = _Job(record, self._workers)
        self._spawn(self._see_through(record, job))

    def state(self, record: Record) -> JobState:
        """How a record from the store stands."""
        job = self._jobs.get(record.id)
        return job.state if job else JobState(record)

    async def watch(self, record: Record) -> AsyncIterator[JobState]:
        """How it stands now, and after each change, until it is finished."""
        job = self._jobs.get(record.id)
        while job is not None and not job.ended:
            changed = job.changed
            yield job.state
            await changed.wait()
        yield job.state if job else JobState(await self._latest(record))

    async def cancel(self, record: Record) -> Record:
        """End the work of a record at once; what was found so far is kept."""
        if job := self._jobs.get(record.id):
            self._workers.stop(job.order)
        return await finished(self, record)

    async def _latest(self, record: Record) -> Record:
        """As it is in the store; once it is forgotten, as if it had been cancelled."""
        if record.finished:
            return record
        try:
            return await self._store.get(record.caller, record.id)
        except (NotFound, Expired):
            return cancelled(record)

    def _spawn(self, work: Coroutine[None, None, None]) -> None:
        task = asyncio.create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _resume(self, unfinished: list[Record]) -> None:
        for record in unfinished:
            while True:
                try:
                    self._workers.check_warm()
                    await self.begin(record)
                    break
                except (QueueFull, WarmingUp):
                    await asyncio.sleep(_PAUSE)

    async def _see_through(self, record: Record, job: _Job) -> None:
        try:
            ended = await self._ended(record, job.order)
            await self._store.put(ended)
            job.end(ended)
        except ShuttingDown:
            job.end(record)
        finally:
            del self._jobs[record.id]

    async def _ended(self, record: Record, order: Submission) -> Record:
        try:
            return done(record, await order.front(), order.stopped)
        except Cancelled:
            return cancelled(record)
        except ShuttingDown:
            raise
        except Exception as error:
            return failed(record, error, order.snapshot.front if order.snapshot else record.front)
