"""Worker processes: the loop inside one, and its handle in the service's event loop."""

import asyncio
import multiprocessing
import os
import pickle
import signal
import traceback
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator
from contextlib import suppress
from multiprocessing.context import SpawnProcess
from select import POLLIN, poll
from socket import socket, socketpair
from threading import Lock, Thread
from typing import Any

from service.jobs.messages import (
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
from service.jobs.runner import MakeRunner, Reporter, Runner
from service.requests.task import Task, TaskSource

NICENESS = 5  # of a worker: the event loop comes first, and needs little

# A fork would copy the threads' locks but not the threads, and onnxruntime does not survive it.
_CONTEXT = multiprocessing.get_context("spawn")
_BUFFER = 2**20  # bytes


def run_worker(connection: socket, make_runner: MakeRunner) -> None:
    """Run tasks until the service closes the connection."""
    # An interrupt from a terminal goes to all processes; the service tells its workers to end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICENESS)
    loop = _WorkerLoop(connection, make_runner())
    Thread(target=_exit_with_service, args=[connection], name="guard", daemon=True).start()
    with suppress(EOFError, OSError):
        loop.run()


def _exit_with_service(connection: socket) -> None:
    """Exit at once when the service is gone, even in the middle of a task."""
    hung_up = poll()
    hung_up.register(connection, 0)
    hung_up.poll()
    os._exit(0)


class _WorkerLoop:
    """Runs tasks in one thread and warms up in another."""

    def __init__(self, connection: socket, runner: Runner) -> None:
        self._connection = connection
        self._runner = runner
        self._sending = Lock()
        self._stopped: int | None = None
        self._readable = poll()
        self._readable.register(connection, POLLIN)

    def run(self) -> None:
        """Handle messages, one after another."""
        self._send(Started())
        while True:
            self._handle(receive_blocking(self._connection))

    def _handle(self, message: object) -> None:
        match message:
            case Do():
                self._send(self._result(message.number, message.task))
            case Stop():
                self._stopped = message.number
            case WarmUp():
                Thread(target=self._warm_up, name="warm-up", daemon=True).start()

    def _result(self, number: int, task: TaskSource | Task) -> Done | Failed:
        report = Reporter(lambda progress, front: self._send(Found(number, progress, front)))
        try:
            return Done(number, self._runner.run(task, lambda: self._is_stopped(number), report))
        except Exception as error:
            return Failed(number, _picklable(error))

    def _is_stopped(self, number: int) -> bool:
        """Read what has been received, and return whether the running task is to stop."""
        # A busy worker is sent no other task, so that none is begun in here.
        while self._stopped != number and self._readable.poll(0):
            self._handle(receive_blocking(self._connection))
        return self._stopped == number

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

    def __init__(self, process: SpawnProcess, reader: StreamReader, writer: StreamWriter) -> None:
        self._process = process
        self._reader = reader
        self._writer = writer

    @classmethod
    async def start(cls, make_runner: MakeRunner) -> "WorkerProcess":
        """Start a process, which sends Started once its networks are loaded."""
        ours, theirs = socketpair()
        with theirs:
            process = _CONTEXT.Process(
                target=run_worker, args=(theirs, make_runner), name="planner", daemon=True
            )
            process.start()
        return cls(process, *await asyncio.open_connection(sock=ours, limit=_BUFFER))

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
