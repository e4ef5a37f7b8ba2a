"""Decorators that compile functions with numba: the one place that configures it.

Kernels are plain typed functions over arrays and named tuples of arrays. They are compiled at
the first call and cached on disk, so that a later process only loads them.

numba counts references to every array that a call passes on, atomically, and in a search made
of small functions that takes four fifths of the time. A function that creates no array needs
no counts: its caller holds all that it sees. So most are compiled without numba's run time
(`_nrt`), under which creating an array is a compilation error.

numba numbers what it compiles, from 1 in each process, to tell functions of one name apart: those
inside np.sort from those inside np.argsort. Of two cached by different processes with the same
number, whichever is loaded first is called in the other's place, and the process dies
(numba#10486). So each process begins at a random number, far from those of all others.

Nor does numba expect two processes to save code of one function at once: both would take the same
file. So they do it one after another, and an index never names a file that is not written yet.
"""

import fcntl
import os
import secrets
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from functools import partial
from itertools import count
from typing import Any, ParamSpec, TypeVar

import numba
from numba.core import caching
from numba.core.bytecode import FunctionIdentity

P = ParamSpec("P")
R = TypeVar("R")


def _number_from_a_random_number() -> None:
    FunctionIdentity._unique_ids = count(secrets.randbits(64))  # noqa: SLF001  # it has no setter


_number_from_a_random_number()
os.register_at_fork(after_in_child=_number_from_a_random_number)


_NumbaCacheFile: Any = caching.IndexDataCacheFile  # it has no types


class _CacheFile(_NumbaCacheFile):  # type: ignore[misc]
    """The cache of one function, which processes write in turn."""

    def save(self, key: Any, data: Any) -> None:
        with _locked(self._cache_path):
            files = self._load_index()
            if key not in files:
                files[key] = self._free_name(files.values())
            self._save_data(files[key], data)
            self._save_index(files)

    def _free_name(self, taken: Collection[str]) -> str:
        names = (self._data_name(number) for number in count(1))
        return next(name for name in names if name not in taken)


caching.IndexDataCacheFile = _CacheFile  # type: ignore[misc]


@contextmanager
def _locked(folder: str) -> Iterator[None]:
    """Wait until no other process holds a folder, and hold it."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        fcntl.flock(descriptor, fcntl.LOCK_UN)  # for a process forked meanwhile too
        os.close(descriptor)


def _can_be_cached() -> bool:
    """Return whether numba finds a folder for its cache: beside this file, or the user's.

    A read-only container has none, and each start compiles anew.
    """
    try:
        numba.njit(cache=True)(lambda: None)
    except RuntimeError:
        return False
    return True


CACHED = _can_be_cached()  # whether later processes load what is compiled

_njit = partial(numba.njit, cache=CACHED, nogil=True, error_model="numpy")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function that creates no array.

    Division follows numpy, and the interpreter's lock is released.
    """
    kernel: Callable[P, R] = _njit(_nrt=False)(function)
    return kernel


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, and inline the code at every call: for parts of hot loops."""
    kernel: Callable[P, R] = _njit(_nrt=False, forceinline=True)(function)
    return kernel


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, for a function that creates arrays."""
    kernel: Callable[P, R] = _njit(_nrt=True)(function)
    return kernel
