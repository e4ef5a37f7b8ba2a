"""A tour that is being changed: cities by position, positions by city, and what to look at."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined

Cities = NDArray[np.int32]


class Route(NamedTuple):
    """A tour with its inverse, and the queue of cities whose surroundings changed."""

    tour: Cities  # (n,)
    position: Cities  # (n,)
    length: NDArray[np.float64]  # (2,)
    kept_tour: Cities  # (n,), what to come back to
    kept_position: Cities  # (n,)
    kept_length: NDArray[np.float64]  # (2,)
    buffer: Cities  # (n,)
    queue: Cities  # (n,), a ring
    queued: NDArray[np.bool_]  # (n,)
    ring: NDArray[np.int64]  # (2,): where the queue begins, how many wait


def make_route(n: int) -> Route:
    """A route through n cities in order, with nothing to look at."""
    order = np.arange(n, dtype=np.int32)
    return Route(
        order,
        order.copy(),
        np.zeros(2),
        order.copy(),
        order.copy(),
        np.zeros(2),
        order.copy(),
        order.copy(),
        np.zeros(n, np.bool_),
        np.zeros(2, np.int64),
    )


@inlined
def push(route: Route, city: int) -> None:
    """Puts a city at the queue's end, unless it waits already."""
    if route.queued[city]:
        return
    route.queued[city] = True
    n = len(route.tour)
    place = route.ring[0] + route.ring[1]
    route.queue[place if place < n else place - n] = city
    route.ring[1] += 1


@inlined
def pop(route: Route) -> int:
    """Takes the city at the queue's beginning."""
    head = route.ring[0]
    city = route.queue[head]
    route.queued[city] = False
    route.ring[0] = head + 1 if head + 1 < len(route.tour) else 0
    route.ring[1] -= 1
    return city


@inlined
def wrap(place: int, n: int) -> int:
    """A position up to n too large or too small, brought back into the tour."""
    if place >= n:
        return place - n
    return place + n if place < 0 else place


@inlined
def put(route: Route, place: int, city: int) -> None:
    """Has a position hold a city."""
    route.tour[place] = city
    route.position[city] = place


@compiled
def push_all(route: Route) -> None:
    """Queues all cities in the order of the tour."""
    for k in range(len(route.tour)):
        push(route, route.tour[k])


@inlined
def copy(source: Cities, target: Cities) -> None:
    """Copies cities one by one; assigning a slice would compile a check of shapes each time."""
    for k in range(len(source)):
        target[k] = source[k]


@inlined
def keep(route: Route) -> None:
    """Remembers the tour as it is now."""
    copy(route.tour, route.kept_tour)
    copy(route.position, route.kept_position)
    route.kept_length[0], route.kept_length[1] = route.length[0], route.length[1]


@inlined
def restore(route: Route) -> None:
    """Comes back to the tour that was kept."""
    copy(route.kept_tour, route.tour)
    copy(route.kept_position, route.position)
    route.length[0], route.length[1] = route.kept_length[0], route.kept_length[1]


@compiled
def take(route: Route, tour: Cities, first: float, second: float) -> None:
    """Makes the route follow a tour of known lengths, with nothing to look at."""
    while route.ring[1] > 0:
        pop(route)
    for k in range(len(tour)):
        put(route, k, tour[k])
    route.length[0], route.length[1] = first, second
    keep(route)


@inlined
def reverse(route: Route, start: int, size: int) -> None:
    """Reverses the block of so many cities from position start on, or all the others."""
    n = len(route.tour)
    if 2 * size > n:
        start = wrap(start + size, n)
        size = n - size
    left, right = start, wrap(start + size - 1, n)
    for _ in range(size // 2):
        first, last = route.tour[left], route.tour[right]
        put(route, left, last)
        put(route, right, first)
        left = left + 1 if left + 1 < n else 0
        right = right - 1 if right > 0 else n - 1


@inlined
def swap_blocks(route: Route, start: int, a: int, b: int) -> None:
    """Swaps the block of a cities from position start on with the b cities that follow it.

    With c cities left over, A B C becomes B A C; read round the tour this is the same as
    swapping B with C or C with A, so the longest of the three stays where it is.
    """
    n = len(route.tour)
    c = n - a - b
    if c < a and b <= a:
        start, a, b = wrap(start + a, n), b, c
    elif c < b:
        start, a, b = wrap(start + a + b, n), c, a
    source = wrap(start + a, n)
    place = start
    for k in range(a):
        route.buffer[k] = route.tour[place]
        place = place + 1 if place + 1 < n else 0
    place = start
    for _ in range(b):
        put(route, place, route.tour[source])
        place = place + 1 if place + 1 < n else 0
        source = source + 1 if source + 1 < n else 0
    for k in range(a):
        put(route, place, route.buffer[k])
        place = place + 1 if place + 1 < n else 0
