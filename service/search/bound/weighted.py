"""Lower bounds on the weighted lengths of all tours, weight by weight, ever better."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.search.bound.assignment import augment, make_assignment, price_bound
from service.search.bound.one_tree import ascend, make_ascent
from service.search.costs import Costs
from service.watch import Watch

Array = NDArray[np.float64]
Sum = tuple[Costs, float, float]  # two costs, and the weights under which they are added

STEPS = 200  # of the subgradient ascent at each weight
BLOCK = 1_000_000  # costs computed between two checks of the deadline
SLACK = 1e-9  # share by which a lower bound is lowered, far above what rounding can raise it


def lowest_sums(
    sums: Sequence[Sum], order: Sequence[int], places: Array, watch: Watch[Any]
) -> Array:
    """Return a lower bound on the length of all tours under each weighted sum, shape (k,).

    By the Held-Karp bound where costs are symmetric, else by the assignment bound.

    Args:
        sums: The weighted sums.
        order: The order in which they get their bounds.
        places: Where their weights are, shape (k, d): each begins with what was found for the
            nearest weight before.
        watch: Asked at least every few ms whether to end. The bounds are valid however early.
    """
    bounds = one_tree_bounds if sums[0][0].symmetric else assignment_bounds
    lowest = np.zeros(len(sums))
    for k, value in bounds(sums, order, places):
        lowest[k] = max(lowest[k], value * (1 - SLACK))
        if watch.ended():
            break
    return lowest


def one_tree_bounds(
    sums: Sequence[Sum], order: Sequence[int], places: Array
) -> Iterator[tuple[int, float]]:
    """Yield pairs of an index and a lower bound under that weighted sum; costs are symmetric."""
    n = len(sums[0][0].cities)
    block = max(1, BLOCK // n**2)
    shares = (1 - np.arange(STEPS) / STEPS) ** 2
    penalties: dict[int, Array] = {}
    for k in order:
        before = list(penalties)
        distances = np.linalg.norm(places[before] - places[k], axis=1)
        nearest = penalties[before[int(distances.argmin())]] if before else np.zeros(n)
        ascent = make_ascent(nearest)
        for begin in range(0, STEPS, block):
            ascend(*sums[k], ascent, shares[begin : begin + block])
            yield k, float(ascent.best_bound[0])
        penalties[k] = ascent.best_penalties


def assignment_bounds(
    sums: Sequence[Sum], order: Sequence[int], _: Array
) -> Iterator[tuple[int, float]]:
    """Yield pairs of an index and a lower bound under that weighted sum."""
    n = len(sums[0][0].cities)
    for k in order:
        assignment = make_assignment(n)
        for city in range(n):
            augment(*sums[k], assignment, city)
            if city == n - 1 or city % max(1, BLOCK // n**2) == 0:
                yield k, price_bound(*sums[k], assignment.prices)
