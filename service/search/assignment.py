"""Lower bounds on the length of a tour where costs may differ by direction.

A tour gives every city one successor: no shorter than the least assignment of successors. Any
prices v of the cities bound it, by the sum of v[j] and of min over j of c[i, j] - v[j], so that
a bound holds however far the assignment has come. Prices are raised along shortest augmenting
paths (Jonker and Volgenant, 1987).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.costs import Costs, pair

Array = NDArray[np.float64]


class Assignment(NamedTuple):
    """Who follows whom so far, and at what prices."""

    prices: Array  # (n,)
    before: NDArray[np.int64]  # (n,): the city that each one follows, or -1
    after: NDArray[np.int64]  # (n,): the city that follows each one, or -1


def make_assignment(n: int) -> Assignment:
    """Nobody follows anybody."""
    return Assignment(np.zeros(n), np.full(n, -1), np.full(n, -1))


@inlined
def cost(costs: Costs, w0: float, w1: float, i: int, j: int) -> float:
    """The weighted cost from i to j; a city cannot follow itself."""
    if i == j:
        return np.inf
    c = pair(costs, i, j)
    return w0 * c[0] + w1 * c[1]


@inlined
def margin(costs: Costs, w0: float, w1: float, prices: Array, i: int) -> float:
    """The least cost of leaving a city, prices deducted."""
    least = np.inf
    for j in range(len(prices)):
        least = min(least, cost(costs, w0, w1, i, j) - prices[j])
    return least


@compiled
def price_bound(costs: Costs, w0: float, w1: float, prices: Array) -> float:
    """The lower bound that prices prove."""
    total = 0.0
    for j in range(len(prices)):
        total += prices[j] + margin(costs, w0, w1, prices, j)
    return total


@allocating
def augment(costs: Costs, w0: float, w1: float, state: Assignment, first: int) -> None:
    """Gives one more city a successor, by a shortest path that moves others on."""
    n = len(state.prices)
    prices = state.prices
    distance = np.full(n, np.inf)
    via = np.full(n, -1)
    settled = np.zeros(n, np.bool_)
    least = margin(costs, w0, w1, prices, first)
    city, end, reached = first, -1, 0.0
    while end < 0:
        closest = -1
        for j in range(n):
            if settled[j]:
                continue
            value = reached + max(0.0, cost(costs, w0, w1, city, j) - prices[j] - least)
            if value < distance[j]:
                distance[j], via[j] = value, city
            if closest < 0 or distance[j] < distance[closest]:
                closest = j
        settled[closest] = True
        reached = distance[closest]
        city = state.before[closest]
        if city < 0:
            end = closest
        else:
            least = cost(costs, w0, w1, city, closest) - prices[closest]
    prices -= np.where(settled, reached - distance, 0.0)
    shift(state, via, end, first)


@compiled
def shift(state: Assignment, via: NDArray[np.int64], end: int, first: int) -> None:
    """Follows a path back from its end, giving each city on it the successor reached there."""
    j, i = end, -1
    while i != first:
        i = via[j]
        handed = state.after[i]
        state.before[j], state.after[i] = i, j
        j = handed
