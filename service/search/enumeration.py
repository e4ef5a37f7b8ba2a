"""All tours, where there are so few cities that they are sooner tried than searched."""

from itertools import permutations

import numpy as np
from numpy.typing import NDArray

MOST_ENUMERATED = 7  # cities, and 720 tours


def all_tours(n: int) -> NDArray[np.int32]:
    """Every tour of n cities that sets out from city 0."""
    return np.array([(0, *rest) for rest in permutations(range(1, n))], np.int32)
