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

numba compiles a function anew where its own module has changed, but not where a function that it
calls has. So what is cached belongs to one state of all modules with compiled code.

Nor does numba expect two processes to save code of one function at once: both would take the same
file. So they do it one after another, and an index never names a file that is not written yet.

numba compiles for the processor that it runs on, and what it compiles is of no use to another. The
search is as fast if it is compiled for the level x86-64-v3, which most such processors since 2015
are of. So it is compiled for that level wherever the processor is of it. A wheel or an image can
then carry compiled code in the folder PRECOMPILED. Its name says for which processes it is, and
others do not look into it: they use numba's own cache.
"""

import fcntl
import os
import secrets
import sys
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache, partial
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any, NoReturn, ParamSpec, TypeVar, cast

import numba
from llvmlite import binding
from numba import types
from numba.core import caching, config
from numba.core.bytecode import FunctionIdentity
from numba.core.codegen import get_host_cpu_features

from service.native_code import generate_late

P = ParamSpec("P")
R = TypeVar("R")


def _number_from_a_random_number() -> None:
    FunctionIdentity._unique_ids = count(secrets.randbits(64))  # noqa: SLF001  # it has no setter


_number_from_a_random_number()
os.register_at_fork(after_in_child=_number_from_a_random_number)


_LEVEL = "x86-64-v3"
_FEATURES_OF_THE_LEVEL = (  # as LLVM names them
    *("crc32", "cx16", "popcnt", "sahf", "sse3", "sse4.1", "sse4.2", "ssse3"),  # x86-64-v2
    *("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave"),
)


def _compile_for_the_level() -> None:
    """Compile for the level and not for this processor, if it has what the level demands.

    NUMBA_CPU_NAME and NUMBA_CPU_FEATURES, where they are set, are obeyed.
    """
    settings: Any = config
    if settings.CPU_NAME is not None or settings.CPU_FEATURES is not None:
        return
    if {f"+{name}" for name in _FEATURES_OF_THE_LEVEL} <= set(get_host_cpu_features().split(",")):
        settings.CPU_NAME, settings.CPU_FEATURES = _LEVEL, ""


_compile_for_the_level()
generate_late()
_PACKAGE = Path(__file__).parent


def _digest() -> str:
    """Return a digest of the modules whose functions and numbers are compiled."""
    folders = (
        _PACKAGE / name for name in ("coverage", "fleet", "over_the_day", "replanning", "search")
    )
    modules = [*_PACKAGE.glob("*.py"), *(path for each in folders for path in each.rglob("*.py"))]
    return sha256(b"".join(path.read_bytes() for path in sorted(modules))).hexdigest()


_DIGEST = _digest()


def _precompiled() -> Path:
    """Return the folder for code of these modules, this numba, this Python and this processor."""
    settings: Any = config
    processor = (
        binding.get_process_triple(),
        settings.CPU_NAME or binding.get_host_cpu_name(),
        get_host_cpu_features() if settings.CPU_FEATURES is None else settings.CPU_FEATURES,
    )
    described = (_DIGEST, numba.__version__, sys.implementation.cache_tag, *processor)
    return _PACKAGE / "precompiled" / sha256(repr(described).encode()).hexdigest()[:16]


PRECOMPILED = _precompiled()  # does not exist where nothing was compiled in advance
_NumbaCacheFile: Any = caching.IndexDataCacheFile  # it has no types


class _CacheFile(_NumbaCacheFile):  # type: ignore[misc]
    """The cache of one function, which processes write in turn."""

    def __init__(self, cache_path: str, filename_base: str, source_stamp: object) -> None:
        super().__init__(cache_path, filename_base, (source_stamp, _DIGEST))

    def save(self, key: Any, data: Any) -> None:
        if not os.access(self._cache_path, os.W_OK):
            return
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
_NumbaLocator: Any = caching.InTreeCacheLocator


class _PrecompiledLocator(_NumbaLocator):  # type: ignore[misc]
    """Finds the folder of a module's code in PRECOMPILED, which need not be writable."""

    def __init__(self, function: object, module: str) -> None:
        super().__init__(function, module)
        self._cache_path = str(PRECOMPILED / Path(module).parent.relative_to(_PACKAGE))

    def ensure_cache_path(self) -> None:
        with suppress(OSError):
            super().ensure_cache_path()

    @classmethod
    def from_function(cls, function: object, module: str) -> "_PrecompiledLocator | None":
        carried = PRECOMPILED.is_dir() and Path(module).is_relative_to(_PACKAGE)
        return cls(function, module) if carried else None


caching.CacheImpl._locator_classes.insert(0, _PrecompiledLocator)  # noqa: SLF001  # no setter


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
    """Return whether numba finds a folder: PRECOMPILED, beside this file, or the user's.

    A read-only container may have none, and each start compiles anew.
    """
    try:
        numba.njit(cache=True)(lambda: None)
    except RuntimeError:
        return False
    return True


_tuple_of: Any = types.BaseTuple.from_types
CACHED = _can_be_cached()  # whether later processes load what is compiled


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
            _call_template, lambda *types: part().get_call_template(*types)
        )
        kernel.get_overload = lambda signature: part().get_overload(signature)
    return cast("Callable[P, R]", kernel)


def _part_of(kernel: Any, options: Mapping[str, bool]) -> Any:
    """Return what compiles a kernel as a part of others, and caches it in a file of its own."""
    part = _dispatcher(kernel.py_func, no_cpython_wrapper=True, **options)
    part._compiling_counter = kernel._compiling_counter  # noqa: SLF001  # where it calls itself
    if CACHED:
        kept = part._cache  # noqa: SLF001  # numba has no option for it
        base = f"{kept._impl.filename_base}-part"  # noqa: SLF001
        kept._cache_file = caching.IndexDataCacheFile(  # noqa: SLF001
            kept.cache_path,
            base,
            kept._impl.locator.get_source_stamp(),  # noqa: SLF001
        )
    return part


def _dispatcher(function: Callable[P, R], **options: bool) -> Any:
    compile_lazily: Any = numba.njit  # whose types know fewer options than it takes
    options |= {"nogil": True, "no_cfunc_wrapper": True}
    return compile_lazily(cache=CACHED, error_model="numpy", **options)(function)


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
