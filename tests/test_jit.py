"""Compiled code works without a place to cache it in, and beside that of other processes."""

import os
import subprocess
import sys


def test_compiled_code_works_where_it_cannot_be_cached() -> None:
    """Of numba's ways to find a place, the only one left does not apply here."""
    code = (
        "import numpy as np; from service.pareto import best_subset;"
        "points = np.stack([np.arange(9.0), 9 - np.arange(9.0)], axis=1);"
        "print(len(best_subset(points, 3, np.full(2, 10.0))))"
    )
    environment = {
        **os.environ,
        "NUMBA_CACHE_LOCATOR_CLASSES": "numba.core.caching.ZipCacheLocator",
    }
    ran = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True
    )
    assert (ran.stdout, ran.stderr) == ("3\n", "")


def test_two_processes_give_what_they_compile_different_names() -> None:
    """Code of one name from two caches is loaded once, whichever came first (numba#10486)."""
    code = (
        "import numba, service.jit;"
        "kernel = numba.njit(lambda: 1.0); kernel();"
        "print(kernel.overloads[()].fndesc.mangled_name)"
    )
    command = [sys.executable, "-c", code]
    names = [subprocess.run(command, capture_output=True, check=True).stdout for _ in range(2)]
    assert names[0].startswith(b"_Z")
    assert names[0] != names[1]
