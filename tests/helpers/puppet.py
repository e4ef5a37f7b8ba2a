"""A planner that does what it is told, in a worker process: the body of the work says what."""

import os
import signal
import time
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from service.jobs.front_document import FrontDocument, encode_front
from service.jobs.runner import Report
from service.jobs.worker_pool import WorkerPool
from service.planner import Front
from service.requests.task import TaskSource
from service.search.improve import Progress


@dataclass(frozen=True)
class Puppet:
    """Its lives are bytes in a file, if it has one: with each work that kills it, one goes.

    It warms up once the file `warm` is there, if it is to wait for one.
    """

    lives: Path = Path("/nowhere")
    warm: Path | None = None

    def warm_up(self) -> None:
        while self.warm is not None and not self.warm.exists():
            time.sleep(0.01)

    def run(self, source: TaskSource, stop: Callable[[], bool], report: Report) -> FrontDocument:
        match source.body:
            case b"fail":
                raise KeyError("city")
            case b"die":
                self._die_while_it_lives()
            case b"wait":
                while not stop():
                    time.sleep(0.001)
                return document("cancelled")
            case b"hang":
                time.sleep(600)
            case b"report and hang":
                began = time.monotonic()
                while True:
                    seconds = time.monotonic() - began
                    report(Progress(seconds, 0.5, 7), lambda _: document(None))
                    time.sleep(0.01)
        return document("converged")

    def _die_while_it_lives(self) -> None:
        if left := self.lives.read_bytes():
            self.lives.write_bytes(left[1:])
            os.kill(os.getpid(), signal.SIGKILL)


def document(terminated: str | None, gained: float | None = None) -> FrontDocument:
    front = Front(
        tours=np.arange(3)[np.newaxis],
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
    return TaskSource("front", body)


def _same(puppet: Puppet) -> Puppet:
    return puppet


@asynccontextmanager
async def working(
    puppet: Puppet | None = None, workers: int = 1, queue: int = 0, seconds: float = 60.0
) -> AsyncIterator[WorkerPool]:
    """Workers at work."""
    make_runner = partial(_same, puppet or Puppet())
    crew = WorkerPool(make_runner, workers=workers, queue=queue, seconds=seconds)
    await crew.start()
    try:
        yield crew
    finally:
        await crew.close()
