"""Divide the points of a front into cells, and thin them evenly by that."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.pareto import losses

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_TRIES = 6  # to find how wide the cells must be
_CLOSE = 0.1  # by which share the number of occupied cells may miss what was asked for


class Cells(NamedTuple):
    """Points by cell; the first of each cell is the one that dominates most by itself."""

    members: Indices  # (k,), cell by cell
    starts: Indices  # (c + 1,), of each cell in `members`, and the end

    @property
    def firsts(self) -> Indices:
        """The first point of each cell, shape (c,)."""
        return self.members[self.starts[:-1]]


def divided(shares: Array, count: int) -> Cells:
    """Return points in about `count` cells that are cubes in the points' own box. O(k log k).

    Args:
        shares: Shape (k, m), below 1.
        count: How many cells are occupied: at least 1. With k or more each point has its own.
    """
    by_size = np.argsort(-(1.0 - shares).prod(axis=1), kind="stable")
    if count >= len(shares):
        return Cells(by_size, np.arange(1 + len(shares)))
    places, sides = losses(shares)[by_size], 1.0 / (shares.shape[1] - 1)
    along = max(1.0, count**sides)
    for _ in range(_TRIES):
        numbers, occupied = _cell_numbers(places, int(np.ceil(along)))
        found = np.count_nonzero(occupied)
        if abs(found - count) <= _CLOSE * count:
            break
        along = max(1.0, along * (count / found) ** sides)
    # Counted among occupied cells, most numbers have 16 bits: these are sorted by their digits.
    numbers = (np.cumsum(occupied)[numbers] - 1).astype(np.min_scalar_type(found))
    starts = np.concatenate(([0], np.cumsum(np.bincount(numbers))))
    return Cells(by_size[np.argsort(numbers, kind="stable")], starts)


def _cell_numbers(places: Array, along: int) -> tuple[NDArray[np.integer], NDArray[np.bool_]]:
    """Return the number of the cell of each point, and which numbers there are.

    There are `along` cells along each axis.
    """
    columns = np.minimum((places * along).astype(np.int64), along - 1)
    numbers = np.ravel_multi_index(tuple(columns.T), (along,) * places.shape[1])
    occupied = np.zeros(along ** places.shape[1], np.bool_)
    occupied[numbers] = True
    return numbers, occupied


def evenly(indices: Indices, count: int) -> Indices:
    """Return `count` of at least as many indices, evenly spread along them."""
    return indices[np.linspace(0, len(indices) - 1, count).astype(np.intp)]
