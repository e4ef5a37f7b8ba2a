"""What numba resolved for one function serves the next, whatever options and types that has."""

from itertools import permutations
from pathlib import Path

import pytest

from tests.helpers.kernel_processes import printed
from tests.helpers.sampled import IS_WHOLE

KERNELS = """
import numba
import numpy as np
from numba.extending import overload
from service import jit

def absolute_sum(numbers):
    total = 0.0
    for k in range(len(numbers)):
        total = total + max(abs(numbers[k]), 0.0)
    return total

def sums_to_each(numbers):
    sums = np.zeros(len(numbers))
    for k in range(1, len(numbers)):
        sums[k] = sums[k - 1] + max(abs(numbers[k]), 0.0)
    return sums + sums[1:].sum()

def word(numbers):
    letters = ["a", str(max(1, len(numbers)))]
    return "".join(letters) + "b"

creates_none = jit.compiled(absolute_sum)
creates = jit.allocating(sums_to_each)
of_others = numba.njit(sums_to_each)
checked = numba.njit(boundscheck=True, error_model="python", fastmath=True)(absolute_sum)
of_strings = numba.njit(word)

def described(value):
    raise NotImplementedError

@overload(described)
def described_integer(value):
    if isinstance(value, numba.types.Integer):
        return lambda value: "integer"

@numba.njit
def description(value):
    return described(value)
"""
NUMBERS = "np.array([2.0, -1.0, 3.0])"
PAIRS = {
    "creates_none": "absolute_sum",
    "creates": "sums_to_each",
    "of_others": "sums_to_each",
    "checked": "absolute_sum",
    "of_strings": "word",
}
LATE_OVERLOAD = """
print(description(3))

@overload(described)
def described_float(value):
    if isinstance(value, numba.types.Float):
        return lambda value: "float"

print(description(3.0))
"""


@pytest.mark.parametrize("order", list(permutations(PAIRS))[:: 50 if IS_WHOLE else 100])
def test_each_function_does_as_in_python_whatever_was_compiled_before(
    order: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "kernels.py").write_text(KERNELS)
    code = "".join(
        f"print(np.array_equal({name}({NUMBERS}), {PAIRS[name]}({NUMBERS})))\n" for name in order
    )
    assert printed(tmp_path, code) == "True\n" * len(order)


def test_an_overload_that_is_added_later_is_found(tmp_path: Path) -> None:
    (tmp_path / "kernels.py").write_text(KERNELS)
    assert printed(tmp_path, LATE_OVERLOAD) == "integer\nfloat\n"
