"""The interface of what runs tasks in a worker process, and how often it reports."""

import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

from service.front import Progress
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report
from service.requests.limits import Limits
from service.requests.task import Task

REPORT_TOURS = 100  # at most in a reported front
REPORT_SECONDS = 0.25  # at least between two reports
REPORT_SHARE = 0.05  # the share of the time that reports may take


class Runner(Protocol):
    """Runs tasks, one at a time."""

    def warm_up(self) -> None:
        """Compile the search, or load it from the cache."""

    def run(self, task: Task, stop: Callable[[], bool], report: Report) -> FrontDocument:
        """Return the front of a task.

        Args:
            task: The task.
            stop: Called often; planning ends soon after it returns True.
            report: Called now and then with the progress, and with a function that writes the best
                n tours found so far, which is valid until the report returns.
        """

    def terminate(self) -> None:
        """End the running call of a network, if one runs; from any thread."""


MakeRunner = Callable[[], Runner]


class Reporter:
    """Sends progress with the best front now and then; less often if sending takes long."""

    def __init__(self, send: Callable[[Progress, FrontDocument], None]) -> None:
        self._send = send
        self._next = time.monotonic() + REPORT_SECONDS

    def __call__(self, progress: Progress, best: Callable[[int], FrontDocument]) -> None:
        """Send a report, if one is due."""
        began = time.monotonic()
        if began < self._next:
            return
        self._send(progress, best(REPORT_TOURS))
        ended = time.monotonic()
        self._next = ended + max(REPORT_SECONDS, (ended - began) / REPORT_SHARE)


def make_runner(
    actors: Path,
    threads: int,
    limits: Limits,
    own_actors: Path | None = None,
) -> Runner:
    """Return a runner as `load_runner` does: what plans is imported by the process that calls."""
    from service.jobs.task_runner import load_runner

    return load_runner(actors, threads, limits, own_actors)
