"""The cache of compiled code on disk, from which later processes load it.

numba gives each compiled function a number, to tell functions of one name apart, such as those
inside np.sort and np.argsort. It counts from 1 in every process. If two processes cache two such
functions under one number, a later process calls the one that it loaded first in place of the
other, and dies (numba#10486). So each process counts from a random number here. A standalone
function has the same number in all processes, because code of one process may call it in another.

numba compiles a function again if its own module has changed, but not if only a function that it
calls has changed. So cached code is valid for one state of all modules with compiled code.

If two processes save code of one function at the same time, numba lets both write the same file.
So they save one after another here, and an index never names a file that is not written yet.
"""

import logging
import os
import secrets
from collections.abc import Collection
from contextlib import suppress
from functools import cache
from hashlib import sha256
from itertools import count
from pathlib import Path
from typing import Any

from numba.core import caching
from numba.core.bytecode import FunctionIdentity

from service.jit.places import DIGEST, PACKAGE, PRECOMPILED, folder, locked

_LOG = logging.getLogger("paretour")
_Identity: Any = FunctionIdentity
_identity_of = _Identity.from_function
_NUMBER = "numbered_by_place"


def _number_from_a_random_number() -> None:
    _Identity._unique_ids = count(secrets.randbits(64))  # noqa: SLF001  # it has no setter


_number_from_a_random_number()
os.register_at_fork(after_in_child=_number_from_a_random_number)


def name_by_place(function: Any) -> None:
    """Let compiled code of a function have the same name in every process."""
    place = f"{function.__module__}.{function.__qualname__}"
    setattr(function, _NUMBER, int.from_bytes(sha256(place.encode()).digest()[:8]))


def _identity(function: Any) -> Any:
    """Return what numba knows a function by."""
    identity = _identity_of(function)
    number = getattr(identity.func, _NUMBER, None)
    if number is not None:
        identity.unique_id = number
        identity.unique_name = f"{identity.func_qualname}${number}"
    return identity


_Identity.from_function = staticmethod(_identity)


_NumbaCacheFile: Any = caching.IndexDataCacheFile  # it has no types


class CacheFile(_NumbaCacheFile):  # type: ignore[misc]
    """The cache of one function, which processes write in turn."""

    def __init__(self, cache_path: str, filename_base: str, source_stamp: object) -> None:
        super().__init__(cache_path, filename_base, (source_stamp, DIGEST))

    def load(self, key: Any) -> Any:
        """Return what was compiled; None where there is nothing, or files are damaged."""
        with suppress(Exception):  # of pickle, which has no common class for them
            return super().load(key)
        return None

    def save(self, key: Any, data: Any) -> None:
        """Keep what was compiled, unless the folder cannot be written, or its disk is full."""
        if not os.access(self._cache_path, os.W_OK):
            return
        try:
            self._save(key, data)
        except OSError as error:
            _warn_once(str(error))

    def _save(self, key: Any, data: Any) -> None:
        with locked(self._cache_path):
            files = {}
            with suppress(Exception):  # as above
                files = self._load_index()
            if key not in files:
                files[key] = self._free_name(files.values())
            self._save_data(files[key], data)
            self._save_index(files)

    def _free_name(self, taken: Collection[str]) -> str:
        names = (self._data_name(number) for number in count(1))
        return next(name for name in names if name not in taken)


@cache
def _warn_once(reason: str) -> None:
    _LOG.warning("compiled code cannot be kept, so each start compiles it: %s", reason)


caching.IndexDataCacheFile = CacheFile  # type: ignore[misc]
_NumbaLocator: Any = caching.InTreeCacheLocator


class _PrecompiledLocator(_NumbaLocator):  # type: ignore[misc]
    """Finds the folder of a module's code in PRECOMPILED, which need not be writable."""

    def __init__(self, function: object, module: str) -> None:
        super().__init__(function, module)
        self._cache_path = str(PRECOMPILED / Path(module).parent.relative_to(PACKAGE))

    def ensure_cache_path(self) -> None:
        with suppress(OSError):
            super().ensure_cache_path()

    @classmethod
    def from_function(cls, function: object, module: str) -> "_PrecompiledLocator | None":
        carried = PRECOMPILED.is_dir() and Path(module).is_relative_to(PACKAGE)
        return cls(function, module) if carried else None


caching.CacheImpl._locator_classes.insert(0, _PrecompiledLocator)  # noqa: SLF001  # no setter

CACHED = folder() is not None  # whether later processes load what is compiled
