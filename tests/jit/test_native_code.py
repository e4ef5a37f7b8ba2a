"""Native code for the functions that Python calls, compiled and loaded in any order."""

from pathlib import Path

import pytest

from tests.helpers.kernel_processes import printed
from tests.helpers.sampled import IS_WHOLE

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

@jit.standalone
def third(number):
    if number < 0:
        raise ValueError("a third of less than nothing")
    return number / 3.0

@jit.inlined
def ninth(number):
    return third(third(number))

@jit.standalone
def eighteenth(number):
    return half(ninth(number))

@numba.njit(cache=True)
def of_others(numbers):
    if len(numbers) == 0:
        raise ValueError("no number to divide")
    return sixteenths(numbers)[0] + eighth(8.0) + factorial(3) + eighteenth(36.0)

@numba.njit(cache=True)
def more_of_others(numbers):
    return 1.0 + of_others(numbers)
"""
CALLS = {
    "half": ("half(3.0)", "1.5"),
    "eighth": ("eighth(4.0)", "0.5"),
    "sixteenths": ("sixteenths(np.array([32.0, 16.0])).tolist()", "[1.0, 2.0]"),
    "factorial": ("factorial(5)", "120"),
    "third": ("third(12.0)", "4.0"),
    "eighteenth": ("eighteenth(9.0)", "0.5"),
    "negative": ("refusal(eighteenth, -1.0)", "a third of less than nothing"),
    "of_others": ("of_others(np.array([48.0]))", "12.0"),
    "more_of_others": ("more_of_others(np.array([48.0]))", "13.0"),
    "refused": ("refusal(of_others, np.empty(0))", "no number to divide"),
}
# The names of functions that one process calls, and those that later ones do.
AT_NIGHT = (
    (["half", "eighth", "factorial", "third"], ["of_others", "sixteenths", "refused"]),
    (["of_others", "refused"], ["eighth", "sixteenths", "half", "third", "of_others"]),
    (["of_others"], ["more_of_others"], ["more_of_others", "of_others"]),
)
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
        (
            ["sixteenths", "eighteenth"],
            ["refused", "of_others", "half"],
            ["eighth", "factorial", "negative"],
        ),
        *(AT_NIGHT if IS_WHOLE else ()),
    ],
)
def test_functions_give_the_same_compiled_and_loaded(
    order: tuple[list[str], ...], tmp_path: Path
) -> None:
    """Each process loads what those before it compiled, and links it to what it compiles itself."""
    (tmp_path / "kernels.py").write_text(KERNELS)
    for names in order:
        call(tmp_path, *names)


def test_code_finds_a_standalone_function_that_was_compiled_after_it(tmp_path: Path) -> None:
    """Another process has compiled it as well, and kept it later."""
    (tmp_path / "kernels.py").write_text(KERNELS)
    call(tmp_path, "eighteenth")
    for kept in tmp_path.rglob("kernels.third-*"):
        kept.unlink()
    call(tmp_path, "third")
    call(tmp_path, "negative", "eighteenth")


def call(folder: Path, *names: str) -> None:
    """Call functions in a process of its own, with a cache in a folder."""
    calls = "".join(f"print({CALLS[name][0]})\n" for name in names)
    answers = printed(folder, f"{REFUSAL}{calls}")
    assert answers.split("\n") == [*(CALLS[name][1] for name in names), ""]
