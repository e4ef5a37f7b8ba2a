"""The interface of engines, which run jobs: in this process's workers, or on many machines."""

import asyncio
from asyncio import Future
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Protocol

from service.errors import DeadlineExceeded, ShuttingDown
from service.jobs.deadline import Deadline
from service.jobs.record import Record
from service.kinds.parts import Compiling
from service.requests.task import Task
from service.watch import Progress


@dataclass(frozen=True, eq=False)
class JobState:
    """A record with its status and front as of now, and what is known of its progress.

    Args:
        progress: The progress of its search, if it runs.
        compiling: The progress of the compilation that it waits for, if it waits.
    """

    record: Record
    progress: Progress | None = None
    compiling: Compiling | None = None


@dataclass(frozen=True, kw_only=True)
class EngineStats:
    """The numbers of waiting tasks; of workers: alive, busy, and lost and replaced."""

    waiting: int
    working: int
    lost: int
    workers: int


class Engine(Protocol):
    """Runs jobs and stores their records."""

    async def start(self) -> None:
        """Start the workers or listeners, and resume unfinished jobs."""

    async def close(self) -> None:
        """Take no more jobs. Unfinished ones stay in the store."""

    async def stats(self) -> EngineStats:
        """Return the numbers for the metrics."""

    async def check_open(self) -> None:
        """Raise ShuttingDown when no more jobs are taken."""

    async def check_place(self, client: str) -> None:
        """Raise QueueFull or ShareFull when no place is left for one more job of a client."""

    @property
    def compiling(self) -> Compiling | None:
        """The progress of compiling code on this machine; None before it and after it."""

    async def check_ready(self) -> None:
        """Raise a refusal when some kinds of tasks would be refused at the moment."""

    async def run(
        self, record: Record, task: Task, disconnected: Future[None], deadline: Deadline
    ) -> Record:
        """Run a new job while its client waits; when that disconnects, cancel it.

        At the deadline it ends with the best front so far. The task is that of the record, decoded.

        Raises:
            DeadlineExceeded: Nothing was found in time.
            WarmingUp: The code that it needs was not compiled in time.
            QueueFull: No place is left.
            ShareFull: The client holds its share of the places.
            ShuttingDown: No more jobs are taken.
            StoreUnavailable: The store accepts no fronts at the moment.
        """

    async def submit(self, record: Record, task: Task) -> Record:
        """Store and begin a job and return its record, or that of the job that it repeats.

        The task is that of the record, decoded.

        Storing and beginning succeed together or fail together: every job in the store was begun.

        Raises:
            QueueFull: No place is left.
            ShareFull: The client holds its share of the places.
            ShuttingDown: No more jobs are taken.
            StoreUnavailable: The store accepts no fronts at the moment.
            IdempotencyMismatch: The caller used the key for another body.
        """

    def state(self, record: Record) -> JobState:
        """Return the present state of a job, given its record in the store."""

    def watch(self, record: Record) -> AsyncIterator[JobState]:
        """Yield the state of a job now and after each change, until it is finished."""

    async def release(self, record: Record) -> None:
        """Wait until this process no longer holds the task of a submitted job."""

    async def cancel(self, record: Record) -> Record:
        """End a job at once, with what was found so far, and return its final record."""


_GRACE = 0.5  # seconds to wait longer, for a job that ends at the same time limit


async def record_in_time(engine: Engine, record: Record, deadline: Deadline) -> Record:
    """Return the record of a job once it is finished, or its present state at a deadline.

    Raises:
        DeadlineExceeded: Nothing was found in time. The job goes on.
        WarmingUp: The code that it needs is still being compiled. The job waits for it.
        ShuttingDown: The service ends and leaves the job to its next start.
    """
    state = JobState(record)
    try:
        async with asyncio.timeout(deadline.left() + _GRACE):
            async for state in engine.watch(record):
                record = state.record
    except TimeoutError:
        if state.compiling is not None:
            raise state.compiling.refusal from None
        if not record.front.tours:
            raise DeadlineExceeded from None
        return record
    if not record.finished:
        raise ShuttingDown
    return record


async def final_record(engine: Engine, record: Record) -> Record:
    """Wait until a job is finished and return its record.

    Raises:
        ShuttingDown: The service ends and leaves the job to its next start.
    """
    async for state in engine.watch(record):
        record = state.record
    if not record.finished:
        raise ShuttingDown
    return record
