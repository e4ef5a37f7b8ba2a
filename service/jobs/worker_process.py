"""A worker process: its inside, and its handle in the event loop."""

import asyncio
import multiprocessing
import os
import pickle
import signal
import time
import traceback
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from multiprocessing.context import SpawnProcess
from select import POLLIN, poll
from socket import socket, socketpair
from threading import Lock, Thread
from typing import Any, Protocol

from service.jobs.front_document import FrontDocument, Sketch
from service.jobs.messages import (
    Do,
    Done,
    Failed,
    Found,
    Snapshot,
    Started,
    Stop,
    Warm,
    WarmUp,
    packed,
    received,
    received_now,
)
from service.requests.task import Task, Work

NICENESS = 5  # of a worker: the event loop comes first, and needs little
MOST_TOURS = 100  # of a snapshot
EVERY = 0.25  # seconds between two snapshots
MOST_SHARE = 0.05  # of the time goes into snapshots


class Planner(Protocol):
    """What a worker process plans with."""

    def warm_up(self) -> None:
        """Compile what can be compiled, or load it."""

    def plan(
        self, work: Work | Task, stop: Callable[[], bool], report: Callable[[Sketch], None]
    ) -> FrontDocument:
        """The front that is asked for."""


def run_worker(connection: socket, make_planner: Callable[[], Planner]) -> None:
    """Work as long as the service is there."""
    # An interrupt from a terminal goes to everyone; the service tells its workers when to end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICENESS)
    worker = _Worker(connection, make_planner())
    Thread(target=_end_with_the_service, args=[connection], name="guard", daemon=True).start()
    with suppress(EOFError, OSError):
        worker.work()


def _end_with_the_service(connection: socket) -> None:
    """End at once when the service is gone, whatever is being done."""
    hung_up = poll()
    hung_up.register(connection, 0)
    hung_up.poll()
    os._exit(0)


class _Worker:
    """Works in one thread and warms up in another."""

    def __init__(self, connection: socket, planner: Planner) -> None:
        self._connection = connection
        self._planner = planner
        self._sending = Lock()
        self._stopped: int | None = None
        self._waiting = poll()
        self._waiting.register(connection, POLLIN)

    def work(self) -> None:
        """Do what is given, one after another."""
        self._send(Started())
        while True:
            self._hear(received_now(self._connection))

    def _hear(self, message: object) -> None:
        match message:
            case Do():
                self._send(self._done(message.number, message.work))
            case Stop():
                self._stopped = message.number
            case WarmUp():
                Thread(target=self._warm_up, name="warm-up", daemon=True).start()

    def _done(self, number: int, work: Work | Task) -> Done | Failed:
        report = Reporter(lambda snapshot: self._send(Found(number, snapshot)))
        try:
            return Done(number, self._planner.plan(work, lambda: self._is_over(number), report))
        except Exception as error:
            return Failed(number, _portable(error))

    def _is_over(self, number: int) -> bool:
        """Whether what is being done is to end: who does it asks again and again."""
        # While there is work, the service gives no more of it: nothing is begun in here.
        while self._stopped != number and self._waiting.poll(0):
            self._hear(received_now(self._connection))
        return self._stopped == number

    def _warm_up(self) -> None:
        self._planner.warm_up()
        with suppress(OSError):
            self._send(Warm())

    def _send(self, message: object) -> None:
        content = packed(message)
        with self._sending:
            self._connection.sendall(content)


def _portable(error: Exception) -> Exception:
    """The error, or one that says the same, fit to travel with its traceback in a note."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(repr(error))
    error.add_note(traceback.format_exc())
    return error


class Reporter:
    """Takes a snapshot now and then, the more rarely the longer one takes."""

    def __init__(self, send: Callable[[Snapshot], None]) -> None:
        self._send = send
        self._next = time.monotonic() + EVERY

    def __call__(self, sketch: Sketch) -> None:
        """Take one, if it is time."""
        began = time.monotonic()
        if began < self._next:
            return
        front = sketch.front(MOST_TOURS)
        self._send(Snapshot(sketch.seconds, sketch.hypervolume, sketch.points, front))
        ended = time.monotonic()
        self._next = ended + max(EVERY, (ended - began) / MOST_SHARE)


MakePlanner = Callable[[], Planner]

# A fork would copy the threads' locks but not the threads, and onnxruntime does not survive it.
_CONTEXT = multiprocessing.get_context("spawn")
_BUFFER = 2**20  # bytes


class Process:
    """A process that works, and the socket to it. When either end is gone, so is the other."""

    def __init__(self, process: SpawnProcess, reader: StreamReader, writer: StreamWriter) -> None:
        self._process = process
        self._reader = reader
        self._writer = writer

    @classmethod
    async def start(cls, make_planner: MakePlanner) -> "Process":
        """A process that loads what it needs, and will say when it has."""
        ours, theirs = socketpair()
        with theirs:
            process = _CONTEXT.Process(
                target=run_worker, args=(theirs, make_planner), name="planner", daemon=True
            )
            process.start()
        return cls(process, *await asyncio.open_connection(sock=ours, limit=_BUFFER))

    @property
    def pid(self) -> int | None:
        """Its number, for logs."""
        return self._process.pid

    def send(self, message: object) -> None:
        """Tell it something; when it is gone, nothing happens."""
        self._writer.write(packed(message))

    async def messages(self) -> AsyncIterator[Any]:
        """What it says, until it is gone."""
        try:
            while True:
                yield await received(self._reader)
        except (EOFError, OSError):
            return

    def kill(self) -> None:
        """End it at once."""
        self._process.kill()

    async def gone(self) -> None:
        """Wait until it has ended, and let go of everything."""
        self._writer.close()
        await asyncio.to_thread(self._process.join)
