"""The processor for which numba compiles: a level that most processors have.

numba compiles for the processor that it runs on, and what it compiles is of no use to another. The
search is as fast if it is compiled for the level x86-64-v3, which most such processors since 2015
are of. So it is compiled for that level wherever the processor is of it.
"""

from typing import Any

from numba.core import config
from numba.core.codegen import get_host_cpu_features

_LEVEL = "x86-64-v3"
_FEATURES_OF_THE_LEVEL = (  # as LLVM names them
    *("crc32", "cx16", "popcnt", "sahf", "sse3", "sse4.1", "sse4.2", "ssse3"),  # x86-64-v2
    *("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave"),
)


def compile_for_the_level() -> None:
    """Compile for the level and not for this processor, if it has what the level demands.

    NUMBA_CPU_NAME and NUMBA_CPU_FEATURES, where they are set, are obeyed.
    """
    settings: Any = config
    if settings.CPU_NAME is not None or settings.CPU_FEATURES is not None:
        return
    if {f"+{name}" for name in _FEATURES_OF_THE_LEVEL} <= set(get_host_cpu_features().split(",")):
        settings.CPU_NAME, settings.CPU_FEATURES = _LEVEL, ""
