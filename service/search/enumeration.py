"""The exact front of a few cities: all tours, but those that begin with too long a way."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, least_steps
from service.jit import compiled, inlined
from service.search.archive.insertion import accepts, insert
from service.search.archive.layout import ROUNDING, Archive, make_archive, rows_of
from service.search.closing import closing_cost, is_closing, is_open, opened_tours
from service.search.costs import Costs, make_costs, sum_lengths
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
    reached: Array  # (n, m), zero in the first row: the lengths up to a place
    least: Array  # (n, m): the least costs of a step that leaves a city
    left: Array  # (n, m): the sums of these over the city at a place and those that are left
    place: NDArray[np.int64]  # (1,): the place whose city is chosen next; 0 at the end


def exact_tours(instance: Instance, watch: Watch[Any] | None = None) -> tuple[Cities, bool]:
    """Return a tour for every point of the front of an instance, shape (m, n), and True.

    Where time runs out first, return those found so far, one at least, and False.

    Args:
        instance: The instance.
        watch: Asked at least every few ms whether to end. None sets no limit.
    """
    watch = watch or Watch()
    costs = make_costs(instance)
    archive = make_archive(len(costs.cities), instance.objectives)
    complete = True
    for block, _ in enumerate(enumerate_tours(costs, archive)):
        late = block >= LEAST_BLOCKS and watch.over()
        if (late or watch.stopped()) and archive.counts[0] > 0:
            complete = False
            break
    rows = rows_of(archive)
    distinct = np.ones(len(rows), np.bool_)
    mark_distinct(archive.points[rows], 1 + ROUNDING * len(costs.cities), distinct)
    return opened_tours(instance, archive.tours[rows[distinct]]), complete


def enumerate_tours(costs: Costs, archive: Archive) -> Iterator[None]:
    """Insert all nondominated tours, and yield about every ms.

    Args:
        costs: The costs, tabulated.
        archive: Where tours are inserted; it may hold some already.
    """
    n = len(costs.cities)
    tour = np.arange(n, dtype=np.int32)
    if n == 1:
        insert(archive, np.zeros(costs.matrix.shape[2]), tour)
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
        tour, np.zeros(n, np.int32), np.zeros(least.shape), least, left, np.ones(1, np.int64)
    )
    while enumeration.place[0] > 0:
        insert_some(costs, archive, enumeration, STEPS)
        yield


@compiled
def mark_distinct(points: Array, slack: float, distinct: NDArray[np.bool_]) -> None:
    """Mark each point that more than rounding keeps from being dominated by another one marked.

    Args:
        points: Shape (k, m).
        slack: What a length may be multiplied by, for rounding.
        distinct: The marks, shape (k,), all True.
    """
    for k in range(len(points)):
        for j in range(len(points)):
            if j != k and distinct[j] and no_worse(points, j, k, slack):
                distinct[k] = False
                break


@inlined
def no_worse(points: Array, j: int, k: int, slack: float) -> bool:
    """Return whether point j is nowhere above point k, but for rounding."""
    below = True
    for m in range(points.shape[1]):
        below &= points[j, m] <= points[k, m] * slack
    return below


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
        bound_lengths(costs, enumeration, place, archive.lengths)
        if not accepts(archive, archive.lengths):
            continue
        if place == n - 1:
            sum_lengths(costs, tour, archive.lengths)
            insert(archive, archive.lengths, tour)
        else:
            place += 1
            tried[place] = place - 1
    enumeration.place[0] = place


@inlined
def bound_lengths(costs: Costs, enumeration: Enumeration, place: int, bounds: Array) -> None:
    """Set bounds, shape (m,), to what all tours that begin as this one does cost at least."""
    tour, _, reached, least, left, _ = enumeration
    before, city = tour[place - 1], tour[place]
    closing = is_closing(costs.closing, before, city)
    for m in range(len(bounds)):
        step = 0.0 if closing else costs.matrix[before, city, m]
        reached[place, m] = reached[place - 1, m] + step
        left[place, m] = left[place - 1, m] - least[before, m]
        bounds[m] = reached[place, m] + left[place, m]


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
