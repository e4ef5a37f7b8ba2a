"""Divide the points of a front into cells, and thin them evenly by that."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from paretour.choice import losses

Array = NDArray[np.float64]
Indices = NDArray[np.intp]

_TRIES = 6  # to find how wide the cells must be
_MOST_ALONG = 2**15  # cells along each axis: four axes then have numbers of 60 bits
_REMAINDERS = 1_000_003  # a prime, so that neighbouring cells have different ones
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
        numbers = _cell_numbers(places, int(np.ceil(along)))
        occupied = _distinct(numbers)
        if abs(occupied - count) <= _CLOSE * count:
            break
        along = min(max(1.0, along * (count / occupied) ** sides), _MOST_ALONG)
    order = np.argsort(numbers, kind="stable")
    begins = np.flatnonzero(np.diff(numbers[order], prepend=-1))
    return Cells(by_size[order], np.append(begins, len(shares)))


def _cell_numbers(places: Array, along: int) -> NDArray[np.int64]:
    """Return the number of the cell of each point, where there are `along` along each axis."""
    columns = np.minimum((places * along).astype(np.int64), along - 1)
    return np.ravel_multi_index(tuple(columns.T), (along,) * places.shape[1])


def _distinct(numbers: NDArray[np.int64]) -> int:
    """Return about how many distinct numbers there are: a few share a remainder. O(k)."""
    seen = np.zeros(_REMAINDERS, np.bool_)
    seen[numbers % _REMAINDERS] = True
    return int(np.count_nonzero(seen))


def evenly(indices: Indices, count: int) -> Indices:
    """Return `count` of at least as many indices, evenly spread along them."""
    return indices[np.linspace(0, len(indices) - 1, count).astype(np.intp)]
