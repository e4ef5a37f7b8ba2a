"""A first tour under a weight, where there is none to set out from."""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating
from service.search.candidates import Scalar, weighted

Cities = NDArray[np.int32]


@allocating
def nearest_neighbour(scalar: Scalar, first: int, tour: Cities) -> None:
    """Fills tour by going to the nearest city not yet visited, candidates before all others."""
    n = len(tour)
    rest = np.arange(n).astype(np.int32)  # the unvisited, in the first n - k places
    place = rest.copy()
    city = first
    for k in range(n):
        tour[k] = city
        last = rest[n - 1 - k]
        rest[place[city]] = last
        place[last] = place[city]
        place[city] = -1
        if k == n - 1:
            break
        following = -1
        for other in scalar.near[city]:
            if place[other] >= 0:
                following = other
                break
        if following < 0:
            least = np.inf
            for j in range(n - 1 - k):
                value = weighted(scalar, city, rest[j])
                if value < least:
                    least, following = value, rest[j]
        city = following
