"""Kernels read the members of a tuple by reference as they would by value."""

from pathlib import Path

from tests.helpers.kernel_processes import printed

KERNELS = """
from typing import NamedTuple
import numpy as np
from service import jit

class Pair(NamedTuple):
    first: float
    second: int

@jit.by_reference
class Inner(NamedTuple):
    numbers: np.ndarray

@jit.by_reference
class Table(NamedTuple):
    rows: np.ndarray
    flag: bool
    pair: Pair
    weights: tuple[float, float]
    inner: Inner

class State(NamedTuple):
    table: Table
    factor: float

@jit.standalone
def total(state):
    table, factor = state
    found = table.pair.first + table.pair.second + table.weights[1] if table.flag else 0.0
    for row in range(table.rows.shape[0]):
        for column in range(table.rows.shape[1]):
            found += factor * table.rows[row, column]
    return found + table.inner.numbers[0]

@jit.compiled
def doubled(state):
    for place in range(len(state.table.inner.numbers)):
        state.table.inner.numbers[place] *= 2.0
    return total(state)

@jit.allocating
def copied(state):
    return state.table.rows.copy()

@jit.compiled
def lost(state):
    return state.table.nothing

def state(flag=True):
    rows = np.arange(6.0).reshape(2, 3)
    inner = Inner(np.array([7.0, 1.0]))
    return State(Table(rows, flag, Pair(0.5, 2), (1.0, 4.0), inner), 2.0)
"""


def test_members_are_read_and_arrays_among_them_are_changed(tmp_path: Path) -> None:
    """By the process that compiles the kernels, and by the next, which loads them.

    A member that there is not is an error.
    """
    (tmp_path / "kernels.py").write_text(KERNELS)
    code = (
        "given = state()\n"
        "print(total(given), doubled(given), given.table.inner.numbers.tolist(),"
        " total(state(False)), copied(given).sum())\n"
    )
    wrong = (
        "try:\n    lost(state())\nexcept Exception as error:\n"
        "    print(type(error).__name__, 'nothing' in str(error))"
    )
    first, second = printed(tmp_path, code + wrong), printed(tmp_path, code)
    assert first == second + "TypingError True\n"
    assert second == "43.5 50.5 [14.0, 2.0] 37.0 15.0\n"
