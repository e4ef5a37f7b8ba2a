"""Worker processes behind a bounded queue. The event loop gives out work and never computes.

A process that is lost takes nothing along: its work is done again by another, once, and a fresh
process takes its place.
"""

import asyncio
import logging
from collections import deque
from collections.abc import Callable
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
from service.jobs.submission import MOST_ATTEMPTS, Submission
from service.jobs.worker_process import MakePlanner, Process
from service.requests.task import Work

GRACE = 0.15  # seconds for work to come to an end before its process is ended
_PAUSE = 1.0  # seconds before a process that could not even start is replaced


@dataclass(eq=False)
class _Worker:
    """One worker process and what it is at."""

    process: Process
    started: bool = False
    warming: bool = False
    warm: bool = False
    order: Submission | None = None


class WorkerPool:
    """So many processes, and so many orders that may wait for one.

    The first process compiles the search, and the others load what it has compiled; meanwhile
    all answer what the network alone can answer. No order is worked on for more than `seconds`.
    `planned` is told of every front.
    """

    def __init__(
        self,
        make_planner: MakePlanner,
        *,
        workers: int,
        queue: int,
        seconds: float = 90.0,
        planned: Callable[[FrontDocument], None] = lambda _: None,
    ) -> None:
        self._make_planner = make_planner
        self._count = workers
        self._places = workers + queue
        self._seconds = seconds
        self._planned = planned
        self._hands: list[_Worker] = []
        self._waiting: deque[Submission] = deque()
        self._numbers = count()
        self._tenders: list[asyncio.Task[None]] = []
        self._was_warm = False
        self._closed = False
        self._lost = 0
        self._log = logging.getLogger("paretour")

    @property
    def waiting(self) -> int:
        """How many orders wait."""
        return len(self._waiting)

    @property
    def working(self) -> int:
        """How many orders are being worked on."""
        return sum(hand.order is not None for hand in self._hands)

    @property
    def lost(self) -> int:
        """How many processes were lost and replaced."""
        return self._lost

    @property
    def pids(self) -> list[int | None]:
        """The numbers of the processes."""
        return [hand.process.pid for hand in self._hands]

    async def start(self) -> None:
        """Start the processes, without waiting until they are ready."""
        self._tenders = [asyncio.create_task(self._tend()) for _ in range(self._count)]

    async def close(self) -> None:
        """Take no more work, drop what is unfinished, and end the processes."""
        self._closed = True
        for order in [*self._waiting, *(hand.order for hand in self._hands if hand.order)]:
            order.failed(ShuttingDown())
        self._waiting.clear()
        for tender in self._tenders:
            tender.cancel()
        await asyncio.gather(*self._tenders, return_exceptions=True)

    def check_open(self) -> None:
        """Nothing, if work is taken.

        Raises:
            ShuttingDown: no more work is taken.
        """
        if self._closed:
            raise ShuttingDown

    def check_place(self) -> None:
        """Nothing, if there is a place for one more order.

        Raises:
            QueueFull: there is none.
        """
        if self.waiting + self.working >= self._places:
            raise QueueFull

    def check_warm(self) -> None:
        """Nothing, if orders may need compiled code: a replacement will soon have it, too.

        Raises:
            WarmingUp: it is not there yet.
        """
        if not self._was_warm:
            raise WarmingUp

    def check_ready(self) -> None:
        """Nothing, if there is a process that takes work of every kind.

        Raises:
            ShuttingDown: no more work is taken.
            WarmingUp: there is no such process yet, or not at the moment.
        """
        self.check_open()
        if not any(hand.warm for hand in self._hands):
            raise WarmingUp

    def order(
        self, work: Work, tell: Callable[[], None] = lambda: None, patient: bool = False
    ) -> Submission:
        """Hand in work.

        Raises:
            QueueFull: the queue is full.
            ShuttingDown: no more work is taken.
        """
        self.check_open()
        self.check_place()
        order = Submission(next(self._numbers), work, tell, patient)
        if not patient:
            self._limit(order)
        self._waiting.append(order)
        self._give_out()
        return order

    def stop(self, order: Submission, why: type[Cancelled | DeadlineExceeded] = Cancelled) -> None:
        """End an order at once, with the front found so far, if there is one."""
        if order.ended or order.stopped:
            return
        order.stopped = why
        for hand in self._hands:
            if hand.order is order:
                hand.process.send(Stop(order.number))
                asyncio.get_running_loop().call_later(GRACE, self._insist, hand, order)
                return
        self._waiting.remove(order)
        order.cut_short()

    def _insist(self, hand: _Worker, order: Submission) -> None:
        if hand.order is order:
            hand.process.kill()

    def _limit(self, order: Submission) -> None:
        if order.timer is None:
            loop = asyncio.get_running_loop()
            order.timer = loop.call_later(self._seconds, self.stop, order, DeadlineExceeded)

    async def _tend(self) -> None:
        """Keep one process at work."""
        while True:
            hand = _Worker(await Process.start(self._make_planner))
            self._hands.append(hand)
            try:
                async for message in hand.process.messages():
                    self._hear(hand, message)
                self._lost += 1
                self._log.warning("worker %s was lost and is replaced", hand.process.pid)
            finally:
                hand.process.kill()
                self._hands.remove(hand)
                self._take_back(hand)
                await hand.process.gone()
            if not hand.started:
                await asyncio.sleep(_PAUSE)

    def _take_back(self, hand: _Worker) -> None:
        """See to what a process that is gone has left."""
        order = hand.order
        if order is not None and not order.ended:
            if order.stopped:
                order.cut_short()
            elif order.attempts >= MOST_ATTEMPTS:
                order.failed(WorkerLost())
            else:
                self._waiting.appendleft(order)
        self._warm_up()
        self._give_out()

    def _hear(self, hand: _Worker, message: object) -> None:
        order = hand.order
        match message:
            case Started():
                hand.started = True
            case Warm():
                hand.warm = self._was_warm = True
            case Found(snapshot=snapshot) if order is not None:
                order.hear(snapshot)
                return
            case Done(front=front) if order is not None:
                order.done(front)
                self._planned(front)
                hand.order = None
            case Failed() if order is not None and order.stopped:
                order.cut_short()
                hand.order = None
            case Failed(error=error) if order is not None:
                order.failed(error)
                hand.order = None
        self._warm_up()
        self._give_out()

    def _warm_up(self) -> None:
        """Let one process compile, and once one has, the others load."""
        for hand in self._hands:
            alone = not any(other.warming for other in self._hands)
            if hand.started and not hand.warming and (self._was_warm or alone):
                hand.warming = True
                hand.process.send(WarmUp())

    def _give_out(self) -> None:
        for hand in self._hands:
            # Before the first is warm, nothing that needs compiled code is let in.
            able = hand.warm if self._was_warm else hand.started
            if able and hand.order is None and self._waiting:
                order = self._waiting.popleft()
                hand.order = order
                order.begin()
                self._limit(order)
                hand.process.send(Do(order.number, order.work.task or order.work))
