"""Decorators that compile functions with numba.

Kernels are plain typed functions over arrays and named tuples of arrays. They are compiled at
the first call and cached on disk, so that a later process only loads them.

numba counts references to every array that a call passes on, atomically, and in a search made
of small functions that takes four fifths of the time. A function that creates no array needs
no counts: its caller holds all that it sees. So most are compiled without numba's run time
(`_nrt`), under which creating an array is a compilation error.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any, NoReturn, ParamSpec, TypeVar, cast

import numba
from numba import types
from numba.core import config

from service.jit.cache import CACHED, cache_apart
from service.jit.loading import use_cache
from service.jit.native_code import generate_late

P = ParamSpec("P")
R = TypeVar("R")
_tuple_of: Any = types.BaseTuple.from_types

generate_late()


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function that creates no array.

    Division follows numpy, and the interpreter's lock is released.
    """
    return _kernel(function, _nrt=False)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, and inline the code at every call: for parts of hot loops.

    Only compiled code can call it.
    """
    return _kernel(function, _nrt=False, forceinline=True, no_cpython_wrapper=True)


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, for a function that creates arrays."""
    return _kernel(function, _nrt=True)


def _kernel(function: Callable[P, R], **options: bool) -> Callable[P, R]:
    """Compile a function at its first call with each combination of argument types.

    It is compiled apart for Python, which needs native code, and for other kernels, which need
    none.
    """
    kernel = _dispatcher(function, **options)
    if config.DISABLE_JIT:  # type: ignore[attr-defined]  # set from the environment
        return cast("Callable[P, R]", kernel)
    if "no_cpython_wrapper" in options:
        kernel.get_call_template = partial(_call_template, kernel.get_call_template)
        _refuse_python(kernel)
    else:
        part = cache(partial(_part_of, kernel, options))
        kernel.get_call_template = partial(
            _call_template, lambda *given: part().get_call_template(*given)
        )
        kernel.get_overload = lambda signature: part().get_overload(signature)
    return cast("Callable[P, R]", kernel)


def _part_of(kernel: Any, options: Mapping[str, bool]) -> Any:
    """Return what compiles a kernel as a part of others, and caches it in a file of its own."""
    part = _dispatcher(kernel.py_func, no_cpython_wrapper=True, **options)
    part._compiling_counter = kernel._compiling_counter  # noqa: SLF001  # where it calls itself
    cache_apart(part)
    return part


def _dispatcher(function: Callable[P, R], **options: bool) -> Any:
    compile_lazily: Any = numba.njit  # whose types know fewer options than it takes
    options |= {"nogil": True, "no_cfunc_wrapper": True}
    dispatcher = compile_lazily(error_model="numpy", **options)(function)
    if CACHED and not config.DISABLE_JIT:  # type: ignore[attr-defined]  # as above
        use_cache(dispatcher)
    return dispatcher


def _call_template(template: Any, types: Sequence[Any], named: Mapping[str, Any]) -> Any:
    """Return how a kernel is called by another one, whose arguments have the given types."""
    return template(
        tuple(map(_widest, types)), {name: _widest(each) for name, each in named.items()}
    )


def _widest(given: Any) -> Any:
    """Return the type as which a kernel takes an argument from another one.

    Otherwise it would be compiled for each width of an index, and for each number in the source.
    """
    given = given if not isinstance(given, types.Literal) else given.literal_type
    if given in types.signed_domain:
        return types.int64
    if isinstance(given, types.Tuple | types.UniTuple):
        return _tuple_of([_widest(each) for each in given])
    return given


def _refuse_python(kernel: Any) -> None:
    """Let Python's calls of a kernel fail: without code that unpacks arguments they would crash."""

    def refuse(*_: object) -> NoReturn:
        raise TypeError(f"{kernel.__name__} can be called by compiled code alone")

    kernel._insert = lambda *_, **__: None  # noqa: SLF001  # no compiled code is found for a call
    kernel._compile_for_args = refuse  # noqa: SLF001
