"""The exact front of a few cities: all tours, but those that begin with too long a way."""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import compiled, inlined
from service.search.archive import TOLERANCE, Archive, accepts, insert, make_archive
from service.search.closing import closing_cost, opened_tours
from service.search.costs import Costs, lengths, make_costs, travel_costs

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

MAX_ENUMERATED = 9  # cities: at most 9! tours


def exact_tours(instance: Instance) -> Cities:
    """Return a tour for every point of the front of an instance, shape (m, n)."""
    costs = make_costs(instance)
    n = len(costs.cities)
    archive = make_archive(n)
    order = np.arange(n, dtype=np.int32)
    insert_all(costs, archive, order, order.copy(), np.zeros((n, 2)))
    return opened_tours(instance, archive.tours[archive.slots[np.flatnonzero(_distinct(archive))]])


def _distinct(archive: Archive) -> NDArray[np.bool_]:
    """Return which points only rounding keeps from being dominated by a neighbour, as False."""
    first, second = archive.points[: archive.counts[0]].T * (1 + TOLERANCE)
    distinct = np.ones(len(first), np.bool_)
    distinct[:-1] &= archive.points[1 : len(first), 0] > first[:-1]
    distinct[1:] &= archive.points[: len(first) - 1, 1] > second[1:]
    return distinct


@compiled
def insert_all(costs: Costs, archive: Archive, tour: Cities, tried: Cities, reached: Array) -> None:
    """Insert all nondominated tours from city 0 on, depth first.

    Args:
        costs: The costs.
        archive: Empty.
        tour: All cities in order, shape (n,). Before each place the cities are chosen, after it are
            those that are left.
        tried: Scratch space, shape (n,): the place from which the city at a place has come.
        reached: Scratch space, shape (n, 2), zero in the first row: both lengths up to a place.
    """
    n = len(tour)
    if n == 1:
        insert(archive, (0.0, 0.0), tour)
    place = 1 if n > 1 else 0
    tried[place] = place - 1
    while place > 0:
        if tried[place] >= place:
            swap(tour, place, tried[place])
        tried[place] += 1
        if tried[place] == n:
            place -= 1
            continue
        swap(tour, place, tried[place])
        c = travel_costs(costs, tour[place - 1], tour[place])
        reached[place, 0] = reached[place - 1, 0] + c[0]
        reached[place, 1] = reached[place - 1, 1] + c[1]
        if not may_follow(costs.closing, tour, place):
            continue
        if not accepts(archive, reached[place, 0], reached[place, 1]):
            continue
        if place == n - 1:
            insert(archive, lengths(costs, tour), tour)
        else:
            place += 1
            tried[place] = place - 1


@inlined
def swap(tour: Cities, i: int, j: int) -> None:
    """Swap the cities at two places."""
    tour[i], tour[j] = tour[j], tour[i]


@inlined
def may_follow(closing: Array | None, tour: Cities, place: int) -> bool:
    """Return whether a route may begin with the city at place 1, or end with that at the last."""
    if closing is None:
        return True
    if place == 1 and closing_cost(closing, 0, tour[1]) > least_cost(closing):
        return False
    return place < len(tour) - 1 or closing_cost(closing, tour[place], 0) <= 0


@inlined
def least_cost(closing: Array) -> float:
    """Return the least cost of a step from the invented city: of the kept one, if there is one."""
    least = closing[0, 1]
    for j in range(2, closing.shape[1]):
        least = min(least, closing[0, j])
    return least
