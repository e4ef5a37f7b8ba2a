"""A set of worker processes: each is started, warmed up, and replaced when it is lost.

The first process has the code compiled, part by part, and the others load what is compiled.
"""

import asyncio
import logging
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from service.errors import NoWorker, WarmingUp
from service.jobs.cancelling import cancel_all
from service.jobs.submission import Submission
from service.jobs.workers.messages import Stage, Unable, Warm, WarmUp
from service.jobs.workers.worker_process import MakeRunner, WorkerProcess
from service.kinds.parts import Compiling, Part

_SHORTEST_PAUSE = 0.5  # seconds until a process that could not even start is tried again
_LONGEST_PAUSE = 15.0
_MOST_TRIES = 3  # of each process before the first is ready: then a start has failed
_LOG = logging.getLogger("paretour")


@dataclass(eq=False)
class Worker:
    """A worker process, its stage, and the submissions that it runs, by number.

    It has `warm` parts of the compiled code, and was asked to load those in `asked`.
    """

    process: WorkerProcess
    started: bool = False
    warm: set[Part] = field(default_factory=set)
    asked: set[Part] = field(default_factory=set)
    spent: bool = False  # it takes no more submissions
    reason: str = ""  # why it ends, if it has told
    submissions: dict[int, Submission] = field(default_factory=dict)


class WorkerSet:
    """A number of worker processes, each replaced when lost, until the set is closed.

    Args:
        make_runner: Called in each process; it must be picklable.
        on_message: Called with each message of a worker.
        on_lost: Called with each worker that is lost, once it is out of the set.
        on_failed: Called with the reason where no process gets ready in three tries.

    Attributes:
        lost: The number of processes that were lost and replaced.
        compiled: The parts of the code that a process has compiled, or loaded.
        compiling: How far the first process is that compiles; None before, and when all is there.
    """

    def __init__(
        self,
        make_runner: MakeRunner,
        size: int,
        on_message: Callable[[Worker, object], None],
        on_lost: Callable[[Worker], None],
        on_failed: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._make_runner = make_runner
        self._size = size
        self._on_message = on_message
        self._on_lost = on_lost
        self._on_failed = on_failed
        self._workers: list[Worker] = []
        self._keepers: list[asyncio.Task[None]] = []
        self._failing = False
        self._failures = 0
        self._reason = ""
        self.lost = 0
        self.compiled: set[Part] = set()
        self.compiling: Compiling | None = None

    def __iter__(self) -> Iterator[Worker]:
        """Iterate over the present workers."""
        return iter(self._workers)

    async def start(self) -> None:
        """Start the processes, and return before they are ready."""
        self._keepers = [asyncio.create_task(self._keep_worker()) for _ in range(self._size)]

    async def close(self) -> None:
        """Kill the processes."""
        await cancel_all(self._keepers)

    def check_ready(self) -> None:
        """Raise NoWorker while none can be started, WarmingUp while none can search few cities."""
        if self._failing and not any(worker.started for worker in self._workers):
            raise NoWorker(self._reason)
        if not any(Part.FEW_CITIES in worker.warm for worker in self._workers):
            raise self.warming_up()

    def warming_up(self) -> WarmingUp:
        """Return the refusal of what needs more than is compiled."""
        return WarmingUp() if self.compiling is None else self.compiling.refusal

    async def _keep_worker(self) -> None:
        """Keep one process running until the set is closed, even after failures."""
        while True:
            for seconds in _growing_pauses():
                try:
                    if await self._run_worker():
                        break
                except Exception as error:
                    self._log_failure(error)
                await asyncio.sleep(seconds)

    async def _run_worker(self) -> bool:
        """Start a process, handle its messages until it ends, and return whether it started."""
        worker = Worker(await WorkerProcess.start(self._make_runner))
        self._workers.append(worker)
        try:
            async for message in worker.process.messages():
                self._handle(worker, message)
            if not worker.spent:
                self.lost += 1
                _LOG.warning("worker %s was lost and is replaced", worker.process.pid)
        finally:
            idle = not worker.submissions  # else it may have died of one of them
            worker.process.kill()
            self._workers.remove(worker)
            self._warm_up()
            self._on_lost(worker)
            await worker.process.join()
        if idle and not self.compiled and not worker.spent:
            status = worker.process.exit_status
            self._fail(worker.reason or f"a process ended with status {status} while it loaded")
        return worker.started

    def _log_failure(self, error: Exception) -> None:
        """Log that a process cannot run, once until one has started again."""
        if not self._failing:
            _LOG.error("a worker cannot run, and is tried again", exc_info=error)
        self._failing, self._reason = True, repr(error)
        if not self.compiled:
            self._count_failure()

    def _fail(self, reason: str) -> None:
        """Log and count a process that was lost before any was ready."""
        self._failing, self._reason = True, reason
        _LOG.error("no worker is ready, and the last was lost: %s", reason)
        self._count_failure()

    def _count_failure(self) -> None:
        """Count a process that was of no use before any was ready; the last ends the start."""
        self._failures += 1
        if self._failures == _MOST_TRIES * self._size:
            self._on_failed(self._reason)

    def _handle(self, worker: Worker, message: object) -> None:
        match message:
            case Stage.STARTED:
                worker.started = True
                self._failing = False
            case Warm(part):
                worker.warm.add(part)
                self.compiled.add(part)
                if len(self.compiled) == len(Part):
                    self.compiling = None
            case Compiling():
                self.compiling = message
            case Stage.SPENT:
                worker.spent = True
            case Unable():
                worker.reason = message.reason
        self._warm_up()
        self._on_message(worker, message)

    def _warm_up(self) -> None:
        """Let one process compile everything, and the others load each part once it has that."""
        for worker in self._workers:
            is_compiled = any(other.asked == set(Part) for other in self._workers)
            parts = (self.compiled if is_compiled else set(Part)) - worker.asked
            if worker.started and parts:
                worker.asked |= parts
                worker.process.send(WarmUp(frozenset(parts)))


def _growing_pauses() -> Iterator[float]:
    """Yield seconds to wait, each time twice as many, up to the longest pause."""
    seconds = _SHORTEST_PAUSE
    while True:
        yield seconds
        seconds = min(2 * seconds, _LONGEST_PAUSE)
