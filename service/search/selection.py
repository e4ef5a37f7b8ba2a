"""The k-th smallest of some numbers, without sorting them all."""

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled


@compiled
def select(values: NDArray[np.float64], k: int) -> float:
    """Return the number that would be at index k if all were sorted, and reorder them.

    Hoare's FIND (1961), O(m) on average. numba compiles ten functions for np.sort.
    """
    left, right = 0, len(values) - 1
    while left < right:
        middle = values[(left + right) // 2]
        i, j = left, right
        while i <= j:
            while values[i] < middle:
                i += 1
            while values[j] > middle:
                j -= 1
            if i <= j:
                values[i], values[j] = values[j], values[i]
                i += 1
                j -= 1
        if k <= j:
            right = j
        elif k >= i:
            left = i
        else:
            break
    return float(values[k])
