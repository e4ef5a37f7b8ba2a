"""Compiled code works without a place to cache it in, and beside that of other processes."""

import os
import subprocess
import sys
from pathlib import Path

KERNEL = """
import sys, time
from service import jit
from numba.core.caching import IndexDataCacheFile

@jit.compiled
def half(number):
    return number / 2

load_index = IndexDataCacheFile._load_index
def load_index_slowly(self):
    index = load_index(self)
    time.sleep(float(sys.argv[1]))
    return index
IndexDataCacheFile._load_index = load_index_slowly
"""


def test_compiled_code_works_where_it_cannot_be_cached() -> None:
    """Of numba's ways to find a place, the only one left does not apply here."""
    code = (
        "import numpy as np; from service.search.best_subset import best_subset;"
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


def test_processes_that_compile_one_function_at_once_keep_what_each_compiled(
    tmp_path: Path,
) -> None:
    """Each saves code for another type, and takes so long for it that all do it at once."""
    module = tmp_path / "kernel.py"
    module.write_text(KERNEL)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": f"{tmp_path}:."}

    def run(code: str, seconds: float) -> subprocess.Popen[str]:
        command = [sys.executable, "-c", code, str(seconds)]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)

    numbers = ["3", "3.0", "True"]
    compiling = [run(f"from kernel import half; half({number})", 0.7) for number in numbers]
    assert [process.communicate() for process in compiling] == [("", None)] * len(numbers)
    code = f"from kernel import half; print([half(number) for number in [{', '.join(numbers)}]])"
    printed, _ = run(f"{code}; print(half.stats.cache_misses)", 0).communicate()
    assert printed == "[1.5, 1.5, 0.5]\nCounter()\n"
    assert len(list(tmp_path.rglob("*.nbc"))) == len(numbers)
