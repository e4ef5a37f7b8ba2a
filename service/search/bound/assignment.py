"""Assignment lower bounds on the length of a tour, for costs that may differ by direction.

A tour gives every city one successor, so it is at least as long as the cheapest assignment.
By linear duality any prices v of the cities bound that from below: by the sum over j of v[j], plus
the sum over i of min over j of c[i, j] - v[j]. So a bound holds before the assignment is complete.
Cities are assigned along shortest augmenting paths (Jonker and Volgenant, 1987).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.closing import closing_cost, is_closing
from service.search.costs import Costs, step_costs

Array = NDArray[np.float64]


class Assignment(NamedTuple):
    """A partial assignment of successors, and the dual prices."""

    prices: Array  # (n,)
    predecessors: NDArray[np.int64]  # (n,), -1 where there is none yet
    successors: NDArray[np.int64]  # (n,), -1 where there is none yet


def make_assignment(n: int) -> Assignment:
    """Return an assignment of n cities without any successor, at prices of 0."""
    return Assignment(np.zeros(n), np.full(n, -1), np.full(n, -1))


@inlined
def arc_cost(costs: Costs, w0: float, w1: float, i: int, j: int) -> float:
    """Return the weighted cost from i to j; infinite from a city to itself, or where forbidden."""
    if i == j:
        return np.inf
    if is_closing(costs.closing, i, j):
        closing = closing_cost(costs.closing, i, j)
        return np.inf if closing > 0 else 0.0
    c = step_costs(costs, i, j)
    return w0 * c[0] + w1 * c[1]


@inlined
def least_reduced_cost(costs: Costs, w0: float, w1: float, prices: Array, i: int) -> float:
    """Return the least cost of leaving city i, less the price of the city reached. O(n)."""
    least = np.inf
    for j in range(len(prices)):
        least = min(least, arc_cost(costs, w0, w1, i, j) - prices[j])
    return least


@compiled
def price_bound(costs: Costs, w0: float, w1: float, prices: Array) -> float:
    """Return the lower bound that prices prove. O(n^2)."""
    total = 0.0
    for j in range(len(prices)):
        total += prices[j] + least_reduced_cost(costs, w0, w1, prices, j)
    return total


@allocating
def augment(costs: Costs, w0: float, w1: float, assignment: Assignment, first: int) -> None:
    """Give one more city a successor, along a shortest augmenting path. O(n^2)."""
    n = len(assignment.prices)
    prices = assignment.prices
    distance = np.full(n, np.inf)
    via = np.full(n, -1)
    settled = np.zeros(n, np.bool_)
    least = least_reduced_cost(costs, w0, w1, prices, first)
    city, end, reached = first, -1, 0.0
    while end < 0:
        closest = -1
        for j in range(n):
            if settled[j]:
                continue
            value = reached + max(0.0, arc_cost(costs, w0, w1, city, j) - prices[j] - least)
            if value < distance[j]:
                distance[j], via[j] = value, city
            if closest < 0 or distance[j] < distance[closest]:
                closest = j
        settled[closest] = True
        reached = distance[closest]
        city = assignment.predecessors[closest]
        if city < 0:
            end = closest
        else:
            least = arc_cost(costs, w0, w1, city, closest) - prices[closest]
    lower_prices(prices, settled, distance, reached)
    apply_path(assignment, via, end, first)


@inlined
def lower_prices(
    prices: Array, settled: NDArray[np.bool_], distance: Array, reached: float
) -> None:
    """Lower the price of each settled city by what it was nearer than the path's end."""
    for j in range(len(prices)):
        if settled[j]:
            prices[j] -= reached - distance[j]


@compiled
def apply_path(assignment: Assignment, via: NDArray[np.int64], end: int, first: int) -> None:
    """Follow a path back from its end, and give each city on it the successor that it reached."""
    j, i = end, -1
    while i != first:
        i = via[j]
        previous = assignment.successors[i]
        assignment.predecessors[j], assignment.successors[i] = i, j
        j = previous
