"""The least costs of paths from stops to all others: Dijkstra's algorithm over arrays."""

from collections.abc import Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def least_paths(costs: Array, starts: Sequence[int], combine: np.ufunc = np.add) -> Array:
    """Return the least cost of a path from one of some starts to each stop, shape (n,). O(n^2).

    Args:
        costs: The costs of legs, shape (n, n); infinite where there is no way.
        starts: The stops where paths may start.
        combine: How the costs of legs make the cost of a path: np.add, or np.maximum.
    """
    least = np.full(len(costs), inf)
    least[list(starts)] = 0.0
    left = np.ones(len(costs), np.bool_)
    for _ in range(len(costs)):
        nearest = int(np.where(left, least, inf).argmin())
        if not left[nearest] or least[nearest] == inf:
            break
        left[nearest] = False
        least = np.minimum(least, combine(least[nearest], costs[nearest]))
    return least
