"""A tour with a log of its changes: to undo a few takes less than to copy many cities back."""

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined
from service.search.working_tour import (
    UndoableTour,
    dequeue,
    drop_queued,
    exchange_blocks,
    longest_in_place,
    reverse,
    set_city,
    shorter_part,
)

Cities = NDArray[np.int32]

MOST_CHANGES = 10_000  # that the log holds


def make_undoable_tour(n: int) -> UndoableTour:
    """Return a tour through n cities in order, with an empty log and an empty queue."""
    order = np.arange(n, dtype=np.int32)
    return UndoableTour(
        order,
        order.copy(),
        np.zeros(2),
        np.zeros(2),
        np.zeros((MOST_CHANGES, 3), np.int32),
        np.zeros(1, np.int64),
        order.copy(),
        order.copy(),
        np.zeros(n, np.bool_),
        np.zeros(2, np.int64),
    )


@inlined
def save(working: UndoableTour) -> None:
    """Empty the log, so that undo() returns to the tour as it is now."""
    working.changed[0] = 0
    working.saved_length[0], working.saved_length[1] = working.length[0], working.length[1]


@compiled
def undo_from(working: UndoableTour, first: int) -> None:
    """Undo the changes of the log from one on, the last first, but leave both lengths."""
    for k in range(working.changed[0] - 1, first - 1, -1):
        start, a, b = working.changes[k, 0], working.changes[k, 1], working.changes[k, 2]
        if b == 0:
            reverse(working, start, a)
        else:
            exchange_blocks(working, start, b, a)
    working.changed[0] = first


@inlined
def take_back(
    working: UndoableTour, changes: int, queued: int, first_length: float, second_length: float
) -> None:
    """Return to a tour of known lengths, given the numbers of its changes and queued cities."""
    undo_from(working, changes)
    drop_queued(working, queued)
    working.length[0], working.length[1] = first_length, second_length


@compiled
def undo(working: UndoableTour) -> None:
    """Undo all changes since the tour was saved; the queue is left as it is."""
    undo_from(working, 0)
    working.length[0], working.length[1] = working.saved_length[0], working.saved_length[1]


@compiled
def load(working: UndoableTour, tour: Cities, first: float, second: float) -> None:
    """Replace the tour by another of known lengths, empty the queue, and save."""
    while working.ring[1] > 0:
        dequeue(working)
    for k in range(len(tour)):
        set_city(working, k, tour[k])
    working.length[0], working.length[1] = first, second
    save(working)


@inlined
def log(working: UndoableTour, start: int, a: int, b: int) -> None:
    """Add a change to the log: a reversal of `a` cities, or with b > 0 the swap of two blocks."""
    k = working.changed[0]
    working.changes[k, 0], working.changes[k, 1], working.changes[k, 2] = start, a, b
    working.changed[0] = k + 1


@inlined
def reverse_logged(working: UndoableTour, start: int, size: int) -> bool:
    """Reverse a block, or all other cities; return whether it was the others, which are fewer."""
    start, size, others = shorter_part(len(working.tour), start, size)
    log(working, start, size, 0)
    reverse(working, start, size)
    return others


@inlined
def swap_logged(working: UndoableTour, start: int, a: int, b: int) -> None:
    """Swap the block of `a` cities from position start on with the `b` cities that follow it."""
    start, a, b = longest_in_place(len(working.tour), start, a, b)
    log(working, start, a, b)
    exchange_blocks(working, start, a, b)
