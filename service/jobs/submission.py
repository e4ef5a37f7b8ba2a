"""Work that was handed in, and what has come of it."""

import asyncio
from asyncio import Future, TimerHandle
from collections.abc import Callable
from time import perf_counter

from service.errors import Cancelled, DeadlineExceeded
from service.jobs.front_document import FrontDocument
from service.jobs.messages import Snapshot
from service.jobs.record import as_ended
from service.requests.task import Work

MOST_ATTEMPTS = 2


class Submission:
    """Work, who is told when it is begun and when it has come further, and in the end its front.

    A patient one has its time limit from when it is begun, another from when it is handed in.
    """

    def __init__(self, number: int, work: Work, tell: Callable[[], None], patient: bool) -> None:
        self.number = number
        self.work = work
        self.patient = patient
        self.attempts = 0
        self.stopped: type[Cancelled | DeadlineExceeded] | None = None
        self.snapshot: Snapshot | None = None
        self.timer: TimerHandle | None = None
        self._tell = tell
        self._future: Future[FrontDocument] = asyncio.get_running_loop().create_future()
        self._handed_in = perf_counter()

    @property
    def ended(self) -> bool:
        """Whether it has a front, or never will."""
        return self._future.done()

    async def front(self) -> FrontDocument:
        """The front, once there is one. Who no longer waits does not end the work.

        Raises:
            WorkerLost: workers died over it.
            Cancelled: it was stopped.
            DeadlineExceeded: it took too long.
        """
        return await asyncio.shield(self._future)

    async def ended_or(self, left: Future[None]) -> None:
        """Wait until it has ended, or whoever waits for it has left."""
        await asyncio.wait((self._future, left), return_when=asyncio.FIRST_COMPLETED)

    def begin(self) -> None:
        """Take note that a worker is at it, for the first time or once more."""
        self.attempts += 1
        self._tell()

    def hear(self, snapshot: Snapshot) -> None:
        """Take note of how far the work has come."""
        self.snapshot = snapshot
        self._tell()

    def done(self, front: FrontDocument) -> None:
        """End with a front."""
        self._end()
        seconds = perf_counter() - self._handed_in
        self._future.set_result(as_ended(front, seconds, late=self.stopped is DeadlineExceeded))

    def failed(self, error: Exception) -> None:
        """End without a front."""
        self._end()
        self._future.set_exception(error)
        # Nobody may be waiting any more, which asyncio would take for an oversight.
        self._future.exception()

    def cut_short(self) -> None:
        """End with what was found so far, if anything was."""
        if self.snapshot is None:
            self.failed((self.stopped or Cancelled)())
        else:
            self.done(self.snapshot.front)

    def _end(self) -> None:
        if self.timer is not None:
            self.timer.cancel()
