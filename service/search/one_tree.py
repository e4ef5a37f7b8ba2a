"""Lower bounds on the length of a tour where costs are the same in both directions.

A tour is a spanning tree of all cities but one, plus two edges at that one: no shorter than the
least such 1-tree, whatever penalties are added to the cities and taken off again (Held and
Karp, 1971). The penalties climb by subgradient with the step lengths of Volgenant and Jonker
(1982).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled
from service.search.costs import Costs, pair

Array = NDArray[np.float64]


@allocating
def one_tree(
    costs: Costs, w0: float, w1: float, penalties: Array, degrees: NDArray[np.int64]
) -> float:
    """The length of a least 1-tree under weights and penalties; degrees are filled in.

    City 0 is the one outside the tree; the tree grows from city 1 (Prim, 1957).
    """
    n = len(penalties)
    degrees[:] = 0
    distance = np.full(n, np.inf)
    parent = np.zeros(n, np.int64)
    waiting = np.ones(n, np.bool_)
    waiting[0] = waiting[1] = False
    city, total = 1, 0.0
    for _ in range(n - 2):
        closest = -1
        for j in range(2, n):
            if not waiting[j]:
                continue
            c = pair(costs, city, j)
            value = w0 * c[0] + w1 * c[1] + penalties[city] + penalties[j]
            if value < distance[j]:
                distance[j], parent[j] = value, city
            if closest < 0 or distance[j] < distance[closest]:
                closest = j
        waiting[closest] = False
        degrees[closest] += 1
        degrees[parent[closest]] += 1
        total += distance[closest]
        city = closest
    return total + tie(costs, w0, w1, penalties, degrees)


@compiled
def tie(costs: Costs, w0: float, w1: float, penalties: Array, degrees: NDArray[np.int64]) -> float:
    """The length of the two shortest edges at city 0."""
    least, second = np.inf, np.inf
    nearest, runner_up = 0, 0
    for j in range(1, len(penalties)):
        c = pair(costs, 0, j)
        value = w0 * c[0] + w1 * c[1] + penalties[0] + penalties[j]
        if value < least:
            second, runner_up = least, nearest
            least, nearest = value, j
        elif value < second:
            second, runner_up = value, j
    degrees[0] = 2
    degrees[nearest] += 1
    degrees[runner_up] += 1
    return least + second


class Ascent(NamedTuple):
    """Penalties under way, and the best so far."""

    penalties: Array  # (n,)
    kept: Array  # (n,): those that proved the best bound
    best: Array  # (1,)
    degrees: NDArray[np.int64]  # (n,)
    earlier: NDArray[np.int64]  # (n,): degrees one step before


def make_ascent(penalties: Array) -> Ascent:
    """An ascent from given penalties."""
    n = len(penalties)
    degrees = np.full(n, 2)
    return Ascent(penalties.copy(), penalties.copy(), np.full(1, -np.inf), degrees, degrees.copy())


@allocating
def ascend(costs: Costs, w0: float, w1: float, ascent: Ascent, shares: Array) -> None:
    """Takes one step for each of the shares that the step length should have of its largest."""
    n = len(ascent.penalties)
    for share in shares:
        ascent.earlier[:] = ascent.degrees
        length = one_tree(costs, w0, w1, ascent.penalties, ascent.degrees)
        bound = length - 2 * ascent.penalties.sum()
        if bound > ascent.best[0]:
            ascent.best[0] = bound
            ascent.kept[:] = ascent.penalties
        step = share * ascent.best[0] / (2 * n)
        for j in range(n):
            slope = 0.6 * (ascent.degrees[j] - 2) + 0.4 * (ascent.earlier[j] - 2)
            ascent.penalties[j] += step * slope
