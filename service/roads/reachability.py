"""Find stops that have no way by road to or from others, and stops to leave out for that."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import MOST_FAULTS


class MissingWay(NamedTuple):
    """Two stops without a way from the first to the second, and the one of them to leave out."""

    origin: int
    destination: int
    blamed: int


def missing_ways(missing: NDArray[np.bool_]) -> list[MissingWay]:
    """Return a missing way of each stop to leave out, at most MOST_FAULTS of them.

    The stops are those with the most missing ways, each counted without the stops already left out:
    nearly the fewest possible.

    Args:
        missing: Whether no road leads from a stop (row) to another (column), shape (n, n).

    >>> island = np.array([[0, 0, 1], [0, 0, 1], [1, 1, 0]], dtype=bool)
    >>> missing_ways(island)
    [MissingWay(origin=2, destination=0, blamed=2)]
    """
    left = missing.copy()
    ways: list[MissingWay] = []
    while left.any() and len(ways) < MOST_FAULTS:
        blamed = int((left.sum(axis=0) + left.sum(axis=1)).argmax())
        if left[blamed].any():
            ways.append(MissingWay(blamed, int(left[blamed].argmax()), blamed))
        else:
            ways.append(MissingWay(int(left[:, blamed].argmax()), blamed, blamed))
        left[blamed] = left[:, blamed] = False
    return ways


def ways_of_isolated(missing: NDArray[np.bool_]) -> list[MissingWay]:
    """Return a missing way of each stop that no way leads to or from; `missing` is as above.

    >>> island = np.array([[0, 0, 1], [0, 0, 1], [1, 1, 0]], dtype=bool)
    >>> ways_of_isolated(island)
    [MissingWay(origin=2, destination=0, blamed=2)]
    """
    others = len(missing) - 1
    isolated = (missing.sum(axis=0) == others) & (missing.sum(axis=1) == others) & (others > 0)
    return [
        MissingWay(stop, int(missing[stop].argmax()), stop)
        for stop in np.flatnonzero(isolated).tolist()
    ]
