"""The places of compiled code: beside the modules, in a folder of the user, or in a wheel.

A wheel or an image can carry compiled code in the folder PRECOMPILED. The folder's name says which
processes can use it; all others use numba's own cache.
"""

import fcntl
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

import numba
from llvmlite import binding
from numba.core import config
from numba.core.codegen import get_host_cpu_features

from service.jit.processor import compile_for_the_level

compile_for_the_level()

PACKAGE = Path(__file__).parents[1]


def _digest() -> str:
    """Return a digest of the modules whose functions and numbers are compiled."""
    names = ("coverage", "day", "fleet", "jit", "over_the_day", "replanning", "search")
    folders = (PACKAGE / name for name in names)
    modules = [*PACKAGE.glob("*.py"), *(path for each in folders for path in each.rglob("*.py"))]
    return sha256(b"".join(path.read_bytes() for path in sorted(modules))).hexdigest()


DIGEST = _digest()


def _precompiled() -> Path:
    """Return the folder for code of these modules, this numba, this Python and this processor."""
    settings: Any = config
    processor = (
        binding.get_process_triple(),
        settings.CPU_NAME or binding.get_host_cpu_name(),
        get_host_cpu_features() if settings.CPU_FEATURES is None else settings.CPU_FEATURES,
    )
    described = (DIGEST, numba.__version__, sys.implementation.cache_tag, *processor)
    return PACKAGE / "precompiled" / sha256(repr(described).encode()).hexdigest()[:16]


PRECOMPILED = _precompiled()  # does not exist where nothing was compiled in advance


@contextmanager
def locked(path: str | Path) -> Iterator[None]:
    """Wait until no other process holds a folder or file, and hold it."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        fcntl.flock(descriptor, fcntl.LOCK_UN)  # for a process forked meanwhile too
        os.close(descriptor)


def folder() -> Path | None:
    """Return the folder that numba finds: in PRECOMPILED, beside this file, or the user's.

    A read-only container may have none, and each start compiles anew. What else later processes
    need may be kept there too.
    """
    try:
        cached: Any = numba.njit(cache=True)(lambda: None)
    except RuntimeError:
        return None
    return Path(cached._cache.cache_path) if hasattr(cached, "_cache") else None  # noqa: SLF001  # it has no getter
