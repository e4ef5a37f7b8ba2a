"""Native code for the functions that Python calls, compiled and loaded in any order."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

KERNELS = """
import numba
import numpy as np
from service import jit

@jit.compiled
def half(number):
    return number / 2.0

@jit.inlined
def quarter(number):
    return half(half(number))

@jit.compiled
def eighth(number):
    return half(quarter(number))

@jit.allocating
def sixteenths(numbers):
    result = np.empty(len(numbers))
    for k in range(len(numbers)):
        result[k] = half(eighth(numbers[k]))
    return np.sort(result)

@jit.compiled
def factorial(number):
    return 1 if number < 2 else number * factorial(number - 1)

@numba.njit(cache=True)
def of_others(numbers):
    if len(numbers) == 0:
        raise ValueError("no number to divide")
    return sixteenths(numbers)[0] + eighth(8.0) + factorial(3)
"""
CALLS = {
    "half": ("half(3.0)", "1.5"),
    "eighth": ("eighth(4.0)", "0.5"),
    "sixteenths": ("sixteenths(np.array([32.0, 16.0])).tolist()", "[1.0, 2.0]"),
    "factorial": ("factorial(5)", "120"),
    "of_others": ("of_others(np.array([48.0]))", "10.0"),
    "refused": ("refusal(of_others, np.empty(0))", "no number to divide"),
}
REFUSAL = """
def refusal(function, *arguments):
    try:
        function(*arguments)
    except ValueError as refused:
        return refused
"""


@pytest.mark.parametrize(
    "order",
    [
        (["half", "eighth", "factorial"], ["of_others", "sixteenths", "refused"]),
        (["of_others", "refused"], ["eighth", "sixteenths", "half", "factorial", "of_others"]),
        (["sixteenths"], ["refused", "of_others", "half", "sixteenths"], ["eighth", "of_others"]),
    ],
)
def test_functions_give_the_same_compiled_and_loaded(
    order: tuple[list[str], ...], tmp_path: Path
) -> None:
    """Each process loads what those before it compiled, and links it to what it compiles itself."""
    (tmp_path / "kernels.py").write_text(KERNELS)
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), "PYTHONPATH": f"{tmp_path}:."}
    for names in order:
        printed = "".join(f"print({CALLS[name][0]})\n" for name in names)
        code = f"from kernels import *\n{REFUSAL}{printed}"
        command = [sys.executable, "-W", "error", "-c", code]
        ran = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert ran.stderr == ""
        assert ran.stdout.split("\n") == [*(CALLS[name][1] for name in names), ""]
