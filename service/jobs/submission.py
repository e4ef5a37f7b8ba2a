"""Work that was handed in, and what has come of it."""

import asyncio
from asyncio import Future, TimerHandle
from collections.abc import Callable
from dataclasses import replace
from time import perf_counter

from service.jobs.front_document import Rendered
from service.jobs.messages import Snapshot, Work

MOST_ATTEMPTS = 2


class Lost(Exception):
    """Two workers were lost over the work, which may be why."""


class Stopped(Exception):
    """The work was stopped before there was a front."""


class Overdue(Exception):
    """The work took longer than any may, and there was no front yet."""


def as_ended(front: Rendered, seconds: float, late: bool) -> Rendered:
    """A front that took so long from when it was asked for, and may have been ended for that."""
    total = 1000 * seconds
    phases = front.members["timings_ms"]
    timings = {"queue": total - sum(phases.values()), **phases, "total": total}
    members = {**front.members, "timings_ms": timings}
    if front.members["terminated"] in (None, "cancelled"):
        members["terminated"] = "time_limit" if late else "cancelled"
    return replace(front, members=members)


def as_planned(front: Rendered) -> Rendered:
    """A front that has ended, with the times of planning alone."""
    timings = {**front.members["timings_ms"]}
    del timings["queue"], timings["total"]
    return replace(front, members={**front.members, "timings_ms": timings})


class Order:
    """Work, who is told when it is begun and when it has come further, and in the end its front.

    A patient one has its time limit from when it is begun, another from when it is handed in.
    """

    def __init__(self, number: int, work: Work, tell: Callable[[], None], patient: bool) -> None:
        self.number = number
        self.work = work
        self.patient = patient
        self.attempts = 0
        self.stopped: type[Stopped | Overdue] | None = None
        self.snapshot: Snapshot | None = None
        self.timer: TimerHandle | None = None
        self._tell = tell
        self._future: Future[Rendered] = asyncio.get_running_loop().create_future()
        self._handed_in = perf_counter()

    @property
    def ended(self) -> bool:
        """Whether it has a front, or never will."""
        return self._future.done()

    async def front(self) -> Rendered:
        """The front, once there is one. Who no longer waits does not end the work.

        Raises:
            Lost: workers died over it.
            Stopped: it was stopped.
            Overdue: it took too long.
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

    def done(self, front: Rendered) -> None:
        """End with a front."""
        self._end()
        seconds = perf_counter() - self._handed_in
        self._future.set_result(as_ended(front, seconds, late=self.stopped is Overdue))

    def failed(self, error: Exception) -> None:
        """End without a front."""
        self._end()
        self._future.set_exception(error)
        # Nobody may be waiting any more, which asyncio would take for an oversight.
        self._future.exception()

    def cut_short(self) -> None:
        """End with what was found so far, if anything was."""
        if self.snapshot is None:
            self.failed((self.stopped or Stopped)())
        else:
            self.done(self.snapshot.front)

    def _end(self) -> None:
        if self.timer is not None:
            self.timer.cancel()
