"""Local search under one weighted sum of three or four objectives, which offers all tours it makes.

The moves are those of the search for two objectives; what is kept is decided under all of them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, standalone
from service.search.candidates import Scalarization
from service.search.costs import Costs, sum_lengths
from service.search.local_search import (
    SPIKE,
    improve_at,
    least_gain,
    perturb,
    random_below,
    sum_afresh,
)
from service.search.several.archive import BlockArchive, insert, weighted_sum
from service.search.working_tour import QueuedTour, WorkingTour, dequeue, load, restore, save

Array = NDArray[np.float64]

TOURNAMENT_SIZE = 8  # points drawn, to choose one


class StateOfSeveral(NamedTuple):
    """All that the compiled part of a search reads and changes."""

    costs: Costs
    archive: BlockArchive
    working: WorkingTour
    random: NDArray[np.int64]  # (1,), the state of random_below()


@compiled
def offer(state: StateOfSeveral, working: QueuedTour) -> bool:
    """Offer a working tour to the archive, and return whether it was inserted."""
    sum_lengths(state.costs, working.tour, state.archive.lengths)
    return insert(state.archive, state.archive.lengths, working.tour)


@standalone
def iterate(state: StateOfSeveral, scalarization: Scalarization, steps: int) -> None:
    """Perturb and descend `steps` times, returning to the tour before wherever that was better.

    Every tour on the way is offered to the archive.
    """
    working = state.working
    value = working.length[0] + working.length[1]
    threshold = least_gain(scalarization, value)
    save(working)
    for _ in range(steps):
        perturb(working, scalarization, state.random)
        rounded = working.length[0] + working.length[1] > SPIKE * value
        while working.ring[1] > 0:
            if improve_at(working, scalarization, dequeue(working), threshold):
                offer(state, working)
        if rounded:
            sum_afresh(working, scalarization)
        reached = working.length[0] + working.length[1]
        if reached <= value + threshold:
            value = reached
            save(working)
        else:
            restore(working)


@compiled
def choose_row(state: StateOfSeveral, weights: Array, least: float) -> int:
    """Choose by tournament a point from which to search under a weighted sum.

    Of a few points, drawn from any block and any place in it, that is the one that is least above
    the least weighted sum, multiplied by one more than the number of searches from it so far.
    """
    archive, random = state.archive, state.random
    chosen, smallest = -1, np.inf
    for _ in range(TOURNAMENT_SIZE):
        block = random_below(random, archive.counts[3])
        row = archive.rows[block, random_below(random, archive.sizes[block])]
        value = (weighted_sum(archive, row, weights) - least) * (1 + archive.tries[row])
        if value < smallest:
            chosen, smallest = row, value
    return chosen


@compiled
def search_from_points(
    state: StateOfSeveral,
    scalarization: Scalarization,
    weights: Array,
    least: float,
    rounds: int,
    steps: int,
) -> None:
    """Iterate from `rounds` points, one after another, each chosen anew.

    Args:
        state: The state of the search.
        scalarization: The weighted sum, in two costs.
        weights: Its weights, shape (m,).
        least: The least weighted sum found so far.
        rounds: The number of points.
        steps: The number of iterations from each.
    """
    archive, working = state.archive, state.working
    for _ in range(rounds):
        row = choose_row(state, weights, least)
        archive.tries[row] += 1
        load(working, archive.tours[row], weighted_sum(archive, row, weights), 0.0)
        iterate(state, scalarization, steps)
