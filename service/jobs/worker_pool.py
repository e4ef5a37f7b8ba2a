"""A pool of worker processes with a queue: replaces those that die, and stops what takes too long.

The first process compiles the search, and the others load what it has compiled. Until then all of
them run tasks that need the network alone.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count

from service.errors import (
    Cancelled,
    DeadlineExceeded,
    QueueFull,
    ShuttingDown,
    WarmingUp,
    WorkerLost,
)
from service.jobs.front_document import FrontDocument
from service.jobs.messages import Do, Done, Failed, Found, Started, Stop, Warm, WarmUp
from service.jobs.record import StopReason
from service.jobs.runner import MakeRunner
from service.jobs.submission import MOST_ATTEMPTS, Submission
from service.jobs.worker_process import WorkerProcess
from service.requests.task import TaskSource

GRACE = 0.15  # seconds for a task to stop by itself before its process is killed
_PAUSE = 1.0  # seconds before a process that could not even start is replaced


@dataclass(eq=False)
class _Worker:
    """A worker process, its stage, and the submission that it runs."""

    process: WorkerProcess
    started: bool = False
    warming: bool = False
    warm: bool = False
    submission: Submission | None = None


class WorkerPool:
    """So many worker processes, and a queue of so many submissions beside those that they run.

    Args:
        make_runner: Called in each process; it must be picklable.
        workers: How many processes there are.
        queue: How many submissions may wait while all of these are busy.
        seconds: The time limit of a submission.
        on_front: Called with every front as the worker wrote it.
    """

    def __init__(
        self,
        make_runner: MakeRunner,
        *,
        workers: int,
        queue: int,
        seconds: float = 90.0,
        on_front: Callable[[FrontDocument], None] = lambda _: None,
    ) -> None:
        self._make_runner = make_runner
        self._count = workers
        self._places = workers + queue
        self._seconds = seconds
        self._on_front = on_front
        self._workers: list[_Worker] = []
        self._queue: deque[Submission] = deque()
        self._numbers = count()
        self._keepers: list[asyncio.Task[None]] = []
        self._was_warm = False
        self._closed = False
        self._lost = 0
        self._log = logging.getLogger("paretour")

    @property
    def waiting(self) -> int:
        """The number of submissions in the queue."""
        return len(self._queue)

    @property
    def working(self) -> int:
        """The number of submissions that are being run."""
        return len(self.running)

    @property
    def lost(self) -> int:
        """The number of processes that were lost and replaced."""
        return self._lost

    @property
    def pids(self) -> list[int | None]:
        """The ids of the processes."""
        return [worker.process.pid for worker in self._workers]

    @property
    def running(self) -> Mapping[Submission, int | None]:
        """The submissions that are being run, and the id of the process of each."""
        return {each.submission: each.process.pid for each in self._workers if each.submission}

    async def start(self) -> None:
        """Start the processes, and return before they are ready."""
        self._keepers = [asyncio.create_task(self._keep_worker()) for _ in range(self._count)]

    async def close(self) -> None:
        """Take no more submissions, fail those that are unfinished, and kill the processes."""
        self._closed = True
        for submission in [*self._queue, *self.running]:
            submission.fail(ShuttingDown())
        self._queue.clear()
        for keeper in self._keepers:
            keeper.cancel()
        await asyncio.gather(*self._keepers, return_exceptions=True)

    def check_open(self) -> None:
        """Raise ShuttingDown when the pool is closed."""
        if self._closed:
            raise ShuttingDown

    def check_place(self) -> None:
        """Raise QueueFull when the queue is full."""
        if self.waiting + self.working >= self._places:
            raise QueueFull

    def check_warm(self) -> None:
        """Raise WarmingUp until one process has compiled the search: others will soon load it."""
        if not self._was_warm:
            raise WarmingUp

    def check_ready(self) -> None:
        """Raise ShuttingDown when closed, WarmingUp while no process has the compiled search."""
        self.check_open()
        if not any(worker.warm for worker in self._workers):
            raise WarmingUp

    def submit(
        self,
        source: TaskSource,
        on_change: Callable[[], None] = lambda: None,
        patient: bool = False,
    ) -> Submission:
        """Queue a task. The arguments are those of Submission.

        Raises:
            QueueFull: The queue is full.
            ShuttingDown: The pool is closed.
        """
        self.check_open()
        self.check_place()
        submission = Submission(next(self._numbers), source, on_change, patient)
        if not patient:
            self._start_timer(submission)
        self._queue.append(submission)
        self._assign()
        return submission

    def stop(self, submission: Submission, reason: StopReason = Cancelled) -> None:
        """End a submission with the best front so far; return at once."""
        if submission.ended or submission.stop_reason:
            return
        submission.stop_reason = reason
        for worker in self._workers:
            if worker.submission is submission:
                worker.process.send(Stop(submission.number))
                loop = asyncio.get_running_loop()
                loop.call_later(GRACE, self._kill_if_still_running, worker, submission)
                return
        self._queue.remove(submission)
        submission.cut_short()

    def _kill_if_still_running(self, worker: _Worker, submission: Submission) -> None:
        if worker.submission is submission:
            worker.process.kill()

    def _start_timer(self, submission: Submission) -> None:
        if submission.timer is None:
            loop = asyncio.get_running_loop()
            submission.timer = loop.call_later(
                self._seconds, self.stop, submission, DeadlineExceeded
            )

    async def _keep_worker(self) -> None:
        """Keep one process running: when it dies, start another."""
        while True:
            worker = _Worker(await WorkerProcess.start(self._make_runner))
            self._workers.append(worker)
            try:
                async for message in worker.process.messages():
                    self._handle(worker, message)
                self._lost += 1
                self._log.warning("worker %s was lost and is replaced", worker.process.pid)
            finally:
                worker.process.kill()
                self._workers.remove(worker)
                self._requeue_from(worker)
                await worker.process.join()
            if not worker.started:
                await asyncio.sleep(_PAUSE)

    def _requeue_from(self, worker: _Worker) -> None:
        """Queue the submission of a lost worker once more, or end it."""
        submission = worker.submission
        if submission is not None and not submission.ended:
            if submission.stop_reason:
                submission.cut_short()
            elif submission.attempts >= MOST_ATTEMPTS:
                submission.fail(WorkerLost())
            else:
                self._queue.appendleft(submission)
        self._warm_up()
        self._assign()

    def _handle(self, worker: _Worker, message: object) -> None:
        submission = worker.submission
        match message:
            case Started():
                worker.started = True
            case Warm():
                worker.warm = self._was_warm = True
            case Found() if submission is not None:
                submission.report(message.progress, message.front)
                return
            case Done(front=front) if submission is not None:
                submission.finish(front)
                self._on_front(front)
                worker.submission = None
            case Failed() if submission is not None and submission.stop_reason:
                submission.cut_short()
                worker.submission = None
            case Failed(error=error) if submission is not None:
                submission.fail(error)
                worker.submission = None
        self._warm_up()
        self._assign()

    def _warm_up(self) -> None:
        """Let one process compile the search, and once it has, the others load it."""
        for worker in self._workers:
            first = not any(other.warming for other in self._workers)
            if worker.started and not worker.warming and (self._was_warm or first):
                worker.warming = True
                worker.process.send(WarmUp())

    def _assign(self) -> None:
        """Send queued submissions to idle processes."""
        for worker in self._workers:
            # Before the first is warm, no task that needs compiled code is admitted.
            able = worker.warm if self._was_warm else worker.started
            if able and worker.submission is None and self._queue:
                submission = self._queue.popleft()
                worker.submission = submission
                submission.begin()
                self._start_timer(submission)
                source = submission.source
                worker.process.send(Do(submission.number, source.task or source))
