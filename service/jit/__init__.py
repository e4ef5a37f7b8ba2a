"""Compile functions with numba, and cache them: no other module imports numba or sets it up."""

from service.jit.before_numba import IGNORED
from service.jit.cache import CACHED, PRECOMPILED, folder, locked
from service.jit.kernels import allocating, compiled, inlined, standalone

__all__ = [
    "CACHED",
    "IGNORED",
    "PRECOMPILED",
    "allocating",
    "compiled",
    "folder",
    "inlined",
    "locked",
    "standalone",
]
