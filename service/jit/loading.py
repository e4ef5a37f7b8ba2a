"""Load compiled code without what compiles it.

Before numba loads a function from its cache, it imports all that it could compile. And it imports
the modules of its own whose code the function contains. One of these imports half of scipy. That
takes longer than to load a search. A process that compiles imports all of it then.
"""

from collections.abc import Callable
from functools import cache, partial
from importlib import import_module
from typing import Any

from numba.core import caching, environment
from numba.core.environment import Environment, lookup_environment
from numba.core.runtime.nrt import rtsys

from service.jit.cache import CACHED, CacheFile

_NumbaCache: Any = caching.FunctionCache  # it has no types


class _Cache(_NumbaCache):  # type: ignore[misc]
    """A cache that loads functions, and nothing else but what manages the memory of arrays."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


def _rebuild_environment(module: str, constants: list[Any], name: str) -> Any:
    """Return the environment of a cached function: its constants, and the names in its module.

    Compiled code looks up no names; numba's own modules are not imported for them.
    """
    found = lookup_environment(name)
    if found is None:
        numbas = module.startswith("numba.")
        found = Environment({"__name__": module} if numbas else vars(import_module(module)))
        found.consts[:] = constants
        found.env_name = name
        Environment._memo[name] = found  # noqa: SLF001  # it has no setter
    return found


class _OnDemand:
    """A cache that looks for its files when it is first used: most functions are never loaded.

    They are parts of others.
    """

    def __init__(self, make: Callable[[], _Cache]) -> None:
        self._make = cache(make)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._make(), name)


def use_cache(dispatcher: Any, *, apart: bool = False) -> None:
    """Let the dispatcher of a function load what it has compiled before.

    With `apart`, that is kept apart from what another dispatcher of the function has compiled.
    """
    if CACHED:  # as its enable_caching does
        dispatcher._cache = _OnDemand(partial(_cache_of, dispatcher.py_func, apart))  # noqa: SLF001


def _cache_of(function: Any, apart: bool) -> _Cache:
    found = _Cache(function)
    if apart:
        name = f"{found._impl.filename_base}-part"  # noqa: SLF001  # numba has no option for it
        stamp = found._impl.locator.get_source_stamp()  # noqa: SLF001
        found._cache_file = CacheFile(found.cache_path, name, stamp)  # noqa: SLF001
    return found


environment._rebuild_env = _rebuild_environment  # noqa: SLF001
