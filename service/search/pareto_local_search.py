"""A Pareto local search that fills the gaps between the points that weighted sums reach.

Pareto local search (Paquete, Chiarandini and Stuetzle, 2004) explores the neighbourhood of one
tour of the front at a time. Here neighbours are sampled rather than enumerated: by iterated
local search under the weighted sum that is tangent to the front at the tour's point. Every tour
on the way is offered to the archive, under both objectives.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, least_lengths
from service.jit import compiled, inlined
from service.search.archive import Archive
from service.search.candidates import CANDIDATES_PER_CITY, Scalarization
from service.search.costs import Costs
from service.search.local_search import NO_END, iterated_local_search, random_below
from service.search.working_tour import WorkingTour, load

Array = NDArray[np.float64]

WEIGHTS = 50  # at 500 cities and 0.3 s better than 100, which get too little time each, and than 35
MENDED_WEIGHTS = 85  # where tours of an earlier front are mended: each needs less time
LEAST_SHARE = 1e-3  # of a weight: the other length still counts at the ends, to break ties
DECADE = 10.0  # between two of the weights that are added where costs are of very different sizes
LEXICOGRAPHIC = 1e3  # times less than the least that decides: at the ends, only to break ties
WIDEST_LOGIT = 7.0  # of a weight, where weights are evenly spaced by their logit
LARGE = 500  # cities from which on weights are spaced so; at 400 that is worse in the first second
MENDING = 100  # cities from which on earlier tours are mended by three-opt: too good for two-opt
MANY = 1_200  # cities from which on a round is too long for a rest that is mostly as before
VAST = 7_000  # cities from which on a round of descents alone is first; at 5,000 it gains nothing
TOURNAMENT_SIZE = 8  # points drawn, to choose one
STEPS = 10  # of the iterated local search at each point
LAST = 2.0**-300  # times the value of a point, which comes after all others
SLOPE_REACH = 5  # points to either side over which the slope of the front is taken


class WeightedCandidates(NamedTuple):
    """Weights spread over all trade-offs, and the candidate lists under each of them."""

    weights: Array  # (k, 2), rows adding to 1, by ascending first weight
    candidates: NDArray[np.int32]  # (k, n, candidates)
    candidate_costs: Array  # (k, n, candidates)


def make_weighted_candidates(instance: Instance, n: int, mending: bool) -> WeightedCandidates:
    """Return weights, for scaled lengths, and empty candidate lists of n cities under each.

    With `mending` the search sets out from tours of an earlier front.
    """
    count = MENDED_WEIGHTS if mending and MENDING <= n < LARGE else WEIGHTS
    if n < LARGE:
        share = np.linspace(0.0, 1.0, count).clip(LEAST_SHARE, 1 - LEAST_SHARE)
    else:
        share = 1 / (1 + np.exp(np.linspace(WIDEST_LOGIT, -WIDEST_LOGIT, count)))
    below, above = _extremes(instance)
    shares = np.concatenate((below, np.stack([share, 1 - share], axis=1), above))
    weights = shares / np.ldexp(instance.scale, instance.shifts)
    weights /= weights.sum(axis=1, keepdims=True)
    candidates = np.zeros((len(weights), n, min(CANDIDATES_PER_CITY, n - 1)), np.int32)
    return WeightedCandidates(weights, candidates, np.zeros(candidates.shape))


def _extremes(instance: Instance) -> tuple[Array, Array]:
    """Return shares to add before the least first weight and after the greatest, shape (k, 2) each.

    Without outliers there are none. With them, trade-offs lie further apart: an
    outlier of one objective has to count as little as a common cost of the other, and where tours
    need only costs far below the scale, these have to count as much.
    """
    larger = instance.extents / instance.scale
    if (larger <= 1).all():
        return np.empty((0, 2)), np.empty((0, 2))
    least = least_lengths(instance)
    known = np.isfinite(least) & (least > 0)
    smaller = np.where(known, instance.scale / np.where(known, least, 1.0), 1.0).clip(1.0)
    below, above = (
        LEAST_SHARE * DECADE ** -np.arange(1.0, np.ceil(np.log10(ratio)) + 1)
        for ratio in LEXICOGRAPHIC * larger * smaller[::-1]
    )
    few = [np.stack([ratios / (1 + ratios), 1 / (1 + ratios)], axis=1) for ratios in (below, above)]
    return few[0][::-1], few[1][:, ::-1]


def bisection_order(count: int) -> list[int]:
    """Return 0 to count - 1: both ends first, then the middles of shorter and shorter intervals.

    Each weight then has neighbours on either side whose tours are good starts for it.
    """
    order = [0, count - 1]
    intervals = [(0, count - 1)]
    for low, high in intervals:
        if high - low > 1:
            middle = (low + high) // 2
            order.append(middle)
            intervals += [(low, middle), (middle, high)]
    return order


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


class SearchState(NamedTuple):
    """All that the compiled part of a search reads and changes."""

    costs: Costs
    weighted_candidates: WeightedCandidates
    archive: Archive
    working: WorkingTour
    random: NDArray[np.int64]  # (1,), the state of random_below()


@inlined
def front_span(archive: Archive, common: Array, k: int, reach: int) -> tuple[float, float]:
    """Return width and height of the front from `reach` points before a point to `reach` after.

    The span ends before lengths above the common ones: the rest of the front is not near there.
    """
    before, after = max(k - reach, 0), min(k + reach, archive.counts[0] - 1)
    while after > k and archive.points[after, 0] > common[0]:
        after -= 1
    while before < k and archive.points[before, 1] > common[1]:
        before += 1
    return (
        archive.points[after, 0] - archive.points[before, 0],
        archive.points[before, 1] - archive.points[after, 1],
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
        value = width * height / (1 + archive.tries[archive.slots[k]])
        if archive.points[k, 0] > common[0] or archive.points[k, 1] > common[1]:
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
    archive, working = state.archive, state.working
    for _ in range(rounds):
        k = choose_point(archive, common, state.random)
        slot = archive.slots[k]
        archive.tries[slot] += 1
        scalarization = scalarization_at(state, common, k)
        load(working, archive.tours[slot], archive.points[k, 0], archive.points[k, 1])
        iterated_local_search(working, scalarization, archive, state.random, STEPS, NO_END, True)
