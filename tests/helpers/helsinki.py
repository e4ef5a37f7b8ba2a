"""Places in central Helsinki: anywhere, or all within reach of each other by road."""

import numpy as np
from numpy.typing import NDArray

from tests.examples.helsinki import NORTH_EAST, SOUTH_WEST, reachable_places

Array = NDArray[np.float64]
HARBOUR = (24.9606, 60.1652)  # on the water

__all__ = ["HARBOUR", "Array", "any_places", "reachable_places"]


def any_places(n: int, seed: int = 1) -> Array:
    """Return longitude and latitude of places anywhere in the centre, shape (n, 2)."""
    return np.random.default_rng(seed).uniform(SOUTH_WEST, NORTH_EAST, (n, 2)).round(6)
