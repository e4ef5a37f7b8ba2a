"""Chains of swaps of two adjacent blocks, for costs that differ by direction.

A swap of two blocks exchanges three steps and reverses nothing. Where none gains, the one that
promises most is made, and from the far end of the step that closed it another is looked for, which
removes that step again. If both together do not gain either, a third is tried after the one that
promises most then: seven steps in all. Kanellakis and Papadimitriou (1980) search by such chains,
after Lin and Kernighan (1973), and to any length. With a fourth swap fronts are better where each
cost is drawn on its own, but worse where costs obey the triangle inequality, as those of ways do.
"""

from service.jit import inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.moves import block_swap
from service.search.three_opt.exchanges import swap_adjacent
from service.search.three_opt.undoable_tour import take_back
from service.search.working_tour import UndoableTour, enqueue, wrap

MOST_SWAPS = 3  # of a chain


@inlined
def improve_by_swaps(
    working: UndoableTour, scalarization: Scalarization, city: int, threshold: float
) -> bool:
    """Make the best swap at a city, or else a chain of swaps, if it gains more than a threshold.

    Args:
        working: The tour; its log has room for MOST_SWAPS changes.
        scalarization: The weighted sum, and the candidates.
        city: The city after which the first block of the first swap begins.
        threshold: What all swaps together must gain.

    Returns:
        Whether any were made. If not, the tour, its log and its queue are as they were.
    """
    n, tour = len(working.tour), working.tour
    changes, queued = working.changed[0], working.ring[1]
    first_length, second_length = working.length[0], working.length[1]
    tip, gained = city, 0.0
    for swaps in range(1, MOST_SWAPS + 1):
        best, promising = block_swap(working, scalarization, tip, threshold - gained)
        ends = best[2] > 0
        promised, start, a, b, _ = best if ends else promising
        if a == 0 or (swaps == MOST_SWAPS and not ends):
            break
        first, tip = tour[start], tour[wrap(start + a + b - 1, n)]
        swap_adjacent(working, scalarization, start, a, b)
        if ends:
            enqueue(working, city)
            return True
        gained += promised - weighted_cost(scalarization, tip, first)
    take_back(working, changes, queued, first_length, second_length)
    return False
