"""The compiled code that requests need: compiled once, and loaded by later processes.

Compiling takes one process a minute. With several processors and a cache, several processes compile
parts into the cache, and the process that needs them all loads them from there.

`python -m service.jobs.compiled_code QUEUE` compiles the parts whose numbers it reads from a pipe,
one after another, and ends when its standard input does. All processes read from the same pipe.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from threading import Thread

from numba import config
from numba.core.event import Event, Listener, install_listener

from service import jit, own_code
from service.coverage import shortest_paths
from service.kinds import fleet
from service.replanning import insertion
from service.search import improve

_PARTS: Sequence[Callable[[], None]] = (
    *improve.PARTS,
    insertion.warm_up,
    shortest_paths.warm_up,
    fleet.warm_up,
)


def warm_up() -> None:
    """Compile all parts, or load them from the cache, unless that is done."""
    if load_from_cache():
        return
    processes = len(os.sched_getaffinity(0))
    if jit.CACHED and processes > 1:
        _compile_elsewhere(processes)
    for compile_part in _PARTS:  # or load it
        compile_part()


def load_from_cache() -> bool:
    """Load all parts from the cache; stop and return False if one would have to be compiled.

    Where numba's compilation is switched off, none has to be.
    """
    if config.DISABLE_JIT:  # type: ignore[attr-defined]  # set from the environment
        return True
    try:
        with install_listener("numba:compile", _RefuseCompilation()):
            for load_part in _PARTS:
                load_part()
    except _NotCached:
        return False
    return True


class _NotCached(Exception):
    pass


class _RefuseCompilation(Listener):
    def on_start(self, event: Event) -> None:  # noqa: ARG002  # numba's interface
        raise _NotCached

    def on_end(self, event: Event) -> None:
        """Do nothing: nothing was begun."""


def _compile_elsewhere(processes: int) -> None:
    """Compile all parts into the cache in processes, which end with this one at the latest."""
    # In a process group of its own, so that Ctrl-C does not end it.
    environment = {**os.environ, **own_code.variables()}
    queue, end_of_queue = os.pipe()
    os.write(end_of_queue, bytes(range(len(_PARTS))))
    os.close(end_of_queue)
    with ExitStack() as stack:
        stack.callback(os.close, queue)
        running = []
        for _ in range(min(processes, len(_PARTS))):
            process = subprocess.Popen(
                [sys.executable, "-m", __name__, str(queue)],
                stdin=subprocess.PIPE,
                pass_fds=[queue],
                env=environment,
                process_group=0,
            )
            running.append(stack.enter_context(process))
            stack.callback(process.kill)
        for process in running:
            process.wait()


def _end_with_parent() -> None:
    sys.stdin.read()
    os._exit(1)


if __name__ == "__main__":
    Thread(target=_end_with_parent, daemon=True).start()
    while number := os.read(int(sys.argv[1]), 1):
        _PARTS[number[0]]()
