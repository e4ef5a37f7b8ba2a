"""A worker of the cluster: Celery processes, each planning one record at a time."""

import ctypes
import logging
import os
import signal
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.sharedctypes import RawValue
from socket import gethostname
from threading import Event, Thread, Timer
from typing import Any

from celery import Celery, current_task
from celery.exceptions import Reject
from celery.signals import setup_logging, worker_process_init, worker_shutting_down

from service.cluster.celery_app import TASK
from service.cluster.records import StoredRecord
from service.cluster.worker_store import TakenOver, WorkerStore
from service.errors import Cancelled, DeadlineExceeded, WorkerLost
from service.jobs.front_document import FrontDocument
from service.jobs.messages import Snapshot
from service.jobs.record import Record, ended, failed
from service.jobs.submission import MOST_ATTEMPTS
from service.jobs.worker_pool import GRACE
from service.jobs.worker_process import MakePlanner, Planner, Reporter

_EVERY = 0.05  # seconds between two looks at whether the work is still wanted
_PRESENT = 1.0  # seconds between two signs of life

Draining = Callable[[], bool]


class Drained(Exception):
    """The worker ends, and leaves its work to another."""


Reason = type[Cancelled | DeadlineExceeded | TakenOver | Drained]


class RecordWorker:
    """Plans what records ask for, each within so many seconds."""

    def __init__(
        self, planner: Planner, ledger: WorkerStore, seconds: float, draining: Draining
    ) -> None:
        self._planner = planner
        self._ledger = ledger
        self._seconds = seconds
        self._draining = draining

    def attend(self) -> None:
        """Get ready, and say from then on that there is a worker."""
        self._planner.warm_up()
        Thread(target=self._be_present, name="present", daemon=True).start()

    def work(self, id: str, known_lost: bool) -> None:  # noqa: A002
        """Do the work of a record, if that is still to do.

        Raises:
            Drained: another worker has to.
        """
        kept = self._ledger.begin(id, known_lost)
        if kept is None:
            return
        if kept.attempts > MOST_ATTEMPTS:
            self._ledger.finish(failed(kept.record, WorkerLost(), kept.record.front))
            return
        watch = _Watch(kept, self._ledger, time.monotonic() + self._seconds, self._draining)
        found = self._found(kept, watch)
        watch.end()
        if watch.why is Drained:
            self._ledger.hand_back(id)
            raise Drained
        if watch.why is not TakenOver:
            self._ledger.finish(found)

    def _found(self, kept: StoredRecord, watch: "_Watch") -> Record:
        work = kept.record.work
        assert work is not None
        try:
            front = self._planner.plan(work, watch.stop.is_set, Reporter(watch.tell))
        except Exception as error:
            if watch.why is None:
                return failed(kept.record, error, watch.front)
            return watch.ended(watch.front)
        return watch.ended(front)

    def _be_present(self) -> None:
        while True:
            self._ledger.present()
            time.sleep(_PRESENT)


class _Watch:
    """Looks, while work goes on, whether it is still wanted, and ends what does not listen."""

    def __init__(
        self, kept: StoredRecord, ledger: WorkerStore, deadline: float, draining: Draining
    ) -> None:
        self.stop = Event()
        self.why: Reason | None = None
        self.front = kept.record.front
        self._kept = kept
        self._ledger = ledger
        self._deadline = deadline
        self._draining = draining
        self._over = Event()
        self._thread = Thread(target=self._look, name="watch", daemon=True)
        self._thread.start()

    def tell(self, snapshot: Snapshot) -> None:
        """Take note of how far the work has come."""
        self.front = snapshot.front
        self._ledger.tell(self._kept.record.id, snapshot)

    def ended(self, front: FrontDocument) -> Record:
        """The record, which ends now."""
        why = self.why if self.why in (Cancelled, DeadlineExceeded) else None
        return ended(self._kept.record, front, why, time.time() - self._kept.asked)

    def end(self) -> None:
        """The work is over."""
        self._over.set()
        self._thread.join()

    def _look(self) -> None:
        while not self._over.wait(_EVERY):
            self.why = self._reason()
            if self.why is not None:
                self.stop.set()
                if not self._over.wait(GRACE):
                    self._insist()

    def _reason(self) -> Reason | None:
        if time.monotonic() > self._deadline:
            return DeadlineExceeded
        return Drained if self._draining() else self._ledger.reason(self._kept.record.id)

    def _insist(self) -> None:
        if self.why is Drained:
            self._ledger.hand_back(self._kept.record.id)
        elif self.why is not TakenOver:
            self._ledger.finish(self.ended(self.front))
        os.kill(os.getpid(), signal.SIGKILL)


def make_hand(
    make_planner: MakePlanner, redis_url: str, seconds: float, draining: Draining
) -> RecordWorker:
    """A hand of this process, with a name that no other has."""
    worker = f"{gethostname()}:{os.getpid()}:{uuid.uuid4().hex}"
    return RecordWorker(make_planner(), WorkerStore(redis_url, worker), seconds, draining)


MakeHand = Callable[[Draining], RecordWorker]


@dataclass(frozen=True, kw_only=True)
class CeleryWorker:
    """So many processes. Told to end, they finish within so many seconds or hand back."""

    queue: Celery
    make_hand: MakeHand
    workers: int
    drain_seconds: float

    def run(self) -> int:
        """Work until told to end; the exit status."""
        bench = _Bench(self.make_hand, self.drain_seconds)
        self.queue.task(bench.plan, name=TASK)
        worker_process_init.connect(bench.begin)
        worker_shutting_down.connect(bench.end)
        setup_logging.connect(_leave)
        worker = self.queue.Worker(
            hostname=f"paretour@{gethostname()}-{os.getpid()}",
            pool="prefork",
            concurrency=self.workers,
            quiet=True,
            without_gossip=True,
            without_mingle=True,
            without_heartbeat=True,
        )
        worker.start()
        return int(worker.exitcode or 0)


class _Bench:
    """Where each process of the pool finds its hand, and all of them when to come to an end."""

    def __init__(self, make_hand: MakeHand, drain_seconds: float) -> None:
        self._make_hand = make_hand
        self._drain_seconds = drain_seconds
        self._hand: RecordWorker | None = None
        # Memory of all processes, without a lock that one of them could die with.
        self._draining = RawValue(ctypes.c_bool, False)

    def begin(self, **_: Any) -> None:
        """In a process that was forked, which neither onnxruntime nor a connection survives."""
        try:
            self._hand = self._make_hand(lambda: self._draining.value)
            self._hand.attend()
        except Exception:
            logging.getLogger("paretour").exception("a worker could not begin")
            raise SystemExit(1) from None

    def plan(self, id: str) -> None:  # noqa: A002
        """Work on a record; a message that comes again is of a process that was lost."""
        assert self._hand is not None
        again = bool(current_task.request.delivery_info.get("redelivered"))
        try:
            self._hand.work(id, known_lost=again)
        except Drained:
            raise Reject(requeue=True) from None

    def end(self, **_: Any) -> None:
        """In the process that was told to end."""
        timer = Timer(self._drain_seconds, self._drain)
        timer.daemon = True
        timer.start()

    def _drain(self) -> None:
        self._draining.value = True


def _leave(**_: Any) -> None:
    """Logging stays as it is: whoever runs a crew has said how it is done."""
