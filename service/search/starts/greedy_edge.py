"""Tours by greedy edge, from which descents of thousands of cities set out.

Bentley (1992): the cheapest candidate edges first, unless one closes a circuit or gives a city a
third edge. What is left are paths, which are joined by nearest ends. Such a tour is a third nearer
to a local optimum than one by nearest neighbours, and takes no look at all unvisited cities.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.closing import is_closing

Array = NDArray[np.float64]
Cities = NDArray[np.int32]
Edges = NDArray[np.int64]  # by their places in the lists of candidates

MOST_COMPARED = 10_000  # ends of other paths; there are fewer unless many cities coincide


class Paths(NamedTuple):
    """Paths through all cities, some of one city alone."""

    beside: Cities  # (n, 2), the cities before and after each; its degree says how many
    degree: Cities  # (n,)
    parent: Cities  # (n,), a forest with one tree for each path


@inlined
def root_of(paths: Paths, city: int) -> int:
    """Return the root of a city's tree, and halve the way to it."""
    parent = paths.parent
    while parent[city] != city:
        parent[city] = parent[parent[city]]
        city = parent[city]
    return city


@inlined
def join(paths: Paths, i: int, j: int) -> None:
    """Add the edge between two cities, unless that leaves no paths."""
    if paths.degree[i] == 2 or paths.degree[j] == 2:
        return
    root, other = root_of(paths, i), root_of(paths, j)
    if root == other:
        return
    paths.parent[root] = other
    paths.beside[i, paths.degree[i]], paths.beside[j, paths.degree[j]] = j, i
    paths.degree[i] += 1
    paths.degree[j] += 1


@inlined
def is_candidate(scalarization: Scalarization, i: int, j: int) -> bool:
    """Return whether city j is a candidate of city i."""
    row = scalarization.candidates[i]
    k = 0
    while k < len(row) and row[k] != j:
        k += 1
    return k < len(row)


@compiled
def collect_edges(scalarization: Scalarization, edges: Edges, costs: Array) -> int:
    """Collect each candidate edge once, by its place in the lists; return how many there are."""
    count = 0
    candidates, closing = scalarization.candidates, scalarization.costs.closing
    n, width = candidates.shape
    for i in range(n):
        for k in range(width):
            j = candidates[i, k]
            seen = j < i and is_candidate(scalarization, j, i)
            if not seen and not is_closing(closing, i, j):
                edges[count], costs[count] = i * width + k, scalarization.candidate_costs[i, k]
                count += 1
    return count


@inlined
def remove_end(ends: Cities, place: Cities, count: int, city: int) -> int:
    """Remove a city from the first `count` ends if it is one; return how many are left."""
    at = place[city]
    if at < 0:
        return count
    last = ends[count - 1]
    ends[at], place[last] = last, at
    place[city] = -1
    return count - 1


@inlined
def nearest_end(scalarization: Scalarization, ends: Cities, count: int, city: int) -> int:
    """Return the nearest to a city among the first `count` ends."""
    least, nearest = np.inf, -1
    for k in range(min(count, MOST_COMPARED)):
        cost = weighted_cost(scalarization, city, ends[k])
        if cost < least:
            least, nearest = cost, ends[k]
    return nearest


@allocating
def walk_paths(scalarization: Scalarization, paths: Paths, tour: Cities) -> None:
    """Fill `tour` with one path after another, from its first city on if that is an end."""
    n = len(tour)
    ends, place = np.empty(n, np.int32), np.full(n, -1, np.int32)
    count = 0
    for city in range(n):
        if paths.degree[city] < 2:
            ends[count], place[city] = city, count
            count += 1
    city = tour[0] if place[tour[0]] >= 0 else ends[0]
    before = -1
    for k in range(n):
        tour[k] = city
        count = remove_end(ends, place, count, city)
        following = -1
        for other in paths.beside[city, : paths.degree[city]]:
            if other != before:
                following = other
        before = city
        if following < 0 and count > 0:
            following, before = nearest_end(scalarization, ends, count, city), -1
        city = following


@allocating
def join_in_order(scalarization: Scalarization, edges: Edges, begun: int, tour: Cities) -> None:
    """Fill a tour as `greedy_edge` does, from its candidate edges in order."""
    n = len(tour)
    paths = Paths(np.zeros((n, 2), np.int32), np.zeros(n, np.int32), np.arange(n).astype(np.int32))
    for k in range(begun - 1):
        join(paths, tour[k], tour[k + 1])
    width = scalarization.candidates.shape[1]
    for edge in edges:
        join(paths, edge // width, scalarization.candidates[edge // width, edge % width])
    walk_paths(scalarization, paths, tour)


def greedy_edge(scalarization: Scalarization, begun: int, tour: Cities) -> None:
    """Fill a tour that has its first `begun` cities, at most two: steps between them stay in it.

    Of symmetric costs. With one city begun the tour may begin elsewhere. O(n log n), and the square
    of the number of paths.
    """
    size = scalarization.candidates.size
    edges, costs = np.empty(size, np.int64), np.empty(size)
    count = collect_edges(scalarization, edges, costs)
    # Not in compiled code: numba compiles a dozen functions to sort.
    in_order = edges[costs[:count].argsort(kind="stable")]
    join_in_order(scalarization, in_order, begun, tour)
