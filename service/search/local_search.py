"""Iterated local search under one weighted sum."""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.archive import Archive, accepts, insert
from service.search.candidates import Scalarization, weighted
from service.search.costs import lengths
from service.search.moves import apply, block_swap, change, or_opt, two_opt
from service.search.working_tour import Route, keep, pop, push, restore

Cities = NDArray[np.int32]


@allocating
def nearest_neighbour(scalar: Scalarization, first: int, tour: Cities) -> None:
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


LONGEST_STRETCH = 50
MANY = 1 << 60
LEAST_GAIN = 1e-12  # as a share of the weighted length, far above what rounding adds


@inlined
def draw(state: NDArray[np.int64], count: int) -> int:
    """A whole number from 0 to count - 1, count below 2**31, by xorshift (Marsaglia, 2003)."""
    x = state[0]
    x ^= x << 13
    x ^= (x >> 7) & ((1 << 57) - 1)  # the sign must not be drawn in
    x ^= x << 17
    state[0] = x
    return int((x >> 33) & 0x7FFFFFFF) % count


@inlined
def improve_at(route: Route, scalar: Scalarization, city: int, threshold: float) -> bool:
    """Makes the best move at a city, if one gains more than a threshold; says whether."""
    if scalar.costs.symmetric:
        move = or_opt(route, scalar, city, threshold)
        other = two_opt(route, scalar, city, move[0])
        if other[2]:
            move = other
    else:
        move = block_swap(route, scalar, city, threshold)
    if move[2] == 0:
        return False
    make(route, scalar, move[1], move[2], move[3], move[4])
    push(route, city)
    return True


@inlined
def make(route: Route, scalar: Scalarization, start: int, a: int, b: int, flip: bool) -> None:
    """Makes a move and keeps account of both lengths."""
    delta = change(route, scalar, start, a, b, flip)
    apply(route, start, a, b, flip)
    route.length[0] += delta[0]
    route.length[1] += delta[1]


@compiled
def descend(route: Route, scalar: Scalarization, threshold: float, pops: int) -> int:
    """Makes improving moves at queued cities until none waits; gives what is left of pops."""
    while route.ring[1] > 0 and pops > 0:
        improve_at(route, scalar, pop(route), threshold)
        pops -= 1
    return pops


@inlined
def perturb(route: Route, scalar: Scalarization, random: NDArray[np.int64]) -> None:
    """Swaps two neighbouring blocks of random sizes at a random place."""
    n = len(route.tour)
    longest = min(LONGEST_STRETCH, n // 3)
    start = draw(random, n)
    a, b = 1 + draw(random, longest), 1 + draw(random, longest)
    make(route, scalar, start, a, b, False)


@compiled
def submit(route: Route, scalar: Scalarization, archive: Archive) -> bool:
    """Offers the tour to the archive, with its lengths summed afresh if they look welcome."""
    if not accepts(archive, route.length[0], route.length[1]):
        return False
    point = lengths(scalar.costs, route.tour)
    route.length[0], route.length[1] = point
    return insert(archive, point, route.tour)


@compiled
def descend_keenly(route: Route, scalar: Scalarization, archive: Archive, threshold: float) -> None:
    """Descends until no city waits, and offers the archive every tour on the way."""
    while route.ring[1] > 0:
        if improve_at(route, scalar, pop(route), threshold):
            submit(route, scalar, archive)


@compiled
def iterated_local_search(
    route: Route,
    scalar: Scalarization,
    archive: Archive,
    random: NDArray[np.int64],
    steps: int,
    keen: bool,
) -> None:
    """Disturbs and descends so many times; if keen, tours on the way are offered as well."""
    w0, w1 = scalar.w0, scalar.w1
    value = w0 * route.length[0] + w1 * route.length[1]
    threshold = LEAST_GAIN * value
    keep(route)
    for _ in range(steps):
        perturb(route, scalar, random)
        if keen:
            descend_keenly(route, scalar, archive, threshold)
        else:
            descend(route, scalar, threshold, MANY)
        submit(route, scalar, archive)
        reached = w0 * route.length[0] + w1 * route.length[1]
        if reached <= value + threshold:
            value = reached
            keep(route)
        else:
            restore(route)
