"""The plain construction heuristics that the paper leaves out, for many weights of an instance."""

from collections.abc import Callable, Sequence

import numpy as np
from numba import njit
from numpy.typing import NDArray

from service.instance import Instance

Array = NDArray[np.float64]
Construct = Callable[[Array], Sequence[int] | NDArray[np.int64]]  # a tour from costs, (n, n)


def spread_weights(k: int) -> Array:
    """Pairs of weights from (0, 1) to (1, 0), evenly spread, both ends included; shape (k, 2)."""
    first = np.linspace(0.0, 1.0, k)
    return np.stack((first, 1 - first), axis=1)


def nearest_neighbour(instance: Instance, weights: Array) -> NDArray[np.int64]:
    """From city 0 always to the nearest unvisited city; one tour for each pair of weights."""
    return under_each(weights, _nearest_neighbour, instance)


def greedy_edge(instance: Instance, weights: Array) -> NDArray[np.int64]:
    """Edges by ascending cost, unless one closes a cycle or gives a city a third edge."""
    return under_each(weights, _greedy_edge, instance)


def distances(coordinates: Array) -> Array:
    """Distances in each plane, shape (2, n, n), of coordinates, shape (n, 4)."""
    steps = coordinates[:, None] - coordinates
    return np.stack([np.hypot(steps[..., m], steps[..., m + 1]) for m in (0, 2)])


def under_each(weights: Array, construct: Construct, instance: Instance) -> NDArray[np.int64]:
    """The tour that is constructed for each weighted sum of the distances, shape (k, n)."""
    costs = distances(instance.scaled_coordinates)
    return np.array([construct(w[0] * costs[0] + w[1] * costs[1]) for w in weights])


@njit(cache=True)
def _nearest_neighbour(cost: Array) -> NDArray[np.int64]:
    n = len(cost)
    tour = np.zeros(n, np.int64)
    left = np.arange(1, n)
    for t in range(1, n):
        here, best = tour[t - 1], 0
        for i in range(n - t):
            if cost[here, left[i]] < cost[here, left[best]]:
                best = i
        tour[t] = left[best]
        left[best] = left[n - t - 1]
    return tour


def _greedy_edge(cost: Array) -> NDArray[np.int64]:
    first, second = np.triu_indices(len(cost), 1)
    order = np.argsort(cost[first, second])
    return _join(first[order], second[order], len(cost))


@njit(cache=True)
def _join(first, second, n):
    """Takes edges in order while they can be part of a tour, and walks the tour that results."""
    parent = np.arange(n)
    degree = np.zeros(n, np.int64)
    beside = np.full((n, 2), -1)
    for e in range(len(first)):
        a, b = first[e], second[e]
        if degree[a] < 2 and degree[b] < 2 and _root(parent, a) != _root(parent, b):
            parent[_root(parent, a)] = _root(parent, b)
            beside[a, degree[a]] = b
            beside[b, degree[b]] = a
            degree[a] += 1
            degree[b] += 1
    tour = np.zeros(n, np.int64)
    before, here = -1, np.argmin(degree)
    for t in range(n):
        tour[t] = here
        onward = beside[here, 0] if beside[here, 0] != before else beside[here, 1]
        before, here = here, onward
    return tour


@njit(cache=True)
def _root(parent, city):
    while parent[city] != city:
        parent[city] = parent[parent[city]]
        city = parent[city]
    return city
