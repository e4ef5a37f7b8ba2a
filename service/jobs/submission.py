"""A task submitted to the worker pool, and its future front."""

import asyncio
from asyncio import Future, TimerHandle
from collections.abc import Callable
from time import perf_counter

from service.errors import Cancelled, DeadlineExceeded, ShuttingDown, WorkerLost
from service.jobs.record import Record, StopReason, as_ended, as_failed, as_finished
from service.kinds.front_document import FrontDocument
from service.kinds.parts import Compiling
from service.kinds.table import is_brief
from service.requests.task import Task
from service.watch import Progress

MOST_ATTEMPTS = 2


class Submission:
    """A task that waits for a worker, is being run, or has ended.

    Args:
        number: Tells it from the pool's other submissions, also in messages.
        on_change: Called when a worker begins, and with each progress.
        client: The client whose turn in the queue, and whose share of the places, it takes.
    """

    def __init__(
        self,
        number: int,
        task: Task,
        on_change: Callable[[], None],
        client: str = "",
    ) -> None:
        self.number = number
        self.task = task
        self.client = client
        self.attempts = 0
        self.waited = 0.0  # seconds, before it was submitted
        self.stop_reason: StopReason | None = None
        self.progress: Progress | None = None
        self.best_front: FrontDocument | None = None
        self.timer: TimerHandle | None = None
        self.compiling: Compiling | None = None  # while what it needs is compiled
        self._on_change = on_change
        self._future: Future[FrontDocument] = asyncio.get_running_loop().create_future()
        self._submitted = perf_counter()

    @property
    def ended(self) -> bool:
        """Whether it has a front, or has failed."""
        return self._future.done()

    @property
    def is_brief(self) -> bool:
        """Whether it may share a process's turn: it is short, and was in no process that died."""
        return is_brief(self.task) and self.attempts == 0

    async def front(self) -> FrontDocument:
        """Wait for the front and return it. Planning goes on if the waiting task is cancelled.

        Raises:
            WorkerLost: Too many workers died over it.
            Cancelled: It was cancelled before a tour was found.
            DeadlineExceeded: It took too long, and no tour was found.
        """
        return await asyncio.shield(self._future)

    async def final(self, record: Record) -> Record:
        """Wait for the end, and return the record of this submission as it is then.

        Raises:
            WorkerLost: Too many workers died over it.
            ShuttingDown: The pool was closed before.
        """
        try:
            front = await self.front()
        except (WorkerLost, ShuttingDown):
            raise
        except (Cancelled, DeadlineExceeded):  # at most an earlier attempt has found something
            return as_ended(record, record.front, self.stop_reason, self._seconds)
        except Exception as error:
            return as_failed(record, error, self.best_front or record.front)
        return as_finished(record, front, self.stop_reason)

    def when_ended(self, callback: Callable[[], object]) -> None:
        """Register a function to be called soon after the end."""
        self._future.add_done_callback(lambda _: callback())

    def wait(self, compiling: Compiling) -> None:
        """Note the progress of a compilation that the submission may have to wait for."""
        self.compiling = compiling
        self._on_change()

    def begin(self) -> None:
        """Count an attempt: a worker begins."""
        self.attempts += 1
        self.compiling = None
        self._on_change()

    def report(self, progress: Progress, front: FrontDocument) -> None:
        """Take the worker's report, unless it has ended."""
        if self.ended:
            return
        self.progress = progress
        self.best_front = front
        self._on_change()

    def finish(self, front: FrontDocument) -> None:
        """End with a front, unless it has ended."""
        if self.ended:
            return
        self._cancel_timer()
        late = self.stop_reason is DeadlineExceeded
        self._future.set_result(front.ended(self._seconds, late=late))

    def fail(self, error: Exception) -> None:
        """End with an error, unless it has ended."""
        if self.ended:
            return
        self._cancel_timer()
        self._future.set_exception(error)
        # Read once, so that asyncio does not warn if nobody waits for it.
        self._future.exception()

    def cut_short(self) -> None:
        """End with the best front so far; without one, with the reason of the stop."""
        if self.best_front is None:
            self.fail((self.stop_reason or Cancelled)())
        else:
            self.finish(self.best_front)

    @property
    def _seconds(self) -> float:
        return self.waited + perf_counter() - self._submitted

    def _cancel_timer(self) -> None:
        if self.timer is not None:
            self.timer.cancel()
