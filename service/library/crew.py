"""Plan in several processes: a crew of them. Each plans one request after another.

`python -m service.library.crew LOCK` is such a process. It reads requests from its standard input
and writes answers to its standard output, both pickled, and ends when its input does. Processes
that are started so, and not by multiprocessing, need no guard in the program that starts them.
"""

import fcntl
import gc
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from queue import SimpleQueue
from typing import Any, BinaryIO, Self, TypeVar

from paretour import FrontOfAnyKind, Plan, Refused
from paretour.kinds import parse_any
from pydantic_core import from_json

T = TypeVar("T")
Answer = bytes | Mapping[str, Any]  # a front as JSON, or the document of a refusal


class Crew:
    """A number of processes that plan. As a context manager it ends them, even if they are busy.

    Args:
        workers: The number of processes; None for one for each processor.
        tasks: The number of tasks, which limits the number of processes.

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

    def run(self, plan: Plan) -> Answer:
        """Plan in a process that has nothing to do; to be called by what was submitted.

        Raises:
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

    def run(self, plan: Plan) -> Answer:
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            _send(self._process.stdin, plan)
            answer: Answer = pickle.load(self._process.stdout)
        except (EOFError, BrokenPipeError):
            status = self._process.wait()
            raise RuntimeError(f"its process ended with status {status}") from None
        return answer

    def kill(self) -> None:
        self._process.kill()

    def close(self) -> None:
        with suppress(BrokenPipeError), self._process:  # it did not read all that was written
            pass


def front_of(answer: Answer) -> FrontOfAnyKind:
    """Return the front of an answer.

    To read it takes milliseconds, in which no thread sends a request: the process that answered
    shall have its next one by then.

    Raises:
        Refused: The request cannot be planned.
    """
    if isinstance(answer, bytes):
        return parse_any(from_json(answer))
    raise Refused(answer)


def _send(stream: BinaryIO | Any, message: object) -> None:
    pickle.dump(message, stream)
    stream.flush()


def _work(lock: str) -> None:
    """Plan what comes on standard input, until it ends."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # so that what a library prints is not read as an answer
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that started this one is told of it
    gc.disable()
    from paretour.bars import Silent

    from service.library.local_planner import load_default_planner

    class OneByOne(Silent):
        """Lets one process compile, and the others then load what it compiled."""

        @contextmanager
        def loading(self) -> Iterator[Callable[[str], None]]:
            with open(lock, "rb") as file:
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
            answer: Answer = planner.plan(plan, display).answer
        except Refused as error:
            answer = error.document
        _send(answers, answer)
        if not gc.isenabled():  # all is loaded, and stays: no need to look through it ever again
            gc.freeze()
            gc.enable()


if __name__ == "__main__":
    _work(sys.argv[1])
