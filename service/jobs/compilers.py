"""Processes that compile pieces of the code into the cache, side by side.

Each reads the numbers of its pieces from a pipe, and compiles one after another. To another pipe it
writes a number when a piece is done, and a sign for each function. It ends when a third pipe does.

To import what they need takes them two seconds. The process that workers are forked from has
imported it, and forks them before any worker. Elsewhere the first of them is a command, which forks
the others: `python -m service.jobs.compilers QUEUE DONE PROCESSES`, whose third pipe is its
standard input.
"""

import gc
import os
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable, Collection, Iterator
from contextlib import ExitStack, contextmanager, suppress
from threading import Thread
from typing import NoReturn

from service import own_code
from service.jit.compilations import Event, Listener, following_compilations, import_compiler
from service.jobs.pieces import PIECES
from service.kinds.parts import Part

FUNCTION = 255  # the sign for a function
_NICENESS = 10  # of processes forked early: to compile comes after requests, and after networks


class Count(Listener):
    """Calls a function after each compilation."""

    def __init__(self, count: Callable[[], object]) -> None:
        self._count = count

    def on_start(self, event: Event) -> None:
        """Do nothing: it has not been compiled."""

    def on_end(self, event: Event) -> None:  # noqa: ARG002  # numba's interface
        """Call the function."""
        self._count()


@contextmanager
def started(parts: Collection[Part], processes: int) -> Iterator[int]:
    """Compile parts in several processes, which end with this one at the latest.

    Yields:
        What they write to a pipe, which ends when the last of them does.
    """
    with ExitStack() as stack:
        queue = _queue(parts)
        stack.callback(os.close, queue)
        done, tell = os.pipe()
        stack.callback(os.close, done)
        command = [sys.executable, "-m", __name__, str(queue), str(tell), str(processes)]
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,  # which ends when this block does
            pass_fds=[queue, tell],
            env={**os.environ, **own_code.variables()},
            process_group=0,  # so that Ctrl-C does not end it
        )
        stack.enter_context(process)
        os.close(tell)
        yield done


def fork(parts: Collection[Part], processes: int) -> int:
    """Compile parts in several processes forked from this one, which must have a single thread.

    They end with this process and all those forked from it later.

    Returns:
        What they write to a pipe, which ends when the last of them does.
    """
    queue = _queue(parts)
    done, tell = os.pipe()
    end, end_here = os.pipe()
    if not os.fork():
        os.close(done)
        os.close(end_here)
        os.nice(_NICENESS)
        _compile_and_exit(queue, tell, end, processes)
    for theirs in (queue, tell, end):
        os.close(theirs)
    # The fork server expects no children but those it is asked for.
    warnings.filterwarnings("ignore", message="forkserver: waitpid returned unexpected pid")
    return done


def _queue(parts: Collection[Part]) -> int:
    queue, end_of_queue = os.pipe()
    os.write(end_of_queue, bytes(n for n, (part, _) in enumerate(PIECES) if part in parts))
    os.close(end_of_queue)
    return queue


def _compile_and_exit(queue: int, done: int, end: int, processes: int) -> NoReturn:
    """Compile in this process and in others, and exit; at once when the pipe `end` ends."""
    try:
        children = _fork_compilers(min(processes, len(PIECES)) - 1)
        Thread(target=_end_with, args=(end, children), daemon=True).start()
        _compile_pieces(queue, done)
        _wait_for(children)
    except BaseException:
        with suppress(OSError):
            traceback.print_exc()
        os._exit(1)
    os._exit(0)


def _fork_compilers(number: int) -> Collection[int]:
    """Continue as this process and others, which share what was imported; return the others."""
    import_compiler()
    gc.freeze()
    children = []
    for _ in range(number):
        child = os.fork()
        if not child:
            return ()
        children.append(child)
    return children


def _end_with(pipe: int, children: Collection[int]) -> None:
    os.read(pipe, 1)
    _wait_for(children)
    os._exit(1)


def _wait_for(children: Collection[int]) -> None:
    with suppress(ChildProcessError):  # the other thread has waited
        for child in children:
            os.waitpid(child, 0)


def _compile_pieces(queue: int, done: int) -> None:
    """Compile the pieces whose numbers are in a pipe, and say to another what is done.

    Compiling makes objects that stay, so Python seldom looks for those that could go.
    """
    gc.enable()  # it may have been forked while none was collected
    gc.set_threshold(20_000)
    with following_compilations(Count(lambda: os.write(done, bytes([FUNCTION])))):
        while number := os.read(queue, 1):
            _, compile_piece = PIECES[number[0]]
            compile_piece()
            os.write(done, number)


if __name__ == "__main__":
    _queue_end, _done, _processes = map(int, sys.argv[1:])
    _compile_and_exit(_queue_end, _done, sys.stdin.fileno(), _processes)
