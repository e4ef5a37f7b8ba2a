"""The interface of engines, which run jobs: in this process's workers, or on many machines."""

import asyncio
from asyncio import Future
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Protocol

from service.errors import DeadlineExceeded, ShuttingDown
from service.front import Progress
from service.jobs.record import Record
from service.requests.task import Task


@dataclass(frozen=True, eq=False)
class JobState:
    """A record with its status and front as of now, and the progress of its search, if it runs."""

    record: Record
    progress: Progress | None = None


@dataclass(frozen=True, kw_only=True)
class EngineStats:
    """Numbers of tasks that wait, of workers that run any, and of those lost and replaced."""

    waiting: int
    working: int
    lost: int


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

    async def check_warm(self) -> None:
        """Raise WarmingUp until the search is compiled."""

    async def check_ready(self) -> None:
        """Raise a refusal when some task would be refused at the moment."""

    async def run(self, record: Record, task: Task, disconnected: Future[None]) -> Record:
        """Run a new job while its client waits; when that disconnects, cancel it.

        The task is that of the record's source.

        Raises:
            QueueFull: No place is left.
            ShareFull: The client holds as many as it may.
            ShuttingDown: No more jobs are taken.
            StoreUnavailable: The store takes no more fronts.
        """

    async def submit(self, record: Record, task: Task) -> Record:
        """Store and begin a job, and return its record; or that of which it is a repeat.

        The task is that of the record's source.

        Either both happens or nothing: nobody sees a record that was not begun.

        Raises:
            QueueFull: No place is left.
            ShareFull: The client holds as many as it may.
            ShuttingDown: No more jobs are taken.
            StoreUnavailable: The store takes no more fronts.
            IdempotencyMismatch: The caller used the key for another body.
        """

    def state(self, record: Record) -> JobState:
        """Return the present state of a job, given its record in the store."""

    def watch(self, record: Record) -> AsyncIterator[JobState]:
        """Yield the state of a job now and after each change, until it is finished."""

    async def release(self, record: Record) -> None:
        """Wait until this process no longer holds what a job that was submitted is planned from."""

    async def cancel(self, record: Record) -> Record:
        """End a job at once, with what was found so far, and return its final record."""


_GRACE = 0.5  # seconds for a job that ends at the same time limit


async def record_in_time(engine: Engine, record: Record, seconds: float) -> Record:
    """Return the record of a job once it is finished, or after so many seconds as it is then.

    Raises:
        DeadlineExceeded: Nothing was found in these seconds. The job goes on.
        ShuttingDown: It is left unfinished for the next start.
    """
    try:
        async with asyncio.timeout(seconds + _GRACE):
            async for state in engine.watch(record):
                record = state.record
    except TimeoutError:
        if not record.front.tours:
            raise DeadlineExceeded from None
        return record
    if not record.finished:
        raise ShuttingDown
    return record


async def final_record(engine: Engine, record: Record) -> Record:
    """Wait until a job is finished and return its record.

    Raises:
        ShuttingDown: It is left unfinished for the next start.
    """
    async for state in engine.watch(record):
        record = state.record
    if not record.finished:
        raise ShuttingDown
    return record
