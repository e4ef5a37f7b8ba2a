"""Worker processes: what runs tasks in one, the loop around it, and its handle in the service."""

import asyncio
import os
import pickle
import resource
import signal
import time
import traceback
from asyncio import StreamReader, StreamWriter
from collections.abc import AsyncIterator, Callable, Collection
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from multiprocessing.context import ForkServerProcess
from pathlib import Path
from queue import SimpleQueue
from socket import socket, socketpair
from threading import Condition, Lock, Thread
from typing import Protocol

from service.extensions.names import NO_EXTENSIONS, Extensions
from service.jobs.workers import fork_server
from service.jobs.workers.messages import (
    Do,
    Done,
    Failed,
    Found,
    Stage,
    StopTask,
    Unable,
    Warm,
    WarmUp,
    encode,
    receive,
    received,
)
from service.kinds.front_document import FrontDocument
from service.kinds.kind import Report
from service.kinds.parts import Compiling, Part
from service.requests.limits import Limits
from service.requests.task import Task
from service.watch import Progress

NICENESS = 5  # of a worker: the event loop comes first, and needs little
_LARGE = 1_000_000  # kilobytes; a process that has grown beyond is replaced after its task
_REPORT_TOURS = 100  # at most in a reported front
_REPORT_SECONDS = 0.25  # at least between two reports
_REPORT_SHARE = 0.05  # the share of the time that reports may take
_TERMINATE_EVERY = 0.02  # seconds, while a stopped task runs: it may just begin a call


class Runner(Protocol):
    """Runs tasks, one at a time."""

    def warm_up(self, parts: Collection[Part], tell: Callable[[Part | Compiling], None]) -> None:
        """Compile parts of the code, or load them; tell each that is there, and how far it is."""

    def run(self, task: Task, stop: Callable[[], bool], report: Report) -> FrontDocument:
        """Return the front of a task.

        Args:
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
        self._next = time.monotonic() + _REPORT_SECONDS

    def __call__(self, progress: Progress, best: Callable[[int], FrontDocument]) -> None:
        """Send a report, if one is due."""
        began = time.monotonic()
        if began < self._next:
            return
        self._send(progress, best(_REPORT_TOURS))
        ended = time.monotonic()
        self._next = ended + max(_REPORT_SECONDS, (ended - began) / _REPORT_SHARE)


def make_runner(
    actors: Path,
    threads: int,
    limits: Limits,
    own_actors: Path | None = None,
    extensions: Extensions = NO_EXTENSIONS,
) -> Runner:
    """Return a runner as `load_runner` does, which is imported only by the process that calls."""
    from service.jobs.task_runner import load_runner

    return load_runner(actors, threads, limits, own_actors, extensions=extensions)


def run_worker(tasks: socket, signals: socket, make_runner: MakeRunner) -> None:
    """Run tasks until the service closes the connections.

    Args:
        tasks: Brings tasks and takes results.
        signals: Brings messages that must not wait until the present task is done.
        make_runner: Makes the runner of the tasks.
    """
    # An interrupt from a terminal goes to all processes; the service tells its workers to end.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.nice(NICENESS)
    try:
        runner = make_runner()
    except Exception as error:
        with suppress(OSError):
            tasks.sendall(encode(Unable(repr(error))))
        raise
    with suppress(EOFError, OSError):
        _WorkerLoop(tasks, signals, runner).run()


class _WorkerLoop:
    """Runs tasks in one thread. Others read signals, terminate calls, and warm up."""

    def __init__(self, tasks: socket, signals: socket, runner: Runner) -> None:
        self._tasks = tasks
        self._incoming = tasks.makefile("rb")
        self._signals = signals.makefile("rb")
        self._runner = runner
        self._sending = Lock()
        self._to_warm_up: SimpleQueue[WarmUp] = SimpleQueue()
        self._changing = Condition()  # held while these change, and while a call is terminated
        self._running: int | None = None
        self._stopped: set[int] = set()

    def run(self) -> None:
        """Run tasks, one after another, until the process is large or the service is gone.

        Raises:
            EOFError: The service is gone.
            OSError: Likewise.
        """
        Thread(target=self._read_signals, name="signals", daemon=True).start()
        Thread(target=self._terminate_stopped, name="terminate", daemon=True).start()
        Thread(target=self._warm_up, name="warm-up", daemon=True).start()
        self._send(Stage.STARTED)
        while True:
            do: Do = receive(self._incoming)
            results = [self._result(number, task) for number, task in do.tasks.items()]
            # Before the results are sent: after that a signal may be about a task still to come.
            self._stopped.clear()
            if resource.getrusage(resource.RUSAGE_SELF).ru_maxrss > _LARGE:
                self._send(Stage.SPENT, *results)
                return
            self._send(*results)

    def _read_signals(self) -> None:
        """Handle signals; exit at once when the service is gone, even in the middle of a task."""
        try:
            while True:
                match receive(self._signals):
                    case StopTask(number=number):
                        self._stop(number)
                    case WarmUp() as warm_up:
                        self._to_warm_up.put(warm_up)
        except (EOFError, OSError):
            os._exit(0)
        except BaseException:
            with suppress(OSError):
                traceback.print_exc()
            os._exit(1)

    def _set_running(self, number: int | None) -> None:
        with self._changing:
            self._running = number
            self._changing.notify()

    def _stop(self, number: int) -> None:
        with self._changing:
            self._stopped.add(number)  # which may come before the task
            self._changing.notify()

    def _terminate_stopped(self) -> None:
        """Terminate the calls of the runner again and again, while a stopped task runs."""
        while True:
            with self._changing:
                self._changing.wait_for(lambda: self._running in self._stopped)
                self._runner.terminate()
            time.sleep(_TERMINATE_EVERY)

    def _result(self, number: int, task: Task) -> Done | Failed:
        report = Reporter(lambda progress, front: self._send(Found(number, progress, front)))
        self._set_running(number)
        try:
            return Done(number, self._runner.run(task, lambda: number in self._stopped, report))
        except Exception as error:
            return Failed(number, _picklable(error))
        finally:
            self._set_running(None)

    def _warm_up(self) -> None:
        """Compile or load what the service asks for, one part after another."""
        try:
            while True:
                self._runner.warm_up(self._to_warm_up.get().parts, self._tell)
        except Exception as error:
            with suppress(OSError):
                self._send(Unable(repr(error)))
            with suppress(OSError):  # as where standard error is a file on a full disk
                traceback.print_exc()
            os._exit(1)

    def _tell(self, told: Part | Compiling) -> None:
        with suppress(OSError):
            self._send(Warm(told) if isinstance(told, Part) else told)

    def _send(self, *messages: object) -> None:
        content = encode(*messages)
        with self._sending:
            self._tasks.sendall(content)


def _picklable(error: Exception) -> Exception:
    """Return the error, or one with its text, with the traceback as a note."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(repr(error))
    error.add_note(traceback.format_exc())
    return error


@dataclass(frozen=True, eq=False)
class WorkerProcess:
    """The handle of a worker process: the process and the sockets to it.

    When the service is gone, the process ends; when the process is gone, its messages end.
    """

    process: ForkServerProcess
    results: StreamReader
    tasks: StreamWriter
    signals: StreamWriter

    @classmethod
    async def start(cls, make_runner: MakeRunner) -> "WorkerProcess":
        """Start a process, which sends Stage.STARTED once it takes tasks.

        Raises:
            OSError: No descriptors or processes are left.
        """
        with ExitStack() as ours:  # closed if this fails; that ends the process
            with ExitStack() as theirs:
                own_tasks, tasks = _socket_pair(ours, theirs)
                own_signals, signals = _socket_pair(ours, theirs)
                arguments = (tasks, signals, make_runner)
                fork_server.start()
                process = fork_server.CONTEXT.Process(
                    target=run_worker, args=arguments, name="planner", daemon=True
                )
                process.start()
            results, writing = await asyncio.open_connection(sock=own_tasks)
            ours.callback(writing.close)
            _, signalling = await asyncio.open_connection(sock=own_signals)
            ours.pop_all()
        return cls(process, results, writing, signalling)

    @property
    def pid(self) -> int | None:
        """The id of the process."""
        return self.process.pid

    def send(self, message: Do | StopTask | WarmUp) -> None:
        """Send a message; one to a process that is gone is lost."""
        connection = self.tasks if isinstance(message, Do) else self.signals
        connection.write(encode(message))

    def messages(self) -> AsyncIterator[object]:
        """Yield each message of the process, until it is gone."""
        return received(self.results)

    @property
    def exit_status(self) -> int | None:
        """The exit status of the process once `join` has returned; minus a signal's number."""
        return self.process.exitcode

    def kill(self) -> None:
        """Kill the process."""
        self.process.kill()

    async def join(self) -> None:
        """Wait until the process has ended, and close the sockets."""
        self.tasks.close()
        self.signals.close()
        await asyncio.to_thread(self.process.join)


def _socket_pair(ours: ExitStack, theirs: ExitStack) -> tuple[socket, socket]:
    """Return two connected sockets, one that we close and one that another process has."""
    own, other = socketpair()
    return ours.enter_context(own), theirs.enter_context(other)
