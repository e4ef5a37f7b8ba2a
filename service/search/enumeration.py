"""The exact front of a few cities: all tours, but those that begin with too long a way."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, least_steps
from service.jit import compiled, inlined
from service.objectives import OBJECTIVES
from service.search.archive import ROUNDING, Archive, accepts, insert, make_archive
from service.search.closing import closing_cost, is_open, opened_tours
from service.search.costs import Costs, lengths, make_costs, travel_costs
from service.search.several.enumeration import exact_tours_of_several
from service.watch import Watch

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

DIGITS = 40  # binary, of the least costs that are summed
LEAST_BLOCKS = 50  # of steps before the deadline counts: most instances need fewer, some 20 ms
STEPS = 5_000  # cities put into a tour between two checks of the deadline, a fraction of a ms


class Enumeration(NamedTuple):
    """How far an enumeration, depth first, has come."""

    tour: Cities  # (n,): before a place the cities are chosen, after it are those that are left
    tried: Cities  # (n,): the place from which the city at a place has come
    reached: Array  # (n, 2), zero in the first row: both lengths up to a place
    least: Array  # (n, 2): the least costs of a step that leaves a city
    left: Array  # (n, 2): the sums of these over the city at a place and those that are left
    place: NDArray[np.int64]  # (1,): the place whose city is chosen next; 0 at the end


def exact_tours(instance: Instance, watch: Watch[Any] | None = None) -> tuple[Cities, bool]:
    """Return a tour for every point of the front of an instance, shape (m, n), and True.

    Where time runs out first, return those found so far, one at least, and False.

    Args:
        instance: The instance.
        watch: Asked at least every few ms whether to end. None sets no limit.
    """
    watch = watch or Watch()
    if instance.objectives > OBJECTIVES:
        return exact_tours_of_several(instance, watch)
    costs = make_costs(instance)
    archive = make_archive(len(costs.cities))
    complete = True
    for block, _ in enumerate(enumerate_tours(costs, archive)):
        late = block >= LEAST_BLOCKS and watch.over()
        if (late or watch.stopped()) and archive.counts[0] > 0:
            complete = False
            break
    tours = archive.tours[archive.slots[np.flatnonzero(_distinct(archive))]]
    return opened_tours(instance, tours), complete


def enumerate_tours(costs: Costs, archive: Archive) -> Iterator[None]:
    """Insert all nondominated tours, and yield about every ms.

    Args:
        costs: The costs, tabulated.
        archive: Where tours are inserted; it may hold some already.
    """
    n = len(costs.cities)
    tour = np.arange(n, dtype=np.int32)
    if n == 1:
        insert(archive, (0.0, 0.0), tour)
        return
    steps = costs.matrix.transpose(2, 0, 1).copy()
    if costs.closing.size:
        steps[:, 0] = steps[:, :, 0] = 0.0  # which adds nothing to lengths
    least = np.ascontiguousarray(least_steps(steps)[0].T)
    # Rounded down to few digits, sums and differences of them are exact.
    unit = np.ldexp(1.0, np.frexp(least.max(axis=0))[1] - DIGITS)
    least = np.floor(least / unit) * unit
    left = np.tile(least.sum(axis=0), (n, 1))
    enumeration = Enumeration(
        tour, np.zeros(n, np.int32), np.zeros((n, 2)), least, left, np.ones(1, np.int64)
    )
    while enumeration.place[0] > 0:
        insert_some(costs, archive, enumeration, STEPS)
        yield


def _distinct(archive: Archive) -> NDArray[np.bool_]:
    """Return which points only rounding keeps from being dominated by a neighbour, as False."""
    slack = 1 + ROUNDING * archive.tours.shape[1]
    first, second = archive.points[: archive.counts[0]].T * slack
    distinct = np.ones(len(first), np.bool_)
    distinct[:-1] &= archive.points[1 : len(first), 0] > first[:-1]
    distinct[1:] &= archive.points[: len(first) - 1, 1] > second[1:]
    return distinct


@compiled
def insert_some(costs: Costs, archive: Archive, enumeration: Enumeration, steps: int) -> None:
    """Go on with an enumeration of tours from city 0 on: for some steps, or to its end.

    A beginning is left out as soon as no tour that begins so can still be on the front.
    """
    tour, tried = enumeration.tour, enumeration.tried
    n, place = len(tour), enumeration.place[0]
    for _ in range(steps):
        if place == 0:
            break
        if tried[place] >= place:
            swap(tour, place, tried[place])
        tried[place] += 1
        if tried[place] == n:
            place -= 1
            continue
        swap(tour, place, tried[place])
        if not may_follow(costs.closing, tour, place):
            continue
        first, second = least_lengths_at(costs, enumeration, place)
        if not accepts(archive, first, second):
            continue
        if place == n - 1:
            insert(archive, lengths(costs, tour), tour)
        else:
            place += 1
            tried[place] = place - 1
    enumeration.place[0] = place


@inlined
def least_lengths_at(costs: Costs, enumeration: Enumeration, place: int) -> tuple[float, float]:
    """Return what all tours that begin as this one does, up to a place, cost at least."""
    tour, _, reached, least, left, _ = enumeration
    before = tour[place - 1]
    c = travel_costs(costs, before, tour[place])
    for m in range(2):
        reached[place, m] = reached[place - 1, m] + c[m]
        left[place, m] = left[place - 1, m] - least[before, m]
    return reached[place, 0] + left[place, 0], reached[place, 1] + left[place, 1]


@inlined
def swap(tour: Cities, i: int, j: int) -> None:
    """Swap the cities at two places."""
    tour[i], tour[j] = tour[j], tour[i]


@inlined
def may_follow(closing: Array, tour: Cities, place: int) -> bool:
    """Return whether a route may begin with the city at place 1, or end with that at the last."""
    if not is_open(closing):
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
