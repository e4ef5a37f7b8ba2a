"""What has fronts planned, in this process's workers or on many machines: one interface to both."""

from asyncio import Future
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import Protocol

from service.jobs.messages import Snapshot
from service.jobs.record import Record


@dataclass(frozen=True, eq=False)
class JobState:
    """How a record stands as of now, and how far a search that goes on has come."""

    record: Record
    progress: Snapshot | None = None


@dataclass(frozen=True, kw_only=True)
class EngineStats:
    """How many fronts wait, how many are being planned, and how many workers were replaced."""

    waiting: int
    working: int
    lost: int


class Engine(Protocol):
    """Does the work of records, and keeps what comes of it in their store."""

    async def start(self) -> None:
        """Begin, with what was left unfinished."""

    async def close(self) -> None:
        """Take no more work, and leave unfinished what is."""

    async def standing(self) -> EngineStats:
        """How it is, for whoever watches."""

    async def check_open(self) -> None:
        """Nothing, if work is taken.

        Raises:
            ShuttingDown: no more work is taken.
        """

    async def check_place(self) -> None:
        """Nothing, if there is a place for one more front.

        Raises:
            QueueFull: there is none.
        """

    async def check_warm(self) -> None:
        """Nothing, if work may need compiled code.

        Raises:
            WarmingUp: it is not there yet.
        """

    async def check_ready(self) -> None:
        """Nothing, if work of every kind is taken.

        Raises:
            ShuttingDown: no more work is taken.
            WarmingUp: not yet, or not at the moment.
        """

    async def run(self, record: Record, left: Future[None]) -> Record:
        """What becomes of work that somebody waits for, until he has left.

        Raises:
            QueueFull: the queue is full.
            ShuttingDown: no more work is taken.
        """

    async def begin(self, record: Record) -> None:
        """Begin the work of a record that is in the store, whoever waits.

        Raises:
            QueueFull: the queue is full.
            ShuttingDown: no more work is taken.
        """

    def state(self, record: Record) -> JobState:
        """How a record from the store stands."""

    def watch(self, record: Record) -> AsyncIterator[JobState]:
        """How it stands now, and after each change, until it is finished."""

    async def cancel(self, record: Record) -> Record:
        """End the work of a record at once; what was found so far is kept."""


async def finished(engine: Engine, record: Record) -> Record:
    """What becomes of a record in the end."""
    async for state in engine.watch(record):
        record = state.record
    return record
