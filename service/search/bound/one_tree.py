"""Held-Karp lower bounds on the length of a tour, for symmetric costs.

A tour is a 1-tree: a spanning tree of all cities but one, plus two edges at that one. So it is at
least as long as the least 1-tree. That stays true under any penalties added to the costs of all
edges of a city, once twice their sum is deducted (Held and Karp, 1971). The penalties are improved
by subgradient ascent with the step lengths of Volgenant and Jonker (1982). An open route becomes a
tour through city 0, which is invented and at no cost (see closing.py), so the tree is one of all
its cities.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.closing import is_kept, is_open
from service.search.costs import Costs, step_costs

Array = NDArray[np.float64]


@allocating
def one_tree(
    costs: Costs, w0: float, w1: float, penalties: Array, degrees: NDArray[np.int64]
) -> float:
    """Return the length of a least 1-tree under weights and penalties, and fill in its degrees.

    City 0 is the one outside the tree; the tree grows from city 1 (Prim, 1957). O(n^2).
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
            c = step_costs(costs, city, j)
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
    return total + edges_outside_tree(costs, (w0, w1), penalties, degrees)


@inlined
def edges_outside_tree(
    costs: Costs,
    weights: tuple[float, float],
    penalties: Array,
    degrees: NDArray[np.int64],
) -> float:
    """Return the length of the two edges at city 0, and count them in the degrees."""
    if is_open(costs.closing):
        return two_closing_edges(costs.closing, penalties, degrees)
    return two_shortest_edges(costs, weights[0], weights[1], penalties, degrees)


@compiled
def two_shortest_edges(
    costs: Costs, w0: float, w1: float, penalties: Array, degrees: NDArray[np.int64]
) -> float:
    """Return the length of the two shortest edges at city 0, and count them in the degrees."""
    least, second = np.inf, np.inf
    nearest, runner_up = 0, 0
    for j in range(1, len(penalties)):
        c = step_costs(costs, 0, j)
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


@compiled
def two_closing_edges(closing: Array, penalties: Array, degrees: NDArray[np.int64]) -> float:
    """Return the length of the invented city's two edges, and count them in the degrees.

    They lead to the fixed ends of a route, and where an end is free to the least penalty.
    """
    least, second = np.inf, np.inf
    nearest, runner_up = 0, 0
    for j in range(1, len(penalties)):
        key = -np.inf if is_kept(closing, 0, j) else penalties[j]
        if key < least:
            second, runner_up = least, nearest
            least, nearest = key, j
        elif key < second:
            second, runner_up = key, j
    degrees[0] = 2
    degrees[nearest] += 1
    degrees[runner_up] += 1
    return 2 * penalties[0] + penalties[nearest] + penalties[runner_up]


class Ascent(NamedTuple):
    """The state of a subgradient ascent: the present penalties, and the best so far."""

    penalties: Array  # (n,)
    best_penalties: Array  # (n,): those that proved the best bound
    best_bound: Array  # (1,)
    degrees: NDArray[np.int64]  # (n,)
    previous_degrees: NDArray[np.int64]  # (n,), one step before


def make_ascent(penalties: Array) -> Ascent:
    """Return the start of an ascent from given penalties."""
    n = len(penalties)
    degrees = np.full(n, 2)
    return Ascent(penalties.copy(), penalties.copy(), np.full(1, -np.inf), degrees, degrees.copy())


@allocating
def ascend(costs: Costs, w0: float, w1: float, ascent: Ascent, shares: Array) -> None:
    """Take a step for each of the shares, which are of the greatest step length. O(n^2) each."""
    n = len(ascent.penalties)
    for share in shares:
        total = 0.0
        for j in range(n):  # loops compile in a tenth of the time of assignments to slices
            ascent.previous_degrees[j] = ascent.degrees[j]
            total += ascent.penalties[j]
        bound = one_tree(costs, w0, w1, ascent.penalties, ascent.degrees) - 2 * total
        if bound > ascent.best_bound[0]:
            ascent.best_bound[0] = bound
            for j in range(n):
                ascent.best_penalties[j] = ascent.penalties[j]
        step = share * ascent.best_bound[0] / (2 * n)
        for j in range(n):
            degree, previous = ascent.degrees[j], ascent.previous_degrees[j]
            slope = 0.6 * (degree - 2) + 0.4 * (previous - 2)
            ascent.penalties[j] += step * slope
