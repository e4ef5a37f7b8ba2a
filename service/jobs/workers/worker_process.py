"""Worker processes: the loop inside one, and its handle in the service's event loop."""

import asyncio
import multiprocessing
import os
import pickle
import signal
import time
import traceback
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator
from contextlib import suppress
from multiprocessing.context import ForkServerProcess
from queue import SimpleQueue
from socket import socket, socketpair
from threading import Lock, Thread
from typing import Any

from service.jobs.runner import MakeRunner, Reporter, Runner
from service.jobs.workers.messages import (
    Do,
    Done,
    Failed,
    Found,
    Started,
    Stop,
    Warm,
    WarmUp,
    encode,
    receive,
    receive_blocking,
)
from service.requests.task import Task, TaskSource

NICENESS = 5  # of a worker: the event loop comes first, and needs little
_TERMINATE_EVERY = 0.02  # seconds, while a stopped task runs: it may just begin a call

_CONTEXT = multiprocessing.get_context("forkserver")
_CONTEXT.set_forkserver_preload(["service.jobs.workers.preloaded"])
_BUFFER = 2**20  # bytes


def run_worker(connection: socket, make_runner: MakeRunner) -> None:
    """Run tasks until the service closes the connection."""
    # An interrupt from a terminal goes to all processes; the service tells its workers to end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICENESS)
    with suppress(OSError):
        _WorkerLoop(connection, make_runner()).run()


class _WorkerLoop:
    """Runs tasks in one thread, reads messages in another, and warms up in a third."""

    def __init__(self, connection: socket, runner: Runner) -> None:
        self._connection = connection
        self._runner = runner
        self._sending = Lock()
        self._tasks: SimpleQueue[Do] = SimpleQueue()
        self._changing = Lock()  # held while `_running` changes, and while its call is terminated
        self._running: int | None = None
        self._stopped: int | None = None

    def run(self) -> None:
        """Run tasks, one after another, until the service closes the connection."""
        Thread(target=self._read, name="reader", daemon=True).start()
        self._send(Started())
        while True:
            task = self._tasks.get()
            result = self._result(task.number, task.task)
            self._set_running(None)
            self._send(result)

    def _read(self) -> None:
        """Handle messages; exit at once when the service is gone, even in the middle of a task."""
        try:
            while True:
                self._handle(receive_blocking(self._connection))
        except (EOFError, OSError):
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)

    def _handle(self, message: object) -> None:
        match message:
            case Do():
                self._set_running(message.number)
                self._tasks.put(message)
            case Stop():
                self._stopped = message.number
                Thread(target=self._terminate, args=[message.number], daemon=True).start()
            case WarmUp():
                Thread(target=self._warm_up, name="warm-up", daemon=True).start()

    def _terminate(self, number: int) -> None:
        """Terminate the calls of the runner until the task of this number has ended."""
        while True:
            with self._changing:
                if self._running != number:
                    return
                self._runner.terminate()
            time.sleep(_TERMINATE_EVERY)

    def _set_running(self, number: int | None) -> None:
        with self._changing:
            self._running = number

    def _result(self, number: int, task: TaskSource | Task) -> Done | Failed:
        report = Reporter(lambda progress, front: self._send(Found(number, progress, front)))
        try:
            return Done(number, self._runner.run(task, lambda: self._stopped == number, report))
        except Exception as error:
            return Failed(number, _picklable(error))

    def _warm_up(self) -> None:
        self._runner.warm_up()
        with suppress(OSError):
            self._send(Warm())

    def _send(self, message: object) -> None:
        content = encode(message)
        with self._sending:
            self._connection.sendall(content)


def _picklable(error: Exception) -> Exception:
    """Return the error, or one with its text, with the traceback as a note."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(repr(error))
    error.add_note(traceback.format_exc())
    return error


class WorkerProcess:
    """The handle of a worker process: the process and the socket to it.

    When the service is gone, the process ends; when the process is gone, `messages` ends.
    """

    def __init__(
        self, process: ForkServerProcess, reader: StreamReader, writer: StreamWriter
    ) -> None:
        self._process = process
        self._reader = reader
        self._writer = writer

    @classmethod
    async def start(cls, make_runner: MakeRunner) -> "WorkerProcess":
        """Start a process, which sends Started once its networks are loaded.

        Raises:
            OSError: There are no descriptors or processes left.
        """
        ours, theirs = socketpair()
        try:
            with theirs:
                process = _CONTEXT.Process(
                    target=run_worker, args=(theirs, make_runner), name="planner", daemon=True
                )
                process.start()
            return cls(process, *await asyncio.open_connection(sock=ours, limit=_BUFFER))
        except BaseException:
            ours.close()  # with which the process ends, if there is one
            raise

    @property
    def pid(self) -> int | None:
        """The id of the process."""
        return self._process.pid

    def send(self, message: object) -> None:
        """Send a message; one to a process that is gone is lost."""
        self._writer.write(encode(message))

    async def messages(self) -> AsyncIterator[Any]:
        """Yield the messages of the process, until it is gone."""
        try:
            while True:
                yield await receive(self._reader)
        except (EOFError, OSError):
            return

    def kill(self) -> None:
        """Kill the process."""
        self._process.kill()

    async def join(self) -> None:
        """Wait until the process has ended, and close the socket."""
        self._writer.close()
        await asyncio.to_thread(self._process.join)
