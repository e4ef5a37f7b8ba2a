"""Compiled code works without a place to cache it in, and beside that of other processes."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import service

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
        "from service.search.front_points import FrontPoints;"
        "points = np.stack([np.arange(9.0), 9 - np.arange(9.0)], axis=1);"
        "print(len(best_subset(FrontPoints(points, np.full(2, 10.0)), 3)))"
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
    # Each is compiled as a part of other kernels, and for Python.
    assert len(list(tmp_path.rglob("*.nbc"))) == 2 * len(numbers)


def test_a_function_is_compiled_anew_where_one_that_it_calls_has_changed(tmp_path: Path) -> None:
    """numba looks at the module of the function alone."""
    modules = tmp_path / "service" / "search"
    modules.mkdir(parents=True)
    shutil.copytree(Path(service.__file__).parent / "jit", modules.parent / "jit")
    (modules.parent / "__init__.py").touch()
    (modules / "outer.py").write_text(
        "from service.jit import compiled\nfrom service.search.inner import inner\n"
        "@compiled\ndef outer():\n    return inner()\n"
    )
    code = (
        f"import sys; sys.path.insert(0, {str(tmp_path)!r});"
        "from service.search.outer import outer; print(outer())"
    )
    printed = []
    for number in ("1", "22"):  # a file of another size: Python tells those of one second so
        (modules / "inner.py").write_text(
            f"from service.jit import inlined\n@inlined\ndef inner():\n    return {number}\n"
        )
        command = [sys.executable, "-c", code]
        ran = subprocess.run(command, capture_output=True, text=True)
        printed.append((ran.stdout, ran.stderr))
    assert printed == [("1\n", ""), ("22\n", "")]


def test_python_cannot_call_what_only_compiled_code_calls(tmp_path: Path) -> None:
    """It has no code that unpacks Python's arguments: the call would end the process."""
    code = "from kernel import eighth, quarter; print(eighth(16.0)); quarter(8.0)"
    kernels = (
        "@jit.inlined\ndef quarter(number):\n    return half(half(number))\n"
        "@jit.compiled\ndef eighth(number):\n    return half(quarter(number))\n"
    )
    (tmp_path / "kernel.py").write_text(KERNEL + kernels)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": f"{tmp_path}:."}
    command = [sys.executable, "-c", code, "0"]
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert ran.stdout == "2.0\n"
    assert "quarter can be called by compiled code alone" in ran.stderr


def test_all_compiled_code_lies_where_a_change_is_noticed() -> None:
    package = Path(service.__file__).parent
    users = [
        path for path in package.rglob("*.py") if "from service.jit import" in path.read_text()
    ]
    folders = {path.relative_to(package).parts[0] for path in users}
    assert folders <= {"coverage", "day", "fleet", "over_the_day", "replanning", "search"}


def test_code_that_cannot_be_kept_is_used_all_the_same_and_said_once(tmp_path: Path) -> None:
    """As where the disk is full. A damaged file is of no use, and is written anew."""
    (tmp_path / "kernel.py").write_text(KERNEL)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": f"{tmp_path}:."}
    full = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500)); "

    def run(code: str) -> tuple[str, str]:
        command = [sys.executable, "-B", "-c", code, "0"]  # else the module would be cut short, too
        ran = subprocess.run(command, env=environment, capture_output=True, text=True)
        return ran.stdout, ran.stderr

    use = "from kernel import half; print(half(3), half(3.0), half.stats.cache_misses.total())"
    printed, warned = run(full + use)
    assert printed == "1.5 1.5 2\n"
    assert warned.count("compiled code cannot be kept") == 1
    assert run(use) == ("1.5 1.5 2\n", "")
    for file in tmp_path.rglob("*.nb?"):
        file.write_bytes(b"")
    assert run(use) == ("1.5 1.5 2\n", "")
    assert run(use) == ("1.5 1.5 0\n", "")
