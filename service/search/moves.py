"""Moves: exchanges of two or three edges of a tour, found by their gain under a weighted sum.

A move is (gain, start, a, b, flip): the block of `a` cities from position start on is reversed
if `flip` is true, and then swapped with the `b` cities that follow it. With b = 0 that is 2-opt,
with a <= 3 Or-opt (Or, 1976). Without flip it is the only 3-opt exchange that reverses nothing,
and so the one for costs that differ by direction. A move with a = 0 means that none was found.

All searches go through the candidates of a city by ascending cost, and stop at the first from
which on no move can gain enough.
"""

import numpy as np

from service.jit import inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.closing import is_free_end
from service.search.costs import step_costs
from service.search.working_tour import (
    QueuedTour,
    WorkingTour,
    enqueue,
    reverse_block,
    swap_blocks,
    wrap,
)

Move = tuple[float, int, int, int, bool]

LONGEST_SEGMENT = 3


@inlined
def neighbour(working: QueuedTour, city: int, direction: int) -> int:
    """Return the city one position after (direction 1) or before (-1) a city."""
    return working.tour[wrap(working.position[city] + direction, len(working.tour))]


@inlined
def two_opt(working: WorkingTour, scalarization: Scalarization, city: int, least: float) -> Move:
    """Return the best 2-opt move of an edge at the city, if it gains more than `least`.

    Where the city is a free end of a route, its edge is at no cost, and what a move gains is the
    other edge: so all candidates are tried.
    """
    n = len(working.tour)
    best = (least, 0, 0, 0, False)
    for direction in (1, -1):
        after = neighbour(working, city, direction)
        removed = weighted_cost(scalarization, city, after)
        most = np.inf if is_free_end(scalarization.costs.closing, city, after) else removed
        for k in range(scalarization.candidates.shape[1]):
            other = scalarization.candidates[city, k]
            added = scalarization.candidate_costs[city, k]
            if added >= most:
                break
            end = neighbour(working, other, direction)
            gain = (
                removed
                - added
                + weighted_cost(scalarization, other, end)
                - weighted_cost(scalarization, after, end)
            )
            if gain > best[0]:
                first = after if direction == 1 else city
                last = other if direction == 1 else end
                start = working.position[first]
                size = wrap(working.position[last] - start, n) + 1
                best = (gain, start, size, 0, True)
    return best


@inlined
def or_opt(working: WorkingTour, scalarization: Scalarization, city: int, least: float) -> Move:
    """Return the best Or-opt move of a segment that begins or ends at the city.

    If none gains more than `least`, the move has a = 0.
    """
    best = (least, 0, 0, 0, False)
    for direction in (1, -1):
        before = neighbour(working, city, -direction)
        entering = weighted_cost(scalarization, before, city)
        last = city
        for size in range(1, LONGEST_SEGMENT + 1):
            after = neighbour(working, last, direction)
            freed = (
                entering
                + weighted_cost(scalarization, last, after)
                - weighted_cost(scalarization, before, after)
            )
            if freed > best[0]:
                best = best_insertion(
                    working, scalarization, (city, last, size, direction), freed, best
                )
            last = after
    return best


@inlined
def best_insertion(
    working: WorkingTour,
    scalarization: Scalarization,
    segment: tuple[int, int, int, int],
    freed: float,
    best: Move,
) -> Move:
    """Return the better of `best` and the best insertion of a segment.

    Args:
        working: The tour.
        scalarization: The weighted sum, and the candidates beside which to insert.
        segment: (city, last, size, direction): `size` cities from city to last, read in the
            direction. The first, city, is put beside one of its candidates.
        freed: The gain of taking the segment out.
        best: The best move found before.
    """
    n = len(working.tour)
    city, last, size, direction = segment
    start = working.position[city if direction == 1 else last]
    for k in range(scalarization.candidates.shape[1]):
        other = scalarization.candidates[city, k]
        open_gain = freed - scalarization.candidate_costs[city, k]
        if open_gain <= best[0]:
            break
        if wrap(working.position[other] - start, n) < size:
            continue
        for side in (1, -1):
            beyond = neighbour(working, other, side)
            if beyond in (city, last):
                continue
            gain = (
                open_gain
                + weighted_cost(scalarization, other, beyond)
                - weighted_cost(scalarization, last, beyond)
            )
            if gain > best[0]:
                left = other if side == 1 else beyond
                gap = wrap(working.position[left] - start - size + n, n) + 1
                best = (gain, start, size, gap, side != direction)
    return best


@inlined
def block_swap(
    working: QueuedTour, scalarization: Scalarization, city: int, least: float
) -> tuple[Move, Move]:
    """Return two swaps of two blocks; the first block begins right after the city.

    The first swap is the best. The second promises most: its gain leaves out the step that closes
    the tour, from the last city of the second block to the first city of the first.
    If none gains more than `least`, a move has a = 0.
    """
    n = len(working.tour)
    best = promising = (least, 0, 0, 0, False)
    start = wrap(working.position[city] + 1, n)
    removed = weighted_cost(scalarization, city, working.tour[start])
    for k in range(scalarization.candidates.shape[1]):
        third = scalarization.candidates[city, k]
        gain = removed - scalarization.candidate_costs[city, k]
        if gain <= best[0]:
            break
        a = wrap(working.position[third] - start, n)
        if a > 0:
            best, promising = best_second_block(
                working, scalarization, (gain, start, a), best, promising
            )
    return best, promising


@inlined
def best_second_block(
    working: QueuedTour,
    scalarization: Scalarization,
    opened: tuple[float, int, int],
    best: Move,
    promising: Move,
) -> tuple[Move, Move]:
    """Return the two swaps of block_swap() by choice of the second block.

    Args:
        working: The tour.
        scalarization: The weighted sum, and the candidates.
        opened: (gain, start, a): the first block, and what is gained when the step to it is
            removed, and one to the city behind it added.
        best: The best swap found before.
        promising: The one found before that promises most.
    """
    n = len(working.tour)
    gain, start, a = opened
    second, third = working.tour[start], working.tour[wrap(start + a, n)]
    tail = neighbour(working, third, -1)
    gain += weighted_cost(scalarization, tail, third)
    for m in range(scalarization.candidates.shape[1]):
        head = scalarization.candidates[tail, m]
        promised = gain - scalarization.candidate_costs[tail, m]
        if promised <= best[0]:
            break
        b = wrap(working.position[head] - start, n) - a
        if b <= 0:
            continue
        left = neighbour(working, head, -1)
        promised += weighted_cost(scalarization, left, head)
        closed = promised - weighted_cost(scalarization, left, second)
        if promised > promising[0]:
            promising = (promised, start, a, b, False)
        if closed > best[0]:
            best = (closed, start, a, b, False)
    return best, promising


@inlined
def length_change(
    working: WorkingTour, scalarization: Scalarization, start: int, a: int, b: int, flip: bool
) -> tuple[float, float]:
    """Return by how much a move changes both lengths. O(1)."""
    n = len(working.tour)
    before, first = working.tour[wrap(start - 1, n)], working.tour[start]
    last, after = working.tour[wrap(start + a - 1, n)], working.tour[wrap(start + a, n)]
    costs = scalarization.costs
    entered, left = step_costs(costs, before, first), step_costs(costs, last, after)
    if b == 0:
        x, y = step_costs(costs, before, last), step_costs(costs, first, after)
        return x[0] + y[0] - entered[0] - left[0], x[1] + y[1] - entered[1] - left[1]
    end = wrap(start + a + b - 1, n)
    tail, beyond = working.tour[end], working.tour[wrap(end + 1, n)]
    if flip:
        first, last = last, first
    x, y, z = (
        step_costs(costs, before, after),
        step_costs(costs, tail, first),
        step_costs(costs, last, beyond),
    )
    broken = step_costs(costs, tail, beyond)
    return (
        x[0] + y[0] + z[0] - entered[0] - left[0] - broken[0],
        x[1] + y[1] + z[1] - entered[1] - left[1] - broken[1],
    )


@inlined
def apply_move(working: WorkingTour, start: int, a: int, b: int, flip: bool) -> None:
    """Make a move, and queue the cities at the ends of the edges that it exchanges."""
    n = len(working.tour)
    enqueue(working, working.tour[wrap(start - 1, n)])
    enqueue(working, working.tour[start])
    enqueue(working, working.tour[wrap(start + a - 1, n)])
    enqueue(working, working.tour[wrap(start + a, n)])
    if b:
        end = wrap(start + a + b - 1, n)
        enqueue(working, working.tour[end])
        enqueue(working, working.tour[wrap(end + 1, n)])
    if flip:
        reverse_block(working, start, a)
    if b:
        swap_blocks(working, start, a, b)
