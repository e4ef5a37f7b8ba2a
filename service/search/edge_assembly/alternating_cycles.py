"""Alternating cycles: what two tours differ by, as closed walks along steps of one and the other.

Each city has as many steps of one tour that the other lacks as the other has that it lacks. So all
of them are parted into cycles that follow a step of one tour, then one of the other, and so on. A
tour that takes the other's steps of some cycles in place of its own still has two steps at each
city, though it may fall into several circuits.
"""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.local_search import random_below
from service.search.working_tour import wrap

Cities = NDArray[np.int32]
Counts = NDArray[np.int8]

OWN, OTHER = 0, 1  # whose step it is
NONE = -1


@allocating
def alternating_cycles(
    tour: Cities, position: Cities, other: Cities, random: NDArray[np.int64]
) -> tuple[Cities, NDArray[np.int64]]:
    """Return the cycles by which two tours differ, parted at random where there is a choice.

    Args:
        tour: The cities of one tour in order.
        position: The position of each city in it.
        other: The other tour.
        random: The state of random_below().

    Returns:
        The cities of all cycles, one cycle after another, and where each of them ends. The steps
        of a cycle are from each of its cities to the next, and from the last to the first, those
        of `tour` and of the other in turn.
    """
    n = len(tour)
    steps, left = np.empty((2, n, 2), np.int32), np.zeros((2, n), np.int8)
    places = np.empty(n, np.int32)
    for k in range(n):
        places[other[k]] = k
    add_differing_steps(steps[OWN], left[OWN], tour, other, places)
    add_differing_steps(steps[OTHER], left[OTHER], other, tour, position)
    cities, ends = np.empty(2 * n, np.int32), np.empty(n, np.int64)
    path, seen = np.empty(2 * n + 1, np.int32), np.full((2, n), NONE, np.int32)
    size = count = 0
    for city in range(n):
        while left[OWN, city] > 0:
            path[0], seen[0, city] = city, 0
            last = 0
            while left[last & 1, path[last]] > 0:
                last += 1
                whose = (last - 1) & 1
                path[last] = follow_step(steps[whose], left[whose], path[last - 1], random)
                first = seen[last & 1, path[last]]
                if first == NONE:
                    seen[last & 1, path[last]] = last
                    continue
                size = append_cycle(cities, size, path, first, last)
                ends[count] = size
                count += 1
                for k in range(first + 1, last):
                    seen[k & 1, path[k]] = NONE
                last = first
            seen[0, city] = NONE
    return cities[:size], ends[:count]


@compiled
def add_differing_steps(
    steps: Cities, left: Counts, tour: Cities, other: Cities, places: Cities
) -> None:
    """Add the steps of a tour that another lacks, at both of their cities.

    Args:
        steps: Shape (n, 2), to add to.
        left: How many there are at each city.
        tour: The tour.
        other: The other tour.
        places: The position of each city in the other.
    """
    n = len(tour)
    for k in range(n):
        city, after = tour[k], tour[wrap(k + 1, n)]
        place = places[city]
        if after == other[wrap(place + 1, n)] or after == other[wrap(place - 1, n)]:
            continue
        steps[city, left[city]] = after
        steps[after, left[after]] = city
        left[city] += 1
        left[after] += 1


@inlined
def follow_step(steps: Cities, left: Counts, city: int, random: NDArray[np.int64]) -> int:
    """Take one of the steps that are left at a city, and return the city at its other end."""
    which = random_below(random, 2) if left[city] > 1 else 0
    beyond = steps[city, which]
    drop_step(steps, left, city, which)
    drop_step(steps, left, beyond, 0 if steps[beyond, 0] == city else 1)
    return beyond


@inlined
def drop_step(steps: Cities, left: Counts, city: int, which: int) -> None:
    """Drop one of the steps that are left at a city."""
    left[city] -= 1
    steps[city, which] = steps[city, left[city]]


@inlined
def append_cycle(cities: Cities, size: int, path: Cities, first: int, last: int) -> int:
    """Append the cycle that a path has closed from `first` on, and return how many cities follow.

    It begins with an own step, which are those from even places of a path on.
    """
    for k in range(first + first % 2, last):
        cities[size] = path[k]
        size += 1
    if first % 2 == 1:
        cities[size] = path[first]
        size += 1
    return size
