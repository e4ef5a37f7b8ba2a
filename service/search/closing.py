"""Open routes as closed tours: through one more, invented city, between a route's end and start.

The search moves closed tours. So to a route of cities 1 to n it adds a city 0, to which and from
which all steps are free of cost. Where an end is fixed, the step between it and city 0 is kept: in
the search it costs so much less than nothing that no move gains by its removal. Lengths leave all
steps of city 0 out, so that neither sum nor difference of lengths ever holds such a cost.

A closed instance has no such city, and its costs are empty, of shape (2, 0).
"""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import inlined
from service.search.open_routes import oriented, rotated

Array = NDArray[np.float64]

LEAST_BARRIER = 16.0  # more than a move can gain where scaled steps cost less than 2
NEVER_ADDED = 2.0**900  # above the cost of any step


def closing_costs(instance: Instance, barrier: float) -> Array:
    """Return the costs from city 0 to each city, and from each city to city 0, shape (2, n + 1).

    They are empty, of shape (2, 0), for closed tours.

    Args:
        instance: The instance.
        barrier: The greater of largest_steps(). A forbidden step costs as much, and a step that has
            to stay in the tour costs the negative of it.
    """
    if instance.closed:
        return np.zeros((2, 0))
    costs = np.zeros((2, instance.n + 1))
    if instance.symmetric:
        if len(instance.fixed_ends) == len(costs):
            costs[:] = barrier
        costs[:, [1 + city for city in instance.fixed_ends]] = -barrier
        return costs
    for direction, end in enumerate((instance.start, instance.end)):
        if end is not None:
            costs[direction] = barrier
            costs[direction, 1 + end] = -barrier
    return costs


def largest_steps(instance: Instance) -> Array:
    """Return the greatest cost of a step in the search, steps of city 0 included, shape (m,)."""
    matrices = instance.kind == "matrices"
    largest = instance.penalised_matrices.max(axis=(1, 2)) if matrices else instance.extents
    scaled = np.ldexp(largest, instance.shifts)
    return scaled if instance.closed else np.maximum(scaled, _barrier(scaled))


def _barrier(largest: Array) -> float:
    """Return the cost of a forbidden step: a power of two that no move can gain."""
    exponent = int(np.frexp(largest.max())[1])
    return float(np.ldexp(LEAST_BARRIER, max(0, exponent - 1)))


def closed_tours(instance: Instance, tours: NDArray[np.integer]) -> NDArray[np.int32]:
    """Return tours of an instance, shape (k, n), as the closed tours that the search moves.

    Of open routes these begin at city 0, shape (k, n + 1).
    """
    if instance.closed:
        return np.ascontiguousarray(tours, np.int32)
    through = np.zeros((len(tours), tours.shape[1] + 1), np.int32)
    through[:, 1:] = tours
    through[:, 1:] += 1
    return through


def opened_tours(instance: Instance, tours: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return closed tours that the search moves as tours of an instance, shape (k, n)."""
    if instance.closed:
        return tours
    routes = rotated(tours, (tours == 0).argmax(axis=1))[:, 1:] - np.int32(1)
    return oriented(instance, routes).astype(np.int32)


def with_end_last(instance: Instance, tour: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return a closed tour that begins at city 0, with the instance's fixed end, if any, last."""
    if instance.end is None:
        return tour
    end = np.int32(1 + instance.end)
    return np.append(tour[tour != end], end)


@inlined
def is_open(closing: Array) -> bool:
    """Return whether there is an invented city."""
    return closing.shape[1] > 0


@inlined
def is_closing(closing: Array, i: int, j: int) -> bool:
    """Return whether a step is to or from the invented city."""
    return is_open(closing) and (i == 0 or j == 0)


@inlined
def closing_cost(closing: Array, i: int, j: int) -> float:
    """Return the cost of a step to or from the invented city."""
    return closing[0, j] if i == 0 else closing[1, i]


@inlined
def is_kept(closing: Array, i: int, j: int) -> bool:
    """Return whether a step has to stay in the tour."""
    return is_closing(closing, i, j) and closing_cost(closing, i, j) < 0


@inlined
def is_free_end(closing: Array, city: int, after: int) -> bool:
    """Return whether a city is an end of the route, beside the invented city, that may change."""
    return is_open(closing) and after == 0 and closing_cost(closing, city, 0) == 0
