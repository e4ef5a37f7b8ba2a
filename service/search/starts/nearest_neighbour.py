"""Tours by nearest neighbours."""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating
from service.search.candidates import Scalarization, weighted_cost

Cities = NDArray[np.int32]


@allocating
def nearest_neighbour(scalarization: Scalarization, begun: int, tour: Cities) -> None:
    """Fill `tour` after its first `begun` cities, always going to the nearest unvisited city.

    Candidates are looked up first, and all unvisited cities only where no candidate is left.
    """
    n = len(tour)
    unvisited = np.arange(n).astype(np.int32)  # in the first n - k places
    place = unvisited.copy()
    for k in range(n - 1):
        city = tour[k]
        last = unvisited[n - 1 - k]
        unvisited[place[city]] = last
        place[last] = place[city]
        place[city] = -1
        if k < begun - 1:
            continue
        following = -1
        for other in scalarization.candidates[city]:
            if place[other] >= 0:
                following = other
                break
        if following < 0:
            least = np.inf
            for j in range(n - 1 - k):
                value = weighted_cost(scalarization, city, unvisited[j])
                if value < least:
                    least, following = value, unvisited[j]
        tour[k + 1] = following
