"""Moves that change a tour in a few places, found by their gain under a weight.

A move is (gain, start, a, b, flip): the block of a cities from position start on is reversed
if flip says so, and then swapped with the b cities that follow it. With b = 0 that is 2-opt,
with a at most 3 Or-opt (Or, 1976); without flip it is the only 3-opt exchange that reverses
nothing, and the one to use where costs differ by direction.
"""

from service.jit import inlined
from service.search.candidates import Scalarization, weighted
from service.search.costs import pair
from service.search.working_tour import Route, push, reverse, swap_blocks, wrap

Move = tuple[float, int, int, int, bool]

LONGEST_SEGMENT = 3


@inlined
def beside(route: Route, city: int, direction: int) -> int:
    """The city one position after (1) or before (-1) a city."""
    return route.tour[wrap(route.position[city] + direction, len(route.tour))]


@inlined
def two_opt(route: Route, scalar: Scalarization, city: int, least: float) -> Move:
    """The best exchange of two edges, one of them at the city, that gains more than least."""
    n = len(route.tour)
    found = (least, 0, 0, 0, False)
    for direction in (1, -1):
        after = beside(route, city, direction)
        removed = weighted(scalar, city, after)
        for k in range(scalar.near.shape[1]):
            other = scalar.near[city, k]
            added = scalar.near_costs[city, k]
            if added >= removed:
                break
            end = beside(route, other, direction)
            gain = removed - added + weighted(scalar, other, end) - weighted(scalar, after, end)
            if gain > found[0]:
                first = after if direction == 1 else city
                last = other if direction == 1 else end
                start = route.position[first]
                size = wrap(route.position[last] - start, n) + 1
                found = (gain, start, size, 0, True)
    return found


@inlined
def or_opt(route: Route, scalar: Scalarization, city: int, least: float) -> Move:
    """The best move of up to three cities, the city foremost, that gains more than least."""
    found = (least, 0, 0, 0, False)
    for direction in (1, -1):
        before = beside(route, city, -direction)
        entering = weighted(scalar, before, city)
        last = city
        for size in range(1, LONGEST_SEGMENT + 1):
            after = beside(route, last, direction)
            freed = entering + weighted(scalar, last, after) - weighted(scalar, before, after)
            if freed > found[0]:
                found = insert(route, scalar, (city, last, size, direction), freed, found)
            last = after
    return found


@inlined
def insert(
    route: Route,
    scalar: Scalarization,
    segment: tuple[int, int, int, int],
    freed: float,
    found: Move,
) -> Move:
    """The best place for a segment (city, last, size, direction) beside a candidate of the city.

    Freed is what taking it out gains. A move found before stays unless this one gains more.
    """
    n = len(route.tour)
    city, last, size, direction = segment
    start = route.position[city if direction == 1 else last]
    for k in range(scalar.near.shape[1]):
        other = scalar.near[city, k]
        open_gain = freed - scalar.near_costs[city, k]
        if open_gain <= found[0]:
            break
        if wrap(route.position[other] - start, n) < size:
            continue
        for side in (1, -1):
            beyond = beside(route, other, side)
            if beyond in (city, last):
                continue
            gain = open_gain + weighted(scalar, other, beyond) - weighted(scalar, last, beyond)
            if gain > found[0]:
                left = other if side == 1 else beyond
                gap = wrap(route.position[left] - start - size + n, n) + 1
                found = (gain, start, size, gap, side != direction)
    return found


@inlined
def block_swap(route: Route, scalar: Scalarization, city: int, least: float) -> Move:
    """The best exchange of three edges, one of them leaving the city, that reverses nothing."""
    n = len(route.tour)
    found = (least, 0, 0, 0, False)
    start = wrap(route.position[city] + 1, n)
    second = route.tour[start]
    removed = weighted(scalar, city, second)
    for k in range(scalar.near.shape[1]):
        third = scalar.near[city, k]
        open_gain = removed - scalar.near_costs[city, k]
        if open_gain <= found[0]:
            break
        a = wrap(route.position[third] - start, n)
        if a == 0:
            continue
        tail = beside(route, third, -1)
        open_gain += weighted(scalar, tail, third)
        for m in range(scalar.near.shape[1]):
            head = scalar.near[tail, m]
            gain = open_gain - scalar.near_costs[tail, m]
            if gain <= found[0]:
                break
            b = wrap(route.position[head] - start, n) - a
            if b <= 0:
                continue
            left = beside(route, head, -1)
            gain += weighted(scalar, left, head) - weighted(scalar, left, second)
            if gain > found[0]:
                found = (gain, start, a, b, False)
    return found


@inlined
def change(
    route: Route, scalar: Scalarization, start: int, a: int, b: int, flip: bool
) -> tuple[float, float]:
    """How much both lengths change by a move."""
    n = len(route.tour)
    before, first = route.tour[wrap(start - 1, n)], route.tour[start]
    last, after = route.tour[wrap(start + a - 1, n)], route.tour[wrap(start + a, n)]
    costs = scalar.costs
    entered, left = pair(costs, before, first), pair(costs, last, after)
    if b == 0:
        x, y = pair(costs, before, last), pair(costs, first, after)
        return x[0] + y[0] - entered[0] - left[0], x[1] + y[1] - entered[1] - left[1]
    end = wrap(start + a + b - 1, n)
    tail, beyond = route.tour[end], route.tour[wrap(end + 1, n)]
    if flip:
        first, last = last, first
    x, y, z = pair(costs, before, after), pair(costs, tail, first), pair(costs, last, beyond)
    broken = pair(costs, tail, beyond)
    return (
        x[0] + y[0] + z[0] - entered[0] - left[0] - broken[0],
        x[1] + y[1] + z[1] - entered[1] - left[1] - broken[1],
    )


@inlined
def apply(route: Route, start: int, a: int, b: int, flip: bool) -> None:
    """Makes a move, and queues the cities at its ends."""
    n = len(route.tour)
    push(route, route.tour[wrap(start - 1, n)])
    push(route, route.tour[start])
    push(route, route.tour[wrap(start + a - 1, n)])
    push(route, route.tour[wrap(start + a, n)])
    if b:
        end = wrap(start + a + b - 1, n)
        push(route, route.tour[end])
        push(route, route.tour[wrap(end + 1, n)])
    if flip:
        reverse(route, start, a)
    if b:
        swap_blocks(route, start, a, b)
