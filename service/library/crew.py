"""Plan in several processes: a crew of them. Each plans one request after another.

`python -m service.library.crew LOCK` is such a process. It reads requests from its standard input
and writes answers to its standard output, both pickled, and ends when its input does. Processes
that are started so, and not by multiprocessing, need no guard in the program that starts them.
"""

import fcntl
import json
import os
import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from queue import SimpleQueue
from typing import Any, BinaryIO, Self, TypeVar

from paretour import FrontOfAnyKind, Plan, Refused
from paretour.kinds import parse_any

T = TypeVar("T")


class Crew:
    """A number of processes that plan. As a context manager it ends them, even if they are busy.

    Args:
        workers: The number of processes; None for one for each processor.
        tasks: The number of tasks; there are no more processes than that.

    Raises:
        ValueError: The number of processes is not positive.
    """

    def __init__(self, workers: int | None, tasks: int) -> None:
        count = len(os.sched_getaffinity(0)) if workers is None else workers
        if count < 1:
            raise ValueError(f"workers must be at least 1, got {workers}")
        self._lock = tempfile.NamedTemporaryFile(prefix="paretour-")  # noqa: SIM115  # closed in __exit__
        self._threads = ThreadPoolExecutor(max(1, min(count, tasks)))
        self._workers = [_Worker(self._lock.name) for _ in range(min(count, tasks))]
        self._idle: SimpleQueue[_Worker] = SimpleQueue()
        for worker in self._workers:
            self._idle.put(worker)

    def submit(self, function: Callable[..., T], *arguments: Any) -> Future[T]:
        """Call a function in a thread, as soon as a process has nothing to do."""
        return self._threads.submit(function, *arguments)

    def run(self, plan: Plan) -> FrontOfAnyKind:
        """Plan in a process that has nothing to do; to be called by what was submitted.

        Raises:
            Refused: The request cannot be planned.
            RuntimeError: The process ended.
        """
        worker = self._idle.get()
        try:
            return worker.run(plan)
        finally:
            self._idle.put(worker)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._workers:
            worker.kill()
        self._threads.shutdown(cancel_futures=True)
        for worker in self._workers:
            worker.close()
        self._lock.close()


class _Worker:
    """The handle of a process that plans. It is not told of Ctrl-C, and finds the same modules."""

    def __init__(self, lock: str) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "service.library.crew", lock],
            env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
        )

    def run(self, plan: Plan) -> FrontOfAnyKind:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            _send(self._process.stdin, plan)
            answer = pickle.load(self._process.stdout)
        except (EOFError, BrokenPipeError):
            status = self._process.wait()
            raise RuntimeError(f"its process ended with status {status}") from None
        if isinstance(answer, dict):
            raise Refused(answer)
        return parse_any(json.loads(answer))

    def kill(self) -> None:
        self._process.kill()

    def close(self) -> None:
        with suppress(BrokenPipeError), self._process:  # it did not read all that was written
            pass


def _send(stream: BinaryIO | Any, message: object) -> None:
    pickle.dump(message, stream)
    stream.flush()


def _work(lock: str) -> None:
    """Plan what comes on standard input, until it ends."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that what a library prints is not read as an answer
    from paretour.bars import Silent

    from service.library.local_planner import load_default_planner

    class OneByOne(Silent):
        """Lets one process compile, and the others then load what it compiled."""

        @contextmanager
        def loading(self) -> Iterator[Callable[[str], None]]:
            with open(lock) as file:
                fcntl.flock(file, fcntl.LOCK_EX)
                yield lambda _: None

    planner = load_default_planner()
    display = OneByOne()
    while True:
        try:
            plan = pickle.load(sys.stdin.buffer)
        except EOFError:
            return
        try:
            answer: object = planner.plan(plan, display).answer
        except Refused as error:
            answer = error.document
        _send(answers, answer)


if __name__ == "__main__":
    _work(sys.argv[1])
