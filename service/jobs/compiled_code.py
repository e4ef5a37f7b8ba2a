"""The compiled code that requests need: compiled once, and loaded by later processes.

Compiling takes one process most of a minute. With several processors and a cache, several processes
compile pieces into the cache, and the process that needs them loads them from there.
"""

import os
import time
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import AbstractContextManager, nullcontext
from threading import get_ident

from service import jit
from service.jit.compilations import Event, Listener, following_compilations, is_switched_off
from service.jobs import compilers
from service.jobs.pieces import PIECES, WORK
from service.jobs.uncollected import uncollected
from service.kinds.parts import Compiling, Part

Told = Callable[[Part | Compiling], None]

_A_FUNCTION = 0.125  # seconds that one of the functions takes, on average
_TELL_EVERY = 0.25  # seconds
_loaded: set[Part] = set()  # by this process, or by that from which it was forked
_forked: int | None = None  # what processes tell that an ancestor of this one has forked


def load_or_begin() -> None:
    """Load all parts from the cache, or begin to compile those missing, in forked processes.

    `warm_up` goes on with it, in this process or in one forked from it.
    """
    global _forked  # as processes and pipes belong to the whole process
    missing = [part for part in Part if not load_from_cache(part)]
    if (processes := _processes_for(missing)) > 1:
        _forked = compilers.fork(missing, processes)


def warm_up(
    parts: Collection[Part] = tuple(Part),
    tell: Told = lambda _: None,
    before_compiling: Callable[[], object] = lambda: None,
) -> None:
    """Load parts from the cache, or compile them.

    Args:
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
    processes = _processes_for(missing)
    progress = _CompilationProgress(missing, processes, tell)
    with _compilers(missing, processes) as done:
        before_compiling()
        for part in _compiled_elsewhere(missing, done, progress):
            _load(part)
            tell(part)
            missing.remove(part)
    with following_compilations(compilers.Count(progress.count)):
        for part in missing:
            _load(part)
            tell(part)


def load_from_cache(part: Part) -> bool:
    """Load a part from the cache; stop and return False if something would have to be compiled."""
    if is_loaded(part):
        return True
    try:
        with uncollected(), following_compilations(_RefuseCompilation()):
            _load(part)
    except _NotCached:
        return False
    return True


def is_loaded(part: Part) -> bool:
    """Return whether this process has loaded a part, or needs none as numba is switched off."""
    return is_switched_off() or part in _loaded


def _load(part: Part) -> None:
    """Load a part from the cache, or compile it."""
    WORK[part].whole()
    _loaded.add(part)


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


class _CompilationProgress:
    """Counts functions that are compiled, and tells now and then how far that is.

    Args:
        tell: Called with how far it is.
    """

    def __init__(self, parts: Iterable[Part], processes: int, tell: Told) -> None:
        seconds = sum(WORK[part].seconds for part in parts)
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


def _processes_for(parts: Collection[Part]) -> int:
    """Return in how many processes to compile parts."""
    return len(os.sched_getaffinity(0)) if jit.CACHED and parts else 1


def _compilers(parts: Collection[Part], processes: int) -> AbstractContextManager[int | None]:
    """Return what processes tell that compile parts; None where this process shall do it."""
    if not parts or processes == 1:
        return nullcontext()
    return compilers.started(parts, processes) if _forked is None else nullcontext(_forked)


def _compiled_elsewhere(
    parts: Collection[Part], done: int | None, progress: _CompilationProgress
) -> Iterator[Part]:
    """Yield each part that other processes have compiled into the cache, until they have ended.

    One is never yielded if a process that compiled some of it was killed.
    """
    left = Counter(part for part, _ in PIECES if part in parts)
    while done is not None and (signs := os.read(done, 1024)):
        for sign in signs:
            if sign == compilers.FUNCTION:
                progress.count()
                continue
            part, _ = PIECES[sign]
            left[part] -= 1
            if not left[part]:
                yield part
