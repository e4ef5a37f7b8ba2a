"""A pool of worker processes with a queue: gives them tasks, and stops what takes too long.

A task that lacks its costs by road waits until the routing engine has answered. It holds its place
meanwhile, but no process.

Brief tasks that wait share a turn of a process, which answers them together.

Stopping a task does not end its process: the client is answered at once, and the process takes no
new task until it has noticed the stop. It is killed only if it does not notice for seconds. A task
waits until the parts of the compiled code are there that it needs; others overtake it.
"""

import asyncio
import math
from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import count

from service.errors import (
    Cancelled,
    DeadlineExceeded,
    QueueFull,
    ShareFull,
    ShuttingDown,
    WorkerLost,
)
from service.jobs.deadline import Deadline
from service.jobs.fair_queue import FairQueue
from service.jobs.record import StopReason
from service.jobs.submission import MOST_ATTEMPTS, Submission
from service.jobs.workers.messages import Do, Done, Failed, Found, StopTask
from service.jobs.workers.worker_process import MakeRunner
from service.jobs.workers.worker_set import Worker, WorkerSet
from service.kinds.front_document import FrontDocument
from service.kinds.parts import Compiling, Part
from service.kinds.table import parts_of
from service.requests.road_measurer import measured_by_road
from service.requests.task import Task
from service.roads.client import RoadClient

GRACE = 0.15  # seconds for a stopped task to give its front; then its last report is the answer
_MOST_TOGETHER = 4  # brief submissions in one turn of a process, whose answers come together
STOP_SECONDS = 5.0  # seconds for a stopped task to notice before its process is killed


class WorkerPool:
    """A number of worker processes, and a bounded queue of submissions that wait for them.

    Args:
        make_runner: Called in each process; it must be picklable.
        queue: How many submissions may wait while all of these are busy.
        share: The share of all places, of workers and queue, that one client may hold. It may
            always hold one more than there are workers.
        seconds: The time limit of a submission without a deadline.
        attempts: How many processes may be lost over one submission.
        roads: The client of a routing engine.
        stop_seconds: How long a stopped task may go on until its process is killed.
        on_front: Called with every front as the worker wrote it.
        on_failed: Called with the reason where no process gets ready in three tries.
    """

    def __init__(  # noqa: PLR0913  all but the first are keyword-only
        self,
        make_runner: MakeRunner,
        *,
        workers: int,
        queue: int,
        share: float = 1.0,
        seconds: float = 90.0,
        attempts: int = MOST_ATTEMPTS,
        roads: RoadClient | None = None,
        stop_seconds: float = STOP_SECONDS,
        on_front: Callable[[FrontDocument], None] = lambda _: None,
        on_failed: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._workers = WorkerSet(make_runner, workers, self._handle, self._requeue_from, on_failed)
        self._size = workers
        self._places = workers + queue
        # As in service/cluster/records.lua.
        self._places_of_client = max(math.ceil(share * self._places), workers + 1)
        self._seconds = seconds
        self._attempts = attempts
        self._roads = roads
        self._stop_seconds = stop_seconds
        self._on_front = on_front
        self._queue = FairQueue[Submission]()
        self._reserved: set[Submission] = set()
        self._measuring: set[asyncio.Task[None]] = set()
        self._numbers = count()
        self._closed = False

    @property
    def waiting(self) -> int:
        """The number of submissions in the queue."""
        return len(self._queue)

    @property
    def working(self) -> int:
        """The number of processes that run a submission that is not stopped."""
        workers = (worker.submissions.values() for worker in self._workers)
        return sum(any(not each.ended for each in running) for running in workers)

    @property
    def live(self) -> int:
        """The number of processes that have started and live."""
        return sum(worker.started for worker in self._workers)

    @property
    def lost(self) -> int:
        """The number of processes that were lost and replaced."""
        return self._workers.lost

    @property
    def pids(self) -> list[int | None]:
        """The ids of the processes."""
        return [worker.process.pid for worker in self._workers]

    @property
    def running(self) -> Mapping[Submission, int | None]:
        """The submissions that processes run, stopped ones too, and the id of each process."""
        return {
            submission: worker.process.pid
            for worker in self._workers
            for submission in worker.submissions.values()
        }

    async def start(self) -> None:
        """Start the processes, and return before they are ready."""
        await self._workers.start()

    async def close(self) -> None:
        """Take no more submissions, fail those that are unfinished, and kill the processes."""
        self._closed = True
        for submission in [*self._reserved, *self._queue, *self.running]:
            submission.fail(ShuttingDown())
        self._queue = FairQueue[Submission]()
        await self._workers.close()
        if self._roads is not None:
            await self._roads.close()

    def check_open(self) -> None:
        """Raise ShuttingDown when the pool is closed."""
        if self._closed:
            raise ShuttingDown

    def check_place(self, client: str = "") -> None:
        """Raise QueueFull or ShareFull when no place is left for one more task of a client."""
        running = (each for each in self.running if not each.ended)
        clients = [each.client for each in (*self._reserved, *self._queue, *running)]
        if len(clients) >= self._places:
            raise QueueFull
        if clients.count(client) >= self._places_of_client:
            raise ShareFull(self._places_of_client)

    @property
    def compiling(self) -> Compiling | None:
        """The progress of compiling all parts; None before it and after it."""
        return self._workers.compiling

    def check_ready(self) -> None:
        """Raise ShuttingDown when closed, NoWorker or WarmingUp while no process can search."""
        self.check_open()
        self._workers.check_ready()

    def reserve(
        self,
        task: Task,
        on_change: Callable[[], None] = lambda: None,
        deadline: Deadline | None = None,
        client: str = "",
    ) -> Submission:
        """Take a place for a task and return its submission.

        Args:
            on_change: Called when a worker begins, and with each progress.
            deadline: When to stop it; None gives it the pool's `seconds` from when a worker begins.
            client: The client whose turn and place it takes.

        Raises:
            QueueFull: No place is left.
            ShareFull: The client holds its share of the places.
            ShuttingDown: The pool is closed.
        """
        self.check_open()
        self.check_place(client)
        submission = Submission(next(self._numbers), task, on_change, client)
        if deadline is not None:
            self._start_timer(submission, deadline)
        self._reserved.add(submission)
        return submission

    def queue(self, submission: Submission) -> None:
        """Queue a submission that has a place, at once or when its costs by road are there."""
        if self._roads is None or not submission.task.needs_roads:
            self._append(submission)
            return
        measuring = asyncio.create_task(self._measure(submission, self._roads))
        self._measuring.add(measuring)
        measuring.add_done_callback(self._measuring.discard)

    async def _measure(self, submission: Submission, roads: RoadClient) -> None:
        """Ask for the costs by road of a submission, until it ends, and queue it with them."""
        asking = asyncio.create_task(measured_by_road(submission.task, roads))
        submission.when_ended(asking.cancel)
        await asyncio.wait((asking,))
        if not asking.cancelled():
            try:
                submission.task = asking.result()
            except Exception as error:
                submission.fail(error)
        self._append(submission)

    def _append(self, submission: Submission) -> None:
        """Queue a submission, unless it has ended; it gives its reserved place back."""
        self._reserved.discard(submission)
        if not submission.ended:
            self._queue.append(submission)
            self._assign()

    def give_back(self, submission: Submission) -> None:
        """Give a reserved place back."""
        self._reserved.discard(submission)

    def submit(
        self,
        task: Task,
        on_change: Callable[[], None] = lambda: None,
        deadline: Deadline | None = None,
        client: str = "",
    ) -> Submission:
        """Reserve a place for a task and queue it there; arguments and errors are of reserve."""
        submission = self.reserve(task, on_change, deadline, client)
        self.queue(submission)
        return submission

    def stop(self, submission: Submission, reason: StopReason = Cancelled) -> None:
        """End a submission with the best front so far; return at once."""
        if submission.ended or submission.stop_reason:
            return
        submission.stop_reason = reason
        for worker in self._workers:
            if submission.number in worker.submissions:
                worker.process.send(StopTask(submission.number))
                loop = asyncio.get_running_loop()
                loop.call_later(GRACE, submission.cut_short)
                loop.call_later(self._stop_seconds, self._kill_if_still_running, worker, submission)
                return
        self._queue.remove(submission)
        if reason is DeadlineExceeded and not _needs(submission) <= self._workers.compiled:
            submission.fail(self._workers.warming_up())
        submission.cut_short()

    def _kill_if_still_running(self, worker: Worker, submission: Submission) -> None:
        if submission.number in worker.submissions:
            worker.process.kill()

    def _start_timer(self, submission: Submission, deadline: Deadline) -> None:
        loop = asyncio.get_running_loop()
        submission.timer = loop.call_later(deadline.left(), self.stop, submission, DeadlineExceeded)

    def _requeue_from(self, worker: Worker) -> None:
        """Queue the submissions of a lost worker once more, or end them."""
        for submission in reversed(worker.submissions.values()):
            if submission.ended:
                continue
            if submission.stop_reason:
                submission.cut_short()
            elif submission.attempts >= self._attempts:
                submission.fail(WorkerLost())
            else:
                self._queue.put_first(submission)
        self._assign()

    def _handle(self, worker: Worker, message: object) -> None:
        match message:
            case Found():
                worker.submissions[message.number].report(message.progress, message.front)
                return
            case Done() | Failed():
                self._end(worker.submissions.pop(message.number), message)
            case Compiling():
                for submission in self._queue:
                    if not _needs(submission) <= self._workers.compiled:
                        submission.wait(message)
        self._assign()

    def _end(self, submission: Submission, message: Done | Failed) -> None:
        """End a submission with the worker's answer, unless it has ended before."""
        if submission.ended:
            return
        if isinstance(message, Done):
            submission.finish(message.front)
            self._on_front(message.front)
        elif submission.stop_reason:
            submission.cut_short()
        else:
            submission.fail(message.error)

    def _assign(self) -> None:
        """Send queued submissions to idle processes."""
        for worker in self._workers:
            idle = worker.started and not worker.spent and not worker.submissions
            if idle and (taken := self._next_submissions(worker.warm)):
                worker.submissions = {each.number: each for each in taken}
                self._begin(worker)

    def _next_submissions(self, parts: Collection[Part]) -> list[Submission]:
        """Take the next submission from the queue, or of brief ones a worker's share.

        What runs between two networks runs several times as fast when it has just run.

        Args:
            parts: The parts of the compiled code that the worker has.
        """
        share = min(math.ceil(len(self._queue) / self._size), _MOST_TOGETHER)
        taken: list[Submission] = []
        while len(taken) < share and all(each.is_brief for each in taken):
            clients = self._clients(taken)
            following = self._queue.next(clients, lambda each: _needs(each).issubset(parts))
            if following is None or (taken and not following.is_brief):
                break
            self._queue.take(following)
            taken.append(following)
        return taken

    def _clients(self, taken: Sequence[Submission] = ()) -> set[str]:
        """Return the clients of the submissions that run, and of those that are taken to run."""
        return {each.client for each in (*self.running, *taken)}

    def _begin(self, worker: Worker) -> None:
        """Send a worker its submissions."""
        tasks = {}
        for submission in worker.submissions.values():
            submission.begin()
            if submission.timer is None:
                self._start_timer(submission, Deadline.after(self._seconds))
            tasks[submission.number] = submission.task
        try:
            worker.process.send(Do(tasks))
        except Exception as error:
            for submission in worker.submissions.values():
                submission.fail(error)
            worker.submissions = {}


def _needs(submission: Submission) -> frozenset[Part]:
    return parts_of(submission.task)
