"""A worker of the cluster: Celery with a pool of processes, each planning one record at a time.

In each process a `RecordWorker` plans. Another thread checks whether the record is still
wanted. If planning does not stop at once, the thread stores the best front so far; if it does not
stop for seconds, the thread kills the process, which Celery replaces.
"""

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
from service.front import Progress
from service.jobs.deadline import Deadline
from service.jobs.record import Record, StopReason, as_ended, as_failed
from service.jobs.runner import MakeRunner, Reporter, Runner
from service.jobs.submission import MOST_ATTEMPTS
from service.jobs.workers.worker_pool import GRACE, STOP_SECONDS
from service.kinds.front_document import FrontDocument

_CHECK_EVERY = 0.05  # seconds between two checks whether a record is still wanted
_TERMINATE_EVERY = 0.02  # seconds, while a stopped task runs: a call may be about to begin
_HEARTBEAT_EVERY = 1.0  # seconds between two signs of life

IsDraining = Callable[[], bool]


class Draining(Exception):
    """The worker shuts down and leaves its record to another."""


class RecordWorker:
    """Plans the fronts of records in this process, each within a time limit."""

    def __init__(
        self, runner: Runner, store: WorkerStore, seconds: float, is_draining: IsDraining
    ) -> None:
        self._runner = runner
        self._store = store
        self._seconds = seconds
        self._is_draining = is_draining

    def start(self) -> None:
        """Warm up, and send heartbeats from then on."""
        self._runner.warm_up()
        Thread(target=self._send_heartbeats, name="heartbeat", daemon=True).start()

    def plan(self, id: str, known_lost: bool) -> None:  # noqa: A002
        """Plan the front of the record whose turn it is, unless none waits.

        Args:
            id: The id in the message, which stands for a turn.
            known_lost: Whether the worker that had the message before is lost.

        Raises:
            Draining: The worker shuts down; the record is queued again.
        """
        stored = self._store.begin(id, known_lost)
        if stored is None:
            return
        if stored.attempts > MOST_ATTEMPTS:
            self._store.finish(as_failed(stored.record, WorkerLost(), stored.record.front))
            return
        deadline = Deadline.after(self._seconds)
        supervisor = _Supervisor(
            stored, self._store, deadline, self._is_draining, self._runner.terminate
        )
        result = self._result(stored, supervisor)
        supervisor.end()
        if supervisor.reason is Draining:
            self._store.hand_back(stored.record.id)
            raise Draining
        if supervisor.reason is not TakenOver:
            self._store.finish(result)

    def _result(self, stored: StoredRecord, supervisor: "_Supervisor") -> Record:
        source = stored.record.source
        assert source is not None
        try:
            reporter = Reporter(supervisor.report)
            task = self._runner.read(source)
            front = self._runner.run(task, supervisor.stop.is_set, reporter)
        except Exception as error:
            if supervisor.reason is None:
                return as_failed(stored.record, error, supervisor.front)
            return supervisor.ended(supervisor.front)
        return supervisor.ended(front)

    def _send_heartbeats(self) -> None:
        while True:
            self._store.send_heartbeat()
            time.sleep(_HEARTBEAT_EVERY)


class _Supervisor:
    """Checks in a thread whether a record is still wanted, and ends its planning if it is not."""

    def __init__(
        self,
        stored: StoredRecord,
        store: WorkerStore,
        deadline: Deadline,
        is_draining: IsDraining,
        terminate: Callable[[], None],
    ) -> None:
        self.stop = Event()
        self.reason: StopReason | type[TakenOver | Draining] | None = None
        self.front = stored.record.front
        self._stored = stored
        self._store = store
        self._deadline = deadline
        self._is_draining = is_draining
        self._terminate = terminate
        self._over = Event()
        self._thread = Thread(target=self._check_often, name="supervisor", daemon=True)
        self._thread.start()

    def report(self, progress: Progress, front: FrontDocument) -> None:
        """Store the progress and the best front so far."""
        self.front = front
        self._store.report(self._stored.record.id, progress, front)

    def ended(self, front: FrontDocument) -> Record:
        """Return the record, ended now with this front."""
        reason = self.reason if self.reason in (Cancelled, DeadlineExceeded) else None
        seconds = time.time() - self._stored.requested_at
        return as_ended(self._stored.record, front, reason, seconds)

    def end(self) -> None:
        """Stop checking: planning is over."""
        self._over.set()
        self._thread.join()

    def _check_often(self) -> None:
        while not self._over.wait(_CHECK_EVERY):
            self.reason = self._current_reason()
            if self.reason is not None:
                self.stop.set()
                self._wait_or_kill()

    def _wait_or_kill(self) -> None:
        """Wait until planning has stopped; kill this process if it does not."""
        if self._is_over_within(GRACE):
            return
        self._let_go()
        if not self._is_over_within(STOP_SECONDS):
            os.kill(os.getpid(), signal.SIGKILL)

    def _is_over_within(self, seconds: float) -> bool:
        """Terminate the runner's calls again and again, and return whether planning is over."""
        deadline = Deadline.after(seconds)
        while not deadline.over():
            self._terminate()
            if self._over.wait(_TERMINATE_EVERY):
                return True
        return False

    def _current_reason(self) -> StopReason | type[TakenOver | Draining] | None:
        if self._deadline.over():
            return DeadlineExceeded
        return Draining if self._is_draining() else self._store.stop_reason(self._stored.record.id)

    def _let_go(self) -> None:
        """Store the record as it is known, and give it up although planning goes on."""
        if self.reason is Draining:
            self._store.hand_back(self._stored.record.id)
        elif self.reason is not TakenOver:
            self._store.finish(self.ended(self.front))


def make_record_worker(
    make_runner: MakeRunner, redis_url: str, seconds: float, is_draining: IsDraining
) -> RecordWorker:
    """Return the worker of this process, with a unique name."""
    name = f"{gethostname()}:{os.getpid()}:{uuid.uuid4().hex}"
    return RecordWorker(make_runner(), WorkerStore(redis_url, name), seconds, is_draining)


MakeRecordWorker = Callable[[IsDraining], RecordWorker]


@dataclass(frozen=True, kw_only=True)
class CeleryWorker:
    """A Celery worker with a number of processes.

    When it is told to shut down, its processes have `drain_seconds` to finish their records, and
    then hand them back.
    """

    celery: Celery
    make_record_worker: MakeRecordWorker
    workers: int
    drain_seconds: float

    def run(self) -> int:
        """Plan records until told to shut down, and return the exit status."""
        pool = _ProcessPool(self.make_record_worker, self.drain_seconds)
        self.celery.task(pool.plan, name=TASK)
        worker_process_init.connect(pool.init_process)
        worker_shutting_down.connect(pool.shut_down)
        setup_logging.connect(_keep_logging)
        worker = self.celery.Worker(
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


class _ProcessPool:
    """Celery's callbacks: those in each forked process, and the one in their parent."""

    def __init__(self, make_record_worker: MakeRecordWorker, drain_seconds: float) -> None:
        self._make_record_worker = make_record_worker
        self._drain_seconds = drain_seconds
        self._record_worker: RecordWorker | None = None
        # Shared memory without a lock: a process could die while it holds one.
        self._draining = RawValue(ctypes.c_bool, False)

    def init_process(self, **_: Any) -> None:
        """Make the worker of a process after its fork, which no session or connection survives."""
        try:
            self._record_worker = self._make_record_worker(lambda: self._draining.value)
            self._record_worker.start()
        except Exception:
            logging.getLogger("paretour").exception("a worker could not begin")
            raise SystemExit(1) from None

    def plan(self, id: str) -> None:  # noqa: A002
        """Plan a record. If its message was delivered before, that worker was lost."""
        assert self._record_worker is not None
        redelivered = bool(current_task.request.delivery_info.get("redelivered"))
        try:
            self._record_worker.plan(id, known_lost=redelivered)
        except Draining:
            raise Reject(requeue=True) from None

    def shut_down(self, **_: Any) -> None:
        """Begin to drain after `drain_seconds`, in the parent of the processes."""
        timer = Timer(self._drain_seconds, self._drain)
        timer.daemon = True
        timer.start()

    def _drain(self) -> None:
        self._draining.value = True


def _keep_logging(**_: Any) -> None:
    """Keep Celery from configuring logging, which the caller has done."""
