"""Exchanges of two or three steps of a tour, for costs that are the same in both directions.

In a direction, a step from a city to the next is removed, and one from the city to one of its
candidates added; then a step at that candidate is removed, and the tour is closed, or one more
is added and one more removed in the same way before: the sequential moves of Lin (1965). Each is
made of two blocks of cities that follow one another in the direction:

    before | first ... last | begin ... end | after

Each block may be reversed, and the two may be swapped. One block alone, reversed, is 2-opt. An
exchange is (gain, kind, direction, first, last, begin, end).
"""

from typing import Any

import numpy as np

from service.jit import inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.closing import is_free_end
from service.search.costs import travel_costs
from service.search.moves import neighbour
from service.search.three_opt.undoable_tour import UndoableTour, reverse_logged, swap_logged
from service.search.working_tour import enqueue, wrap

Exchange = tuple[float, int, int, int, int, int, int]

BREADTH = 5  # candidates that are tried for the second step added; for the first all are

NONE = -1  # the kind of an exchange where none was found
ALONE = 0  # the first block, reversed, without a second
BOTH_REVERSED, SWAPPED, FIRST_REVERSED, SECOND_REVERSED = 1, 2, 3, 4  # the last two swapped too


@inlined
def wide(value: int) -> Any:
    """Return a whole number in 64 bits: numba compiles anew what takes each mix of widths."""
    return np.int64(value)


@inlined
def exchange_of(
    gain: float, kind: int, direction: int, one: tuple[int, int], other: tuple[int, int]
) -> Exchange:
    """Return an exchange of two blocks, each given by the cities at its ends."""
    first, last = wide(one[0]), wide(one[1])
    begin, end = wide(other[0]), wide(other[1])
    return gain, wide(kind), wide(direction), first, last, begin, end


@inlined
def steps_between(working: UndoableTour, city: int, other: int, direction: int) -> int:
    """Return the number of steps from one city to another in a direction."""
    steps = direction * (working.position[other] - working.position[city])
    return wrap(steps, len(working.tour))


@inlined
def best_exchange(
    working: UndoableTour, scalarization: Scalarization, city: int, least: float
) -> Exchange:
    """Return the best exchange that removes a step of a city, if it gains more than `least`.

    Where the city is a free end of a route, its step is at no cost, and what an exchange gains is
    the others: so all candidates are tried.
    """
    best = exchange_of(least, NONE, 1, (0, 0), (0, 0))
    for direction in (1, -1):
        after = neighbour(working, city, direction)
        removed = weighted_cost(scalarization, city, after)
        most = np.inf if is_free_end(scalarization.costs.closing, city, after) else removed
        for k in range(scalarization.candidates.shape[1]):
            other = scalarization.candidates[city, k]
            gain = removed - scalarization.candidate_costs[city, k]
            if scalarization.candidate_costs[city, k] >= most:
                break
            if other == after:
                continue
            best = best_after(working, scalarization, (city, after, other, direction), gain, best)
            best = best_before(working, scalarization, (city, after, other, direction), gain, best)
    return best


@inlined
def best_after(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    gain: float,
    best: Exchange,
) -> Exchange:
    """Return the better of `best` and the best exchange that removes the step after a candidate.

    Args:
        working: The tour.
        scalarization: The weighted sum, and the candidates.
        opened: (city, after, other, direction): the step from city to after is removed, and one
            from city to other, a candidate of it, is added.
        gain: What that gains.
        best: The best exchange found before.
    """
    city, after, other, direction = opened
    end = neighbour(working, other, direction)
    if end == city:
        return best
    gain += weighted_cost(scalarization, other, end)
    closed = gain - weighted_cost(scalarization, after, end)
    if closed > best[0]:
        best = exchange_of(closed, ALONE, direction, (after, other), (0, 0))
    size = steps_between(working, after, other, direction)
    for m in range(min(BREADTH, scalarization.candidates.shape[1])):
        third = scalarization.candidates[end, m]
        partial = gain - scalarization.candidate_costs[end, m]
        if partial <= best[0]:
            break
        if third == other:
            continue
        inside = steps_between(working, after, third, direction) < size
        last = neighbour(working, third, direction if inside else -direction)
        partial += weighted_cost(scalarization, third, last)
        partial -= weighted_cost(scalarization, last, after)
        if partial > best[0]:
            if inside:
                best = exchange_of(
                    partial, SECOND_REVERSED, direction, (after, third), (last, other)
                )
            else:
                best = exchange_of(partial, BOTH_REVERSED, direction, (after, other), (end, last))
    return best


@inlined
def best_before(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    gain: float,
    best: Exchange,
) -> Exchange:
    """Return the same of exchanges that remove the step before a candidate; arguments as there.

    That closes no tour, so a third step is removed behind the candidate.
    """
    city, after, other, direction = opened
    end = neighbour(working, other, -direction)
    if end == city:
        return best
    gain += weighted_cost(scalarization, end, other)
    size = steps_between(working, after, other, direction)
    for m in range(min(BREADTH, scalarization.candidates.shape[1])):
        third = scalarization.candidates[end, m]
        partial = gain - scalarization.candidate_costs[end, m]
        if partial <= best[0]:
            break
        if steps_between(working, after, third, direction) < size:
            continue
        best = best_behind(working, scalarization, opened, (end, third), partial, best)
    return best


@inlined
def best_behind(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    joined: tuple[int, int],
    gain: float,
    best: Exchange,
) -> Exchange:
    """Return the better of `best` and the exchanges that remove a step at a third city.

    Args:
        working: The tour.
        scalarization: The weighted sum.
        opened: As of best_after(); the step before other is removed as well.
        joined: The city before other, and the third, behind it, to which a step from there is
            added.
        gain: What all that gains.
        best: The best exchange found before.
    """
    city, after, other, direction = opened
    end, third = joined
    for side in (direction, -direction):
        if third == (city if side == direction else other):
            continue
        last = neighbour(working, third, side)
        closed = (
            gain
            + weighted_cost(scalarization, third, last)
            - weighted_cost(scalarization, last, after)
        )
        if closed > best[0]:
            if side == direction:
                best = exchange_of(closed, FIRST_REVERSED, direction, (after, end), (other, third))
            else:
                best = exchange_of(closed, SWAPPED, direction, (after, end), (other, last))
    return best


@inlined
def make_exchange(working: UndoableTour, scalarization: Scalarization, exchange: Exchange) -> None:
    """Make an exchange, update both lengths, and queue the cities at the ends of its steps."""
    _, kind, direction, first, last, begin, end = exchange
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
    old_first, old_end = exchange[3], exchange[6]
    replace_step(working, scalarization, (before, old_first), (before, first))
    replace_step(working, scalarization, (left, right), (last, begin))
    replace_step(working, scalarization, (old_end, after), (end, after))


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
