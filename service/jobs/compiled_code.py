"""The compiled code that requests need: compiled once, and loaded by later processes.

Compiling takes one process most of a minute. With several processors and a cache, several processes
compile pieces into the cache, and the process that needs them loads them from there.

`python -m service.jobs.compiled_code QUEUE DONE PROCESSES` is one of these processes, and forks the
others once it has imported what they need. Each compiles pieces whose numbers it reads from a pipe,
one after another, and ends when the standard input does. To another pipe it writes a number when a
piece is done, and a sign for each function.
"""

import gc
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from threading import Thread, get_ident
from typing import NamedTuple

from numba import config
from numba.core.event import Event, Listener, install_listener
from numba.core.registry import cpu_target

from service import jit, own_code
from service.coverage import detours
from service.jobs.parts import Compiling, Part
from service.kinds import fleet
from service.over_the_day import warm_up as day
from service.replanning import insertion
from service.search import warm_up as search
from service.search.several import warm_up as several

Compile = Callable[[], None]
Told = Callable[[Part | Compiling], None]


class _Work(NamedTuple):
    """The functions that compile a part, or load it.

    Args:
        whole: Compiles all of it.
        pieces: Compile most of it, and share little, so that processes do it side by side.
        seconds: That it takes of a processor, about.
    """

    whole: Compile
    pieces: Sequence[Compile]
    seconds: int


_WORK: Mapping[Part, _Work] = {
    Part.FEW_CITIES: _Work(search.few_cities, (search.two_opt, search.beside_two_opt), 12),
    Part.MORE_CITIES: _Work(search.more_cities, (search.three_opt, search.beside_three_opt), 13),
    Part.MAPS: _Work(detours.warm_up, (detours.warm_up,), 2),
    Part.CHANGES: _Work(insertion.warm_up, (insertion.warm_up,), 1),
    Part.FLEETS: _Work(fleet.warm_up, (fleet.warm_up,), 2),
    Part.SEVERAL_OBJECTIVES: _Work(
        several.warm_up, (several.local_search, several.beside_local_search), 9
    ),
    Part.OVER_THE_DAY: _Work(day.warm_up, (day.warm_up,), 8),
    Part.MANY_CITIES: _Work(search.many_cities, (search.many_cities,), 5),
}
_PIECES = [(part, piece) for part, work in _WORK.items() for piece in work.pieces]
_A_FUNCTION = 0.125  # seconds that one of the functions takes, on average
_TELL_EVERY = 0.25  # seconds
_FUNCTION = 255  # the sign for a function


def warm_up(
    parts: Collection[Part] = tuple(Part),
    tell: Told = lambda _: None,
    before_compiling: Callable[[], object] = lambda: None,
) -> None:
    """Load parts from the cache, or compile them.

    Args:
        parts: The parts.
        tell: Called with each part once it is loaded, and while some are compiled a few times a
            second with how far that is.
        before_compiling: Called once all parts that are in the cache are loaded, before any part is
            compiled in this process.
    """
    missing = []
    for part in (each for each in Part if each in parts):
        if load_from_cache(part):
            tell(part)
        else:
            missing.append(part)
    processes = len(os.sched_getaffinity(0)) if jit.CACHED and missing else 1
    progress = _CompilationProgress(missing, processes, tell)
    with _compilers(missing, processes) as done:
        before_compiling()
        for part in _compiled_elsewhere(missing, done, progress):
            _WORK[part].whole()
            tell(part)
            missing.remove(part)
    with install_listener("numba:compile", _Count(progress.count)):
        for part in missing:
            _WORK[part].whole()
            tell(part)


def load_from_cache(part: Part) -> bool:
    """Load a part from the cache; stop and return False if something would have to be compiled.

    Where numba's compilation is switched off, nothing has to be.
    """
    if config.DISABLE_JIT:  # type: ignore[attr-defined]  # set from the environment
        return True
    try:
        with install_listener("numba:compile", _RefuseCompilation()):
            _WORK[part].whole()
    except _NotCached:
        return False
    return True


class _NotCached(Exception):
    pass


class _RefuseCompilation(Listener):
    """Refuses to compile in the thread that makes it: another may be planning."""

    def __init__(self) -> None:
        self._thread = get_ident()

    def on_start(self, event: Event) -> None:  # noqa: ARG002  # numba's interface
        if get_ident() == self._thread:
            raise _NotCached

    def on_end(self, event: Event) -> None:
        """Do nothing: nothing was begun."""


class _Count(Listener):
    """Calls a function after each compilation."""

    def __init__(self, count: Callable[[], object]) -> None:
        self._count = count

    def on_start(self, event: Event) -> None:
        """Do nothing: it has not been compiled."""

    def on_end(self, event: Event) -> None:  # noqa: ARG002  # numba's interface
        self._count()


class _CompilationProgress:
    """Counts functions that are compiled, and tells now and then how far that is.

    Args:
        parts: The parts that are compiled.
        processes: In how many processes.
        tell: Called with how far it is.
    """

    def __init__(self, parts: Iterable[Part], processes: int, tell: Told) -> None:
        seconds = sum(_WORK[part].seconds for part in parts)
        self._expected = seconds / processes
        self._functions = seconds / _A_FUNCTION
        self._tell = tell
        self._began = self._told = time.monotonic()
        self._compiled = 0

    def count(self) -> None:
        """Count a function."""
        self._compiled += 1
        now = time.monotonic()
        if now - self._told >= _TELL_EVERY:
            self._told = now
            share = min(self._compiled / self._functions, 0.99)
            # In all it takes what was expected, and the further it is, what has been seen.
            seconds = (1 - share) * self._expected + now - self._began
            self._tell(Compiling(share, (1 - share) * seconds))


def _compiled_elsewhere(
    parts: Collection[Part], done: int, progress: _CompilationProgress
) -> Iterator[Part]:
    """Yield each part that other processes have compiled into the cache, until they have ended.

    One is never yielded if a process that compiled some of it was killed.
    """
    left = Counter(part for part, _ in _PIECES if part in parts)
    while signs := os.read(done, 1024):
        for sign in signs:
            if sign == _FUNCTION:
                progress.count()
                continue
            part, _ = _PIECES[sign]
            left[part] -= 1
            if not left[part]:
                yield part


@contextmanager
def _compilers(parts: Collection[Part], processes: int) -> Iterator[int]:
    """Compile parts in several processes, which end with this one at the latest; not in one alone.

    Yields:
        What they write to a pipe, which ends when the last of them does.
    """
    numbers = [number for number, (part, _) in enumerate(_PIECES) if part in parts]
    with ExitStack() as stack:
        queue, end_of_queue = os.pipe()
        os.write(end_of_queue, bytes(numbers))
        os.close(end_of_queue)
        stack.callback(os.close, queue)
        done, tell = os.pipe()
        stack.callback(os.close, done)
        if processes > 1:
            arguments = (queue, tell, min(processes, len(numbers)))
            process = subprocess.Popen(
                [sys.executable, "-m", __name__, *map(str, arguments)],
                stdin=subprocess.PIPE,  # which ends when this block does
                pass_fds=[queue, tell],
                env={**os.environ, **own_code.variables()},
                process_group=0,  # so that Ctrl-C does not end it
            )
            stack.enter_context(process)
        os.close(tell)
        yield done


def _end_with_parent(children: Collection[int]) -> None:
    sys.stdin.read()
    _wait_for(children)
    os._exit(1)


def _fork(processes: int) -> Collection[int]:
    """Continue as so many processes, which share what was imported; return those forked by this."""
    cpu_target.target_context.refresh()  # imports what numba compiles with
    gc.freeze()
    children = []
    for _ in range(processes - 1):
        child = os.fork()
        if not child:
            return ()
        children.append(child)
    return children


def _wait_for(children: Collection[int]) -> None:
    with suppress(ChildProcessError):  # the other thread has waited
        for child in children:
            os.waitpid(child, 0)


def _compile_pieces(queue: int, done: int) -> None:
    """Compile the pieces whose numbers are in a pipe, and say to another what is done.

    Compiling makes objects that stay, so Python seldom looks for those that could go.
    """
    gc.set_threshold(20_000)
    with install_listener("numba:compile", _Count(lambda: os.write(done, bytes([_FUNCTION])))):
        while number := os.read(queue, 1):
            _, compile_piece = _PIECES[number[0]]
            compile_piece()
            os.write(done, number)


if __name__ == "__main__":
    *_pipes, _processes = map(int, sys.argv[1:])
    _children = _fork(_processes)
    Thread(target=_end_with_parent, args=(_children,), daemon=True).start()
    _compile_pieces(*_pipes)
    _wait_for(_children)
