"""Other processors, for child processes: code to run before the service is imported."""

import numba
import pytest

import service.jit  # noqa: F401  # chooses what numba compiles for

_OTHER = """
from llvmlite import binding
features = binding.get_host_cpu_features()
features.update({changes})
binding.get_host_cpu_name = lambda: "another"
binding.get_host_cpu_features = lambda: features
"""

ANOTHER_NAME = _OTHER.format(changes={"avx512f": True, "sse4a": False})
WITHOUT_AVX2 = _OTHER.format(changes={"avx2": False})
of_the_level = pytest.mark.skipif(
    numba.config.CPU_NAME is None,  # type: ignore[attr-defined]  # set by service.jit
    reason="this processor is not of the level that is compiled for",
)
