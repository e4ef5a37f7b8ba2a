"""Local search by three-opt: descent, and iterated local search that undoes steps without a gain.

Where costs differ by direction, it only makes swaps of blocks, and chains of these.
"""

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined, standalone
from service.search.candidates import Scalarization
from service.search.local_search import (
    LONGEST_BLOCK,
    draw_swap,
    least_gain,
    offer,
    random_below,
    removes_kept_step,
    spiked,
    sum_afresh,
)
from service.search.state import SearchState
from service.search.three_opt.deepening import deepen
from service.search.three_opt.exchanges import NONE, make_exchange, swap_adjacent, wide
from service.search.three_opt.finding import find_exchanges, nothing_found
from service.search.three_opt.swap_chains import improve_by_swaps
from service.search.three_opt.undoable_tour import MOST_CHANGES, save, undo
from service.search.working_tour import UndoableTour, dequeue, enqueue, wrap

MOST_CITIES = (MOST_CHANGES - 2) // 4  # after two swaps, as two exchanges are four changes
KICKS_PER_BRIDGE = 4  # where costs differ by direction, one kick in four is a double bridge


@inlined
def improve_at(
    working: UndoableTour, scalarization: Scalarization, city: int, threshold: float
) -> None:
    """Make the best exchange at a city, or else a longer one, if it gains more than a threshold."""
    found = find_exchanges(working, scalarization, city, nothing_found(threshold))
    _, best, promised, promising = found
    if best[0] != NONE:
        make_exchange(working, scalarization, best)
        enqueue(working, city)
    elif promising[0] != NONE and deepen(working, scalarization, promised, promising, threshold):
        enqueue(working, city)


@standalone
def descend(
    working: UndoableTour,
    scalarization: Scalarization,
    budget: int,
    undoable: bool,
) -> int:
    """Make improving exchanges at queued cities until the queue or `budget` is used up.

    Returns what is left of the budget: 0 if the descent may not have ended. Where it need not be
    undone, the log is emptied on the way; else the budget is one that the log holds.
    """
    value = scalarization.w0 * working.length[0] + scalarization.w1 * working.length[1]
    threshold = least_gain(scalarization, value)
    while working.ring[1] > 0 and budget > 0:
        if not undoable:
            save(working)
        city = dequeue(working)
        if scalarization.costs.symmetric:
            improve_at(working, scalarization, city, threshold)
        else:
            improve_by_swaps(working, scalarization, city, threshold)
        budget -= 1
    return budget


@inlined
def perturb(working: UndoableTour, scalarization: Scalarization, random: NDArray[np.int64]) -> None:
    """Put three adjacent blocks in the opposite order, each as it is: a double bridge.

    Martin, Otto and Felten (1991). It exchanges four steps, and so no exchange undoes it, as one
    would undo the swap of two blocks that perturbs the search by smaller moves. Where the third
    block ends at a step that has to stay, two are swapped all the same.

    Where costs differ by direction, three times in four two blocks alone are swapped. One move
    mostly undoes that, but in an eighth of the time that it takes to mend a double bridge; and a
    search that is perturbed in both ways finds more than by either alone.
    """
    n = len(working.tour)
    start, a, b = draw_swap(working, scalarization, random)
    begin = working.tour[wrap(start + a, n)]
    swap_adjacent(working, scalarization, start, a, b)
    if not scalarization.costs.symmetric and random_below(random, KICKS_PER_BRIDGE) > 0:
        return
    start, a = wide(working.position[begin]), a + b
    c = 1 + random_below(random, min(LONGEST_BLOCK, n // 3))
    if a + c < n and not removes_kept_step(working, scalarization.costs.closing, start, a, c):
        swap_adjacent(working, scalarization, start, a, c)


@compiled
def iterated_local_search(
    state: SearchState,
    working: UndoableTour,
    scalarization: Scalarization,
    steps: int,
    every: int,
) -> None:
    """Perturb and descend `steps` times, undoing all of it wherever the tour before was better.

    One local optimum in `every` is offered to the archive, and the last tour: to offer one takes
    O(n), to find one does not.
    """
    w0, w1 = scalarization.w0, scalarization.w1
    value = w0 * working.length[0] + w1 * working.length[1]
    threshold = least_gain(scalarization, value)
    save(working)
    for step in range(1, steps + 1):
        perturb(working, scalarization, state.random)
        rounded = spiked(working, working.saved_length[0], working.saved_length[1])
        descend(working, scalarization, MOST_CITIES, True)
        if rounded:
            sum_afresh(working, scalarization)
        if step % every == 0:
            offer(state, working)
        reached = w0 * working.length[0] + w1 * working.length[1]
        if reached <= value + threshold:
            value = reached
            save(working)
        else:
            undo(working)
    offer(state, working)
