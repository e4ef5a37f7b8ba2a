"""A runner for tests of worker processes, which does what the actor of a task names."""

import os
import signal
import time
from collections.abc import AsyncIterator, Callable, Collection
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np

from service.front import Front, PlanOptions
from service.jobs.workers.worker_pool import WorkerPool
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report
from service.kinds.parts import Compiling, Part
from service.kinds.tour_document import encode_front
from service.preferences import spread
from service.requests.stops import Plane, Stops
from service.requests.task import Task
from service.watch import Progress

_TERMINATED = Event()  # of the process that runs


@dataclass(frozen=True)
class ScriptedRunner:
    """A runner that fails, dies, waits, hangs, calls or reports, as it says.

    Each death takes one byte from the file `lives`; where none is left it plans instead. With
    `warm`, the path of a file, its warm-up lasts until the file exists.
    """

    lives: Path = Path("/nowhere")
    warm: Path | None = None

    def warm_up(self, parts: Collection[Part], tell: Callable[[Part | Compiling], None]) -> None:
        """Wait until the file exists."""
        while self.warm is not None and not self.warm.exists():
            tell(Compiling(0.5, 20.0))
            time.sleep(0.01)
        for part in parts:
            tell(part)

    def run(  # noqa: C901
        self, task: Task, stop: Callable[[], bool], report: Report
    ) -> FrontDocument:
        """Return a front of one tour, after what the actor of the task names."""
        deed = task.actor
        match deed:
            case "fail":
                raise KeyError("city")
            case "die":
                self._die_once_more()
            case "wait" | "stop slowly":
                while not stop():
                    time.sleep(0.001)
                time.sleep(deed == "stop slowly")
                return document("cancelled")
            case "call":
                _TERMINATED.wait()
                raise RuntimeError("terminated")
            case "grow":
                np.ones(2**27)  # 1 GiB
            case "hang":
                time.sleep(600)
            case "report and hang":
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
        hypervolume=4 / 9,
        terminated=terminated,
        timings={"construction": 1.0},
        gained=gained,
    )
    return encode_front(front, {"name": "pa-one", "digest": "0" * 64})


def task(deed: str = "", seconds: float = 1.0) -> Task:
    """Return a task whose actor says what the runner does; without a time limit it is brief."""
    cities = np.random.default_rng(0).random((3, 4))
    planes = Plane(cities[:, :2]), Plane(cities[:, 2:])
    options = PlanOptions(directions=spread(1), size=1, time_limit=seconds)
    return Task(subject=Stops(np.full((3, 2), np.nan), planes), options=options, actor=deed)


def brief_task(deed: str = "") -> Task:
    """Return a brief task, likewise."""
    return task(deed, seconds=0.0)


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
