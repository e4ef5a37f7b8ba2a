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

from service.jit.cache import name_by_place
from service.jit.indices import trust_indices
from service.jit.loading import use_cache
from service.jit.native_code import Standalone, generate_late
from service.jit.resolutions import resolve_once

P = ParamSpec("P")
R = TypeVar("R")
_tuple_of: Any = types.BaseTuple.from_types

generate_late()
resolve_once()


def compiled(function: Callable[P, R]) -> Callable[P, R]:
    """Compile a function that creates no array.

    Division follows numpy, and the interpreter's lock is released. Only an index that is a number
    in the source may be negative.
    """
    return _kernel(function, _compile_as_part, _nrt=False)


def inlined(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, and inline the code at every call: for parts of hot loops.

    Only compiled code can call it.
    """
    return _kernel(
        function, _compile_for_kernels, _nrt=False, forceinline=True, no_cpython_wrapper=True
    )


def standalone(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, but optimise it once: other kernels call its native code.

    That is for large functions, which take long to optimise, and longer to run than a call.
    """
    return _kernel(function, _compile_once, _nrt=False)


def allocating(function: Callable[P, R]) -> Callable[P, R]:
    """Compile as `compiled` does, for a function that creates arrays."""
    return _kernel(function, _compile_as_part, _nrt=True)


def _kernel(
    function: Callable[P, R], set_up: Callable[[Any, Mapping[str, bool]], None], **options: bool
) -> Callable[P, R]:
    """Compile a function at its first call with each combination of argument types."""
    kernel = _dispatcher(function, options)
    if not config.DISABLE_JIT:  # type: ignore[attr-defined]  # set from the environment
        use_cache(kernel)
        set_up(kernel, options)
        kernel.get_call_template = partial(_call_template, kernel.get_call_template)
    return cast("Callable[P, R]", kernel)


def _dispatcher(function: Callable[P, R], options: Mapping[str, bool]) -> Any:
    compile_lazily: Any = numba.njit  # whose types know fewer options than it takes
    usual = {"error_model": "numpy", "nogil": True, "no_cfunc_wrapper": True}
    # Where it is not said, numba takes it from the kernel for which another is compiled first.
    usual["forceinline"] = False
    dispatcher = compile_lazily(**{**usual, **options})(function)
    if not (options["_nrt"] or config.DISABLE_JIT):  # type: ignore[attr-defined]  # as above
        trust_indices(dispatcher)
    return dispatcher


def _compile_as_part(kernel: Any, options: Mapping[str, bool]) -> None:
    """Compile a kernel as a part of other kernels; for Python, native code is made of the part."""
    part = cache(partial(_part_of, kernel, options))
    kernel.get_call_template = lambda *given: part().get_call_template(*given)
    kernel.get_overload = lambda signature: part().get_overload(signature)
    kernel._compiler.compile = lambda arguments, _: _entry(part(), arguments)  # noqa: SLF001


def _part_of(kernel: Any, options: Mapping[str, bool]) -> Any:
    """Return what compiles a kernel as a part of others, and caches it in a file of its own."""
    part = _dispatcher(kernel.py_func, {**options, "no_cpython_wrapper": True})
    part._compiling_counter = kernel._compiling_counter  # noqa: SLF001  # where it calls itself
    use_cache(part, apart=True)
    return part


def _entry(part: Any, arguments: tuple[Any, ...]) -> Any:
    """Return the native code with which Python calls a kernel, made of the kernel as a part."""
    context = part.targetctx.subtarget(enable_nrt=part.targetoptions["_nrt"])
    context.refresh()  # the part may come from the cache, by a process that compiles nothing else
    part.compile(arguments)
    compiled = part.overloads[arguments]
    library = context.codegen().create_library(compiled.fndesc.qualname)
    library.linked = False  # but the part
    library.enable_object_caching()
    library.add_linking_library(compiled.library)
    function = compiled.fndesc, compiled.environment
    with context.push_code_library(library):
        context.create_cpython_wrapper(library, *function, compiled.call_helper, release_gil=True)
        entry_point = context.get_executable(library, *function)
    return compiled._replace(library=library, entry_point=entry_point, metadata=None)


def _compile_for_kernels(kernel: Any, _: Mapping[str, bool]) -> None:
    """Let only other kernels call a kernel: Python's calls fail, and would crash otherwise."""

    def refuse(*_: object) -> NoReturn:
        raise TypeError(f"{kernel.__name__} can be called by compiled code alone")

    kernel._insert = lambda *_, **__: None  # noqa: SLF001  # no compiled code is found for a call
    kernel._compile_for_args = refuse  # noqa: SLF001


def _compile_once(kernel: Any, _: Mapping[str, bool]) -> None:
    """Let other kernels call what Python calls."""
    kernel.add_overload = partial(_add_standalone, kernel.add_overload)
    name_by_place(kernel.py_func)


def _add_standalone(add_overload: Callable[[Any], None], compiled: Any) -> None:
    function = compiled.fndesc
    arguments = tuple(compiled.signature.args)
    compiled.library.standalone = Standalone(function.modname, function.qualname, arguments)
    add_overload(compiled)


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
