"""The tour that a search is changing, and the queue of cities where a move may now gain.

The queue serves as don't-look bits (Bentley, 1992): only around cities that it holds are moves
tried, and a move queues the cities at the ends of the edges that it exchanged.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import by_reference, compiled, inlined

Cities = NDArray[np.int32]


@by_reference
class WorkingTour(NamedTuple):
    """A tour, its inverse, both lengths, a saved copy of these, and a queue of cities."""

    tour: Cities  # (n,)
    position: Cities  # (n,)
    length: NDArray[np.float64]  # (2,)
    saved_tour: Cities  # (n,), what restore() returns to
    saved_position: Cities  # (n,)
    saved_length: NDArray[np.float64]  # (2,)
    buffer: Cities  # (n,), scratch space of swap_blocks()
    queue: Cities  # (n,), a ring buffer
    queued: NDArray[np.bool_]  # (n,), by city: whether the queue holds it
    ring: NDArray[np.int64]  # (2,): place of the queue's head, number of cities in the queue


@by_reference
class UndoableTour(NamedTuple):
    """A working tour that is not copied when it is saved: its changes since then are logged."""

    tour: Cities  # (n,)
    position: Cities  # (n,)
    length: NDArray[np.float64]  # (2,)
    saved_length: NDArray[np.float64]  # (2,)
    changes: Cities  # (MOST_CHANGES, 3), each the start of a block and its size, and of the next
    changed: NDArray[np.int64]  # (1,), how many of these there are
    buffer: Cities  # (n,), scratch space of exchange_blocks()
    queue: Cities  # (n,), a ring buffer
    queued: NDArray[np.bool_]  # (n,), by city: whether the queue holds it
    ring: NDArray[np.int64]  # (2,): place of the queue's head, number of cities in the queue


QueuedTour = WorkingTour | UndoableTour


def make_working_tour(n: int) -> WorkingTour:
    """Return a working tour through n cities in order, with an empty queue."""
    order = np.arange(n, dtype=np.int32)
    return WorkingTour(
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
def enqueue(working: QueuedTour, city: int) -> None:
    """Append a city to the queue, unless the queue holds it."""
    if working.queued[city]:
        return
    working.queued[city] = True
    n = len(working.tour)
    place = working.ring[0] + working.ring[1]
    working.queue[place if place < n else place - n] = city
    working.ring[1] += 1


@inlined
def dequeue(working: QueuedTour) -> int:
    """Remove the city at the head of the queue and return it."""
    head = working.ring[0]
    city = working.queue[head]
    working.queued[city] = False
    working.ring[0] = head + 1 if head + 1 < len(working.tour) else 0
    working.ring[1] -= 1
    return city


@inlined
def drop_queued(working: QueuedTour, size: int) -> None:
    """Remove the cities that were queued last, until `size` are left in the queue."""
    while working.ring[1] > size:
        working.ring[1] -= 1
        place = wrap(working.ring[0] + working.ring[1], len(working.tour))
        working.queued[working.queue[place]] = False


@inlined
def wrap(place: int, n: int) -> int:
    """Return a position modulo n, for positions from -n to 2n - 1."""
    if place >= n:
        return place - n
    return place + n if place < 0 else place


@inlined
def set_city(working: QueuedTour, place: int, city: int) -> None:
    """Put a city at a position."""
    working.tour[place] = city
    working.position[city] = place


@compiled
def enqueue_cities(working: QueuedTour, cities: Cities) -> None:
    """Queue cities in this order."""
    for city in cities:
        enqueue(working, city)


@inlined
def copy_cities(source: Cities, target: Cities) -> None:
    """Copy an array element by element: assigning a slice would check shapes at every call."""
    for k in range(len(source)):
        target[k] = source[k]


@inlined
def save(working: WorkingTour) -> None:
    """Save the tour, its inverse and its lengths."""
    copy_cities(working.tour, working.saved_tour)
    copy_cities(working.position, working.saved_position)
    working.saved_length[0], working.saved_length[1] = working.length[0], working.length[1]


@inlined
def restore(working: WorkingTour) -> None:
    """Return to what was saved last; the queue is left as it is."""
    copy_cities(working.saved_tour, working.tour)
    copy_cities(working.saved_position, working.position)
    working.length[0], working.length[1] = working.saved_length[0], working.saved_length[1]


@compiled
def load(working: WorkingTour, tour: Cities, first: float, second: float) -> None:
    """Replace the tour by another of known lengths, empty the queue, and save."""
    while working.ring[1] > 0:
        dequeue(working)
    for k in range(len(tour)):
        set_city(working, k, tour[k])
    working.length[0], working.length[1] = first, second
    save(working)


@inlined
def reverse_block(working: WorkingTour, start: int, size: int) -> None:
    """Reverse the block of `size` cities from position start on, or else all other cities.

    Both give the same closed tour where costs are symmetric; the shorter part is reversed.
    """
    start, size, _ = shorter_part(len(working.tour), start, size)
    reverse(working, start, size)


@inlined
def shorter_part(n: int, start: int, size: int) -> tuple[int, int, bool]:
    """Return start and size of a block, or of all other cities if fewer, and whether it is they."""
    if 2 * size > n:
        return wrap(start + size, n), n - size, True
    return start, size, False


@inlined
def reverse(working: QueuedTour, start: int, size: int) -> None:
    """Reverse the block of `size` cities from position start on."""
    n = len(working.tour)
    left, right = start, wrap(start + size - 1, n)
    for _ in range(size // 2):
        first, last = working.tour[left], working.tour[right]
        set_city(working, left, last)
        set_city(working, right, first)
        left = left + 1 if left + 1 < n else 0
        right = right - 1 if right > 0 else n - 1


@inlined
def swap_blocks(working: WorkingTour, start: int, a: int, b: int) -> None:
    """Swap the block of `a` cities from position start on with the `b` cities that follow it."""
    start, a, b = longest_in_place(len(working.tour), start, a, b)
    exchange_blocks(working, start, a, b)


@inlined
def longest_in_place(n: int, start: int, a: int, b: int) -> tuple[int, int, int]:
    """Return a swap of two blocks that gives the same closed tour and moves the fewest cities.

    With c cities left over, A B C becomes B A C. As a closed tour this is the same as swapping
    B with C or C with A, so the longest of the three blocks stays where it is.
    """
    c = n - a - b
    if c < a and b <= a:
        return wrap(start + a, n), b, c
    if c < b:
        return wrap(start + a + b, n), c, a
    return start, a, b


@inlined
def exchange_blocks(working: QueuedTour, start: int, a: int, b: int) -> None:
    """Move the block of `a` cities from position start on behind the `b` cities that follow it."""
    n = len(working.tour)
    source = wrap(start + a, n)
    place = start
    for k in range(a):
        working.buffer[k] = working.tour[place]
        place = place + 1 if place + 1 < n else 0
    place = start
    for _ in range(b):
        set_city(working, place, working.tour[source])
        place = place + 1 if place + 1 < n else 0
        source = source + 1 if source + 1 < n else 0
    for k in range(a):
        set_city(working, place, working.buffer[k])
        place = place + 1 if place + 1 < n else 0
