"""The weights of a search, spread over all trade-offs."""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, least_lengths
from service.objectives import OBJECTIVES
from service.preferences import lattice, spread_out
from service.search.sizes import LARGE, MENDING

Array = NDArray[np.float64]

WEIGHTS = 50  # at 500 cities and 0.3 s better than 100, which get too little time each, and than 35
MENDED_WEIGHTS = 85  # where tours of an earlier front are mended: each needs less time
PARTS = {3: 13, 4: 7}  # of 1, that the weights of a lattice share: 105 and 120 weights
LEAST_SHARE = 1e-3  # of a weight: the other lengths still count at the ends, to break ties
DECADE = 10.0  # between two of the weights that are added where costs are of very different sizes
LEXICOGRAPHIC = 1e3  # times less than the least that decides: at the ends, only to break ties
WIDEST_LOGIT = 7.0  # of a weight, where weights are evenly spaced by their logit


def search_weights(instance: Instance, n: int, mending: bool) -> Array:
    """Return weights of scaled lengths, shape (k, m), rows adding to 1.

    Of two objectives by ascending first weight. Of more in the order of use: each is as far as it
    can be from those before, so that one near to it has a tour that is a good start.

    Args:
        instance: The instance.
        n: The number of cities that the search moves.
        mending: Whether the search sets out from tours of an earlier front.
    """
    if instance.objectives == OBJECTIVES:
        shares = _shares_of_two(instance, n, mending)
    else:
        shares = lattice(instance.objectives, PARTS[instance.objectives])
        shares = shares[spread_out(shares)].clip(LEAST_SHARE)
    weights = shares / np.ldexp(instance.scale, instance.shifts)
    return weights / weights.sum(axis=1, keepdims=True)


def _shares_of_two(instance: Instance, n: int, mending: bool) -> Array:
    """Return by how much either of two objectives counts under each weight, shape (k, 2)."""
    count = MENDED_WEIGHTS if mending and MENDING <= n < LARGE else WEIGHTS
    if n < LARGE:
        share = np.linspace(0.0, 1.0, count).clip(LEAST_SHARE, 1 - LEAST_SHARE)
    else:
        share = 1 / (1 + np.exp(np.linspace(WIDEST_LOGIT, -WIDEST_LOGIT, count)))
    below, above = _extremes(instance)
    return np.concatenate((below, np.stack([share, 1 - share], axis=1), above))


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


def neighbours(weights: Array, k: int, count: int) -> NDArray[np.intp]:
    """Return the `count` weights nearest to weight k, the nearest first, without itself.

    Of two objectives they are those before and after it.
    """
    if weights.shape[1] == OBJECTIVES:
        return np.array([i for i in (k - 1, k + 1) if 0 <= i < len(weights)])
    shares = weights / weights.max(axis=0)
    shares /= shares.sum(axis=1, keepdims=True)
    away = ((shares - shares[k]) ** 2).sum(axis=1)
    away[k] = np.inf
    return away.argsort(kind="stable")[:count]
