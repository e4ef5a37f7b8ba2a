"""Compile functions with numba, and cache them: no other module imports numba or sets it up."""

import logging

from service.jit.before_numba import IGNORED
from service.jit.places import PRECOMPILED, folder, locked
from service.jit.private_names import missing_name
from service.jit.references import by_reference

if (_missing := missing_name()) is None:
    from service.jit.kernels import allocating, compiled, inlined, standalone
else:
    from service.jit.plain import allocating, compiled, inlined, standalone

    logging.getLogger("paretour").warning(
        "numba has no %s: it compiles for longer, and the search is slower", _missing
    )

CACHED = folder() is not None  # whether later processes load what is compiled

__all__ = [
    "CACHED",
    "IGNORED",
    "PRECOMPILED",
    "allocating",
    "by_reference",
    "compiled",
    "folder",
    "inlined",
    "locked",
    "standalone",
]
