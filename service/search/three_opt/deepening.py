"""Longer exchanges: two in sequence, where the first alone gains nothing.

If no exchange of up to three steps gains, the most promising one is made. A second one is searched
from the far end of the step that closed it, and removes that step again: five steps in all. If both
together gain nothing, the first is undone. Continuing from there, as Lin and Kernighan (1973) do,
costs more time than it gains.
"""

from service.jit import compiled, inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.moves import neighbour
from service.search.three_opt.exchanges import ALONE, NONE, Exchange, make_exchange, steps_between
from service.search.three_opt.finding import find_in_direction, nothing_found
from service.search.three_opt.undoable_tour import take_back
from service.search.working_tour import UndoableTour

MOST_MOVED = 300  # cities that the first exchange may move: making and undoing it takes that long


@compiled
def deepen(
    working: UndoableTour,
    scalarization: Scalarization,
    promised: float,
    promising: Exchange,
    threshold: float,
) -> bool:
    """Make an exchange and the best one after it, if both together gain more than a threshold.

    Args:
        working: The tour; its log has room for four changes.
        scalarization: The weighted sum, and the candidates.
        promised: What the first exchange gains before it is closed.
        promising: The first exchange.
        threshold: What both must gain.

    Returns:
        Whether they were made. If not, the tour, its log and its queue are as they were.
    """
    if most_moved(working, promising) > MOST_MOVED:
        return False
    changes, queued = working.changed[0], working.ring[1]
    first, tip = promising[2], promising[6]
    first_length, second_length = working.length[0], working.length[1]
    make_exchange(working, scalarization, promising)
    gained = promised - weighted_cost(scalarization, tip, first)
    back = 1 if neighbour(working, tip, 1) == first else -1
    none = nothing_found(threshold - gained)
    _, best, _, _ = find_in_direction(working, scalarization, tip, back, none)
    if best[0] != NONE:
        make_exchange(working, scalarization, best)
        return True
    take_back(working, changes, queued, first_length, second_length)
    return False


@inlined
def most_moved(working: UndoableTour, exchange: Exchange) -> int:
    """Return how many cities an exchange moves where the longest part of the tour stays."""
    kind, direction, first, last, begin, end, _ = exchange
    n = len(working.tour)
    a = steps_between(working, first, last, direction) + 1
    b = 0 if kind == ALONE else steps_between(working, begin, end, direction) + 1
    return n - max(a, b, n - a - b)
