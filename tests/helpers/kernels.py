"""Twins of compiled functions that only compiled code can call, for tests to call."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba

P = ParamSpec("P")
R = TypeVar("R")


def for_python(kernel: Callable[P, R]) -> Callable[P, R]:
    """Return a function that calls a kernel, and that Python can call."""
    called: Any = kernel
    twin: Callable[P, R] = numba.njit(lambda *arguments: called(*arguments))
    return twin
