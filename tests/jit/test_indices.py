"""An index counts from the end of an array where it is a number in the source, and nowhere else."""

from pathlib import Path

from tests.helpers.kernel_processes import printed

KERNELS = """
import numba
import numpy as np
from service import jit

@jit.compiled
def last(numbers):
    return numbers[-1]

@jit.compiled
def last_of_row(table, row):
    return table[row, -1]

@jit.compiled
def at(numbers, place):
    return numbers[place]

@numba.njit
def of_others(numbers, place):
    return numbers[place]

@numba.njit(_nrt=False)
def of_others_without_arrays(numbers, place):
    return numbers[place]

@jit.allocating
def copied(numbers, place):
    return numbers.copy()[place]

numbers = np.arange(6.0)
"""


def test_numbers_in_the_source_count_from_the_end_and_so_do_indices_of_others(
    tmp_path: Path,
) -> None:
    (tmp_path / "kernels.py").write_text(KERNELS)
    code = (
        "print(last(numbers), last_of_row(numbers.reshape(2, 3), 0), at(numbers, 5),"
        " of_others(numbers, -2), of_others_without_arrays(numbers, -2), copied(numbers, -2))"
    )
    assert printed(tmp_path, code) == "5.0 2.0 5.0 4.0 4.0 4.0\n"


def test_a_check_of_bounds_finds_any_other_negative_index(tmp_path: Path) -> None:
    (tmp_path / "kernels.py").write_text(KERNELS)
    code = "try:\n    at(numbers, -1)\nexcept IndexError as error:\n    print(error)"
    assert printed(tmp_path, code, NUMBA_BOUNDSCHECK="1") == "index is out of bounds\n"
