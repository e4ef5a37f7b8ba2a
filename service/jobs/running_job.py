"""A job of the local engine while it is unfinished: its record, its submission, its followers."""

import asyncio
from dataclasses import replace

from service.jobs.engine import JobState
from service.jobs.record import Record, Status
from service.jobs.submission import Submission
from service.jobs.workers.worker_pool import WorkerPool
from service.requests.task import Task


class RunningJob:
    """A record with its submission, once it has one, and an event for those who watch it."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.ended = False
        self.submission: Submission | None = None
        self._changed = asyncio.Event()

    @property
    def id(self) -> str:
        """The id of its record."""
        return self.record.id

    @property
    def state(self) -> JobState:
        """The present state."""
        record, submission = self.record, self.submission
        if record.finished or submission is None:
            return JobState(record)
        status: Status = "running" if submission.attempts else "queued"
        front = submission.best_front or record.front
        return JobState(replace(record, status=status, front=front), submission.progress)

    @property
    def changed(self) -> asyncio.Event:
        """An event that is set at the next change."""
        return self._changed

    def reserve(self, workers: WorkerPool, task: Task) -> None:
        """Take a place in the queue for its task; it raises what WorkerPool.reserve raises."""
        self.submission = workers.reserve(task, self._notify, client=self.record.client)

    def end(self, record: Record) -> None:
        """Take the final record."""
        self.record = record
        self.ended = True
        self._notify()

    def _notify(self) -> None:
        changed, self._changed = self._changed, asyncio.Event()
        changed.set()
