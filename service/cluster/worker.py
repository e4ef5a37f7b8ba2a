"""The worker of Celery: a process that gives out records to processes that plan."""

import ctypes
import logging
import os
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.sharedctypes import RawValue
from socket import gethostname
from threading import Timer
from typing import Any

from celery import Celery, current_task
from celery.exceptions import Reject
from celery.signals import setup_logging, worker_process_init, worker_shutting_down

from service.cluster.celery_app import TASK
from service.cluster.hand import Drained, Draining, Hand

MakeHand = Callable[[Draining], Hand]


@dataclass(frozen=True, kw_only=True)
class Crew:
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
        self._hand: Hand | None = None
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
