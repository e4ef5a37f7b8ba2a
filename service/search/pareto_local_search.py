"""Pareto local searches, which fill the gaps between the points that weighted sums reach.

Pareto local search (Paquete, Chiarandini and Stuetzle, 2004) explores the neighbourhood of one
tour of the front at a time. Here neighbours are sampled rather than enumerated: by iterated
local search under the weighted sum that is tangent to the front at the tour's point. Every tour
on the way is offered to the archive, under both objectives. Of more objectives a front has no
tangent from one point to the next: there, points are searched from that are near the best one
under the weighted sum that is in use.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined
from service.search.archive.layout import Archive, weighted_sum
from service.search.candidates import Scalarization
from service.search.local_search import NO_END, iterated_local_search, random_below
from service.search.sizes import LARGE, MENDING, VAST
from service.search.state import SearchState
from service.search.working_tour import load

Array = NDArray[np.float64]

MANY = 1_200  # cities from which on a round is too long for a rest that is mostly as before
TOURNAMENT_SIZE = 8  # points drawn, to choose one
STEPS = 10  # of the iterated local search at each point
LAST = 2.0**-300  # times the value of a point, which comes after all others
SLOPE_REACH = 5  # points to either side over which the slope of the front is taken


class Round(NamedTuple):
    """A round of iterated local search under all weights; of a large instance, after descents."""

    divisor: int  # of n, which gives the iterations under each weight
    fills: int  # how many times n iterations fill gaps after it


def rounds(n: int, touched: NDArray[np.integer] | None) -> tuple[Round, ...]:
    """Return the rounds of a search for n cities, before weights and gaps compete.

    Args:
        n: The number of cities.
        touched: The cities that have changed, if the search starts from the tours of an earlier
            front. Rounds are short then, as these tours are good already, and gaps are filled after
            each. If gaps alone were filled, more tours would be found than an answer returns, and
            none as short. Of thousands of cities even a short round takes too long: there is one
            only if most cities are touched.
    """
    if touched is None:
        by_iterations = Round(4, 4 if n < LARGE else 0), Round(1, 0)
        return by_iterations if n < VAST else (Round(n, 0), *by_iterations)
    if n < LARGE:
        return (Round(4, 8),) * 4 if n < MENDING else (Round(8, 6),) * 5
    return (Round(8, 0), Round(4, 0)) if n < MANY or 2 * len(touched) > n else ()


@inlined
def front_span(archive: Archive, common: Array, k: int, reach: int) -> tuple[float, float]:
    """Return width and height of the front from `reach` points before a point to `reach` after.

    The span ends before lengths above the common ones: the rest of the front is not near there.
    """
    before, after = max(k - reach, 0), min(k + reach, archive.counts[0] - 1)
    while after > k and archive.lows[after, 0] > common[0]:
        after -= 1
    while before < k and archive.lows[before, 1] > common[1]:
        before += 1
    return (
        archive.lows[after, 0] - archive.lows[before, 0],
        archive.lows[before, 1] - archive.lows[after, 1],
    )


@compiled
def choose_point(archive: Archive, common: Array, random: NDArray[np.int64]) -> int:
    """Choose by tournament a point beside which there is much hypervolume to gain.

    Of a few points drawn at random, that is the one whose neighbours span the largest box, divided
    by one more than the number of times that a search has started from it. Those with a length
    above the common ones come last.
    """
    chosen, largest = 0, -1.0
    for _ in range(TOURNAMENT_SIZE):
        k = random_below(random, archive.counts[0])
        width, height = front_span(archive, common, k, 1)
        value = width * height / (1 + archive.tries[archive.rows[k, 0]])
        if archive.lows[k, 0] > common[0] or archive.lows[k, 1] > common[1]:
            value *= LAST
        if value > largest:
            chosen, largest = k, value
    return chosen


@compiled
def scalarization_at(state: SearchState, common: Array, k: int) -> Scalarization:
    """Return the weighted sum, of those in the state, that is most nearly tangent at a point."""
    width, height = front_span(state.archive, common, k, SLOPE_REACH)
    w0 = height / (width + height) if width + height > 0 else 0.5
    weights, candidates, candidate_costs = state.weighted_candidates
    k = 0
    while k < len(weights) - 1 and weights[k, 0] < w0:
        k += 1
    weight = weights[k]
    return Scalarization(state.costs, candidates[k], candidate_costs[k], weight[0], weight[1])


@compiled
def fill_gaps(state: SearchState, common: Array, rounds: int) -> None:
    """Search from `rounds` points of the front, one after another, each chosen anew.

    Args:
        state: The state of the search.
        common: The greatest length under each objective, shape (2,), of tours without an outlying
            cost that could be avoided.
        rounds: The number of points.
    """
    archive = state.archive
    for _ in range(rounds):
        k = choose_point(archive, common, state.random)
        row = archive.rows[k, 0]
        archive.tries[row] += 1
        scalarization = scalarization_at(state, common, k)
        load(state.working, archive.tours[row], archive.points[row, 0], archive.points[row, 1])
        iterated_local_search(state, scalarization, STEPS, NO_END, True)


@compiled
def choose_row(state: SearchState, weights: Array, least: float) -> int:
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
    state: SearchState,
    scalarization: Scalarization,
    weights: Array,
    least: float,
    rounds: int,
) -> None:
    """Iterate from `rounds` points, one after another, each chosen anew.

    Args:
        state: The state of the search.
        scalarization: The weighted sum, in two costs.
        weights: Its weights, shape (m,).
        least: The least weighted sum found so far.
        rounds: The number of points.
    """
    archive = state.archive
    for _ in range(rounds):
        row = choose_row(state, weights, least)
        archive.tries[row] += 1
        load(state.working, archive.tours[row], weighted_sum(archive, row, weights), 0.0)
        iterated_local_search(state, scalarization, STEPS, NO_END, True)
