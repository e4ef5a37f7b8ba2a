"""Find the best exchange at a city, and the most promising start of a longer one.

An exchange removes steps of the tour and adds others, one after another. At each point the steps
removed must be longer than those added: else no exchange that goes on from there can gain (Lin and
Kernighan, 1973). All added steps are chosen but the last, which closes the tour. Before it is
added, the tour is open; what is gained by then is what a longer exchange begins with.
"""

import numpy as np

from service.jit import inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.closing import is_free_end
from service.search.moves import neighbour
from service.search.three_opt.exchanges import (
    ALONE,
    BOTH_REVERSED,
    FIRST_REVERSED,
    NONE,
    SECOND_REVERSED,
    SWAPPED,
    Exchange,
    exchange_of,
    steps_between,
)
from service.search.working_tour import UndoableTour

# The gain of the best exchange, that exchange; the gain of the promising one before it is closed,
# and that exchange.
Found = tuple[float, Exchange, float, Exchange]

BREADTH = 5  # candidates that are tried for the second step added; for the first all are


@inlined
def nothing_found(least: float) -> Found:
    """Return that no exchange has been found that gains more than `least`."""
    none = exchange_of(NONE, 1, (0, 0), (0, 0), 0)
    return least, none, least, none


@inlined
def better(found: Found, gain: float, closing: float, exchange: Exchange) -> Found:
    """Return what is found with one more exchange, by its gain before the tour is closed."""
    gained, best, promised, promising = found
    if gain - closing > gained:
        gained, best = gain - closing, exchange
    if gain > promised:
        promised, promising = gain, exchange
    return gained, best, promised, promising


@inlined
def find_exchanges(
    working: UndoableTour, scalarization: Scalarization, city: int, found: Found
) -> Found:
    """Look for exchanges that remove a step of a city, in both directions."""
    for direction in (1, -1):
        found = find_in_direction(working, scalarization, city, direction, found)
    return found


@inlined
def find_in_direction(
    working: UndoableTour, scalarization: Scalarization, city: int, direction: int, found: Found
) -> Found:
    """Look for exchanges that remove the step from a city to the next in a direction.

    Where the city is a free end of a route, its step is at no cost, and what an exchange gains is
    the others: so all candidates are tried.
    """
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
        opened = (city, after, other, direction)
        found = find_after(working, scalarization, opened, gain, found)
        found = find_before(working, scalarization, opened, gain, found)
    return found


@inlined
def find_after(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    gain: float,
    found: Found,
) -> Found:
    """Look for exchanges that remove the step after a candidate.

    Args:
        working: The tour.
        scalarization: The weighted sum, and the candidates.
        opened: (city, after, other, direction): the step from city to after is removed, and one
            from city to other, a candidate of it, is added.
        gain: What that gains.
        found: What has been found before.
    """
    city, after, other, direction = opened
    end = neighbour(working, other, direction)
    if end == city:
        return found
    gain += weighted_cost(scalarization, other, end)
    exchange = exchange_of(ALONE, direction, (after, other), (0, 0), end)
    found = better(found, gain, weighted_cost(scalarization, after, end), exchange)
    size = steps_between(working, after, other, direction)
    for m in range(min(BREADTH, scalarization.candidates.shape[1])):
        third = scalarization.candidates[end, m]
        partial = gain - scalarization.candidate_costs[end, m]
        if partial <= found[0]:
            break
        if third == other:
            continue
        inside = steps_between(working, after, third, direction) < size
        last = neighbour(working, third, direction if inside else -direction)
        partial += weighted_cost(scalarization, third, last)
        if inside:
            exchange = exchange_of(SECOND_REVERSED, direction, (after, third), (last, other), last)
        else:
            exchange = exchange_of(BOTH_REVERSED, direction, (after, other), (end, last), last)
        found = better(found, partial, weighted_cost(scalarization, last, after), exchange)
    return found


@inlined
def find_before(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    gain: float,
    found: Found,
) -> Found:
    """Look for exchanges that remove the step before a candidate; arguments as there.

    That closes no tour, so a third step is removed behind the candidate.
    """
    city, after, other, direction = opened
    end = neighbour(working, other, -direction)
    if end == city:
        return found
    gain += weighted_cost(scalarization, end, other)
    size = steps_between(working, after, other, direction)
    for m in range(min(BREADTH, scalarization.candidates.shape[1])):
        third = scalarization.candidates[end, m]
        partial = gain - scalarization.candidate_costs[end, m]
        if partial <= found[0]:
            break
        if steps_between(working, after, third, direction) < size:
            continue
        found = find_behind(working, scalarization, opened, (end, third), partial, found)
    return found


@inlined
def find_behind(
    working: UndoableTour,
    scalarization: Scalarization,
    opened: tuple[int, int, int, int],
    joined: tuple[int, int],
    gain: float,
    found: Found,
) -> Found:
    """Look for exchanges that remove a step at a third city.

    Args:
        working: The tour.
        scalarization: The weighted sum.
        opened: The cities of find_after(); the step before other is removed as well.
        joined: The city before other, and the third, behind it, to which a step from there is
            added.
        gain: What all that gains.
        found: What has been found before.
    """
    city, after, other, direction = opened
    end, third = joined
    for side in (direction, -direction):
        if third == (city if side == direction else other):
            continue
        last = neighbour(working, third, side)
        if side == direction:
            exchange = exchange_of(FIRST_REVERSED, direction, (after, end), (other, third), last)
        else:
            exchange = exchange_of(SWAPPED, direction, (after, end), (other, last), last)
        partial = gain + weighted_cost(scalarization, third, last)
        found = better(found, partial, weighted_cost(scalarization, last, after), exchange)
    return found
