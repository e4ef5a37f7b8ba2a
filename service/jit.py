"""The one place where functions are handed to numba.

Kernels are plain typed functions over arrays and named tuples of arrays. They are compiled at
the first call and kept in numba's cache, so that a later process only loads them.

numba counts references to every array that a call passes on, atomically, and in a search made
of small functions that takes four fifths of the time. A function that creates no array needs
no counts: its caller holds all that it sees. So most are compiled without numba's run time
(`_nrt`), under which creating an array is an error of compilation.
"""

from collections.abc import Callable
from functools import partial
from typing import ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


def _can_be_kept() -> bool:
    """Whether numba finds a place to keep code in: beside this file, or in the user's cache.

    In a container that can write nowhere there is none, and each start compiles anew.
    """
    try:
        numba.njit(cache=True)(lambda: None)
    except RuntimeError:
        return False
    return True


_njit = partial(numba.njit, cache=_can_be_kept(), nogil=True, error_model="numpy")


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """As machine code, with numpy's rules of division and without the interpreter's lock."""
    kernel: Callable[P, R] = _njit(_nrt=False)(function)
    return kernel


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """As compiled, and the code goes to wherever it is called: for small parts of hot loops."""
    kernel: Callable[P, R] = _njit(_nrt=False, forceinline=True)(function)
    return kernel


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """As compiled, for a function that creates arrays."""
    kernel: Callable[P, R] = _njit(_nrt=True)(function)
    return kernel
