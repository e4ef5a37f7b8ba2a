"""The decorators of `kernels` for a numba that lacks a name which these need: slower, not other."""

from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import numba

from service.jit.places import folder

P = ParamSpec("P")
R = TypeVar("R")
_compile: Any = numba.njit(error_model="numpy", nogil=True, cache=folder() is not None)


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function as numba does, with the division of numpy and without Python's lock."""
    found: Callable[P, R] = _compile(function)
    return found


allocating = inlined = standalone = compiled
