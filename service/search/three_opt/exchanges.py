"""Exchanges of two or three steps of a tour, for costs that are the same in both directions.

In a direction, a step from a city to the next is removed, and one from the city to one of its
candidates added; then a step at that candidate is removed, and the tour is closed, or one more
is added and one more removed in the same way before: the sequential moves of Lin (1965). Each is
made of two blocks of cities that follow one another in the direction:

    before | first ... last | begin ... end | after

Each block may be reversed, and the two may be swapped. One block alone, reversed, is 2-opt. An
exchange is (kind, direction, first, last, begin, end, tip), where the step that closes the tour is
the one between first and tip.
"""

from typing import Any

import numpy as np

from service.jit import inlined
from service.search.candidates import Scalarization
from service.search.costs import travel_costs
from service.search.moves import neighbour
from service.search.three_opt.undoable_tour import reverse_logged, swap_logged
from service.search.working_tour import UndoableTour, enqueue, wrap

Exchange = tuple[int, int, int, int, int, int, int]

NONE = -1  # the kind of an exchange where none was found
ALONE = 0  # the first block, reversed, without a second
BOTH_REVERSED, SWAPPED, FIRST_REVERSED, SECOND_REVERSED = 1, 2, 3, 4  # the last two swapped too


@inlined
def wide(value: int) -> Any:
    """Return a whole number in 64 bits: numba compiles anew what takes each mix of widths."""
    return np.int64(value)


@inlined
def exchange_of(
    kind: int, direction: int, one: tuple[int, int], other: tuple[int, int], tip: int
) -> Exchange:
    """Return an exchange of two blocks, each given by the cities at its ends."""
    first, last = wide(one[0]), wide(one[1])
    begin, end = wide(other[0]), wide(other[1])
    return wide(kind), wide(direction), first, last, begin, end, wide(tip)


@inlined
def steps_between(working: UndoableTour, city: int, other: int, direction: int) -> int:
    """Return the number of steps from one city to another in a direction."""
    steps = direction * (working.position[other] - working.position[city])
    return wrap(steps, len(working.tour))


@inlined
def make_exchange(working: UndoableTour, scalarization: Scalarization, exchange: Exchange) -> None:
    """Make an exchange, update both lengths, and queue the cities at the ends of its steps."""
    kind, direction, first, last, begin, end, _ = exchange
    before = wide(neighbour(working, first, -direction))
    mirrored = direction == -1
    if kind == ALONE:
        after = wide(neighbour(working, last, direction))
        replace_step(working, scalarization, (before, first), (before, last))
        replace_step(working, scalarization, (last, after), (first, after))
        reverse_path(working, first, last, mirrored)
        return
    after = wide(neighbour(working, end, direction))
    left, right = last, begin
    if kind in (BOTH_REVERSED, FIRST_REVERSED):
        mirrored = reverse_path(working, first, last, mirrored)
        first, last = last, first
    if kind in (BOTH_REVERSED, SECOND_REVERSED):
        mirrored = reverse_path(working, begin, end, mirrored)
        begin, end = end, begin
    if kind != BOTH_REVERSED:
        swap_paths(working, (first, last, begin, end), mirrored)
        first, last, begin, end = begin, end, first, last
    old_first, old_end = exchange[2], exchange[5]
    replace_step(working, scalarization, (before, old_first), (before, first))
    replace_step(working, scalarization, (left, right), (last, begin))
    replace_step(working, scalarization, (old_end, after), (end, after))


@inlined
def swap_adjacent(
    working: UndoableTour, scalarization: Scalarization, start: int, a: int, b: int
) -> None:
    """Swap the block of `a` cities from position start on with the `b` cities that follow it.

    That reverses nothing, so costs may differ by direction.
    """
    n, tour = len(working.tour), working.tour
    one = tour[start], tour[wrap(start + a - 1, n)]
    other = tour[wrap(start + a, n)], tour[wrap(start + a + b - 1, n)]
    make_exchange(working, scalarization, exchange_of(SWAPPED, 1, one, other, 0))


@inlined
def replace_step(
    working: UndoableTour,
    scalarization: Scalarization,
    removed: tuple[int, int],
    added: tuple[int, int],
) -> None:
    """Update both lengths for a step in place of another, and queue the cities of that one."""
    old = travel_costs(scalarization.costs, removed[0], removed[1])
    new = travel_costs(scalarization.costs, added[0], added[1])
    working.length[0] += new[0] - old[0]
    working.length[1] += new[1] - old[1]
    enqueue(working, removed[0])
    enqueue(working, removed[1])


@inlined
def reverse_path(working: UndoableTour, first: int, last: int, mirrored: bool) -> bool:
    """Reverse the cities from one to another, and return whether the tour is mirrored then.

    It is mirrored where its positions ascend against the direction in which first comes before
    last. It becomes so, or no more so, where all other cities are reversed instead.
    """
    if mirrored:
        first, last = last, first
    start = working.position[first]
    size = wrap(working.position[last] - start, len(working.tour)) + 1
    return reverse_logged(working, start, size) != mirrored


@inlined
def swap_paths(working: UndoableTour, blocks: tuple[int, int, int, int], mirrored: bool) -> None:
    """Swap two blocks that follow one another, given by the cities at their ends, in order."""
    first, last, begin, end = blocks
    direction = -1 if mirrored else 1
    a = steps_between(working, first, last, direction) + 1
    b = steps_between(working, begin, end, direction) + 1
    if mirrored:
        swap_logged(working, working.position[end], b, a)
    else:
        swap_logged(working, working.position[first], a, b)
