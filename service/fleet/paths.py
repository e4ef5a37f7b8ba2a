"""Find what the paths through the legs of a fleet cost at the least."""

from collections.abc import Callable, Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rows = Callable[[int], Array]  # returns what the legs from a stop cost, shape (n,)


def least_paths(legs: Rows, n: int, starts: Sequence[int], combine: np.ufunc = np.add) -> Array:
    """Return the least cost of a path from any of the starts to each stop, shape (n,). O(n^2).

    This is Dijkstra's algorithm over arrays.

    Args:
        legs: Returns the costs of the legs from a stop; infinite for forbidden legs.
        starts: The stops where paths may start.
        combine: How the costs of legs make the cost of a path: np.add, or np.maximum.
    """
    least = np.full(n, inf)
    least[list(starts)] = 0.0
    left = np.ones(n, np.bool_)
    for _ in range(n):
        nearest = int(np.where(left, least, inf).argmin())
        if not left[nearest] or least[nearest] == inf:
            break
        left[nearest] = False
        least = np.minimum(least, combine(least[nearest], legs(nearest)))
    return least
