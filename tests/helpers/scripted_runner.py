"""A runner for tests of worker processes, which does what the body of a request names."""

import os
import signal
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np

from service.instance import Instance
from service.jobs.front_document import FrontDocument, encode_front
from service.jobs.runner import Report
from service.jobs.workers.worker_pool import WorkerPool
from service.planner import Front, PlanOptions
from service.requests.task import Task, TaskSource
from service.search.improve import Progress

_TERMINATED = Event()  # of the process that runs


@dataclass(frozen=True)
class ScriptedRunner:
    """A runner that fails, dies, waits, hangs, calls or reports, as the body says.

    Each death takes one byte from the file `lives`; where none is left it plans instead. With
    `warm`, the path of a file, its warm-up lasts until the file exists.
    """

    lives: Path = Path("/nowhere")
    warm: Path | None = None

    def warm_up(self) -> None:
        """Wait until the file exists."""
        while self.warm is not None and not self.warm.exists():
            time.sleep(0.01)

    def run(  # noqa: C901
        self, task: TaskSource | Task, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        """Return a front of one tour, after what the body names, or the actor of a task."""
        body = task.actor.encode() if isinstance(task, Task) else task.body
        match body:
            case b"fail":
                raise KeyError("city")
            case b"die":
                self._die_once_more()
            case b"wait" | b"stop slowly":
                while not stop():
                    time.sleep(0.001)
                time.sleep(body == b"stop slowly")
                return document("cancelled")
            case b"call":
                _TERMINATED.wait()
                raise RuntimeError("terminated")
            case b"hang":
                time.sleep(600)
            case b"report and hang":
                began = time.monotonic()
                while True:
                    seconds = time.monotonic() - began
                    report(Progress(seconds, 0.5, 7), lambda _: document(None))
                    time.sleep(0.01)
        return document("converged")

    def terminate(self) -> None:
        """End a call."""
        _TERMINATED.set()

    def _die_once_more(self) -> None:
        if left := self.lives.read_bytes():
            self.lives.write_bytes(left[1:])
            os.kill(os.getpid(), signal.SIGKILL)


def document(terminated: str | None, gained: float | None = None) -> FrontDocument:
    """Return a front of one tour through three cities."""
    front = Front(
        tours=np.arange(3)[np.newaxis],
        constructed=1,
        points=np.ones((1, 2)),
        found=1,
        scale=np.ones(2),
        reference_point=np.array([3.0, 3.0]),
        terminated=terminated,
        timings={"construction": 1.0},
        gained=gained,
    )
    return encode_front(front, {"name": "pa-one", "digest": "0" * 64})


def source(body: bytes = b"") -> TaskSource:
    """Return a task's source; its body says what the runner does."""
    return TaskSource("front", body)


def brief_source(body: bytes = b"") -> TaskSource:
    """Return the source of a brief task, parsed already, that says the same."""
    instance = Instance(coordinates=np.random.default_rng(0).random((3, 4)))
    options = PlanOptions(angles=np.array([45.0]), size=1)
    return TaskSource(
        "front", body, task=Task(subject=instance, options=options, actor=body.decode())
    )


def _same(runner: ScriptedRunner) -> ScriptedRunner:
    return runner


@asynccontextmanager
async def worker_pool(
    runner: ScriptedRunner | None = None, workers: int = 1, queue: int = 0, **options: Any
) -> AsyncIterator[WorkerPool]:
    """Run a pool of processes with such a runner until the block ends."""
    make_runner = partial(_same, runner or ScriptedRunner())
    pool = WorkerPool(make_runner, workers=workers, queue=queue, **options)
    await pool.start()
    try:
        yield pool
    finally:
        await pool.close()
