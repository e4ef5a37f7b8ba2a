"""The costs of three and four objectives, and the weighted sum of them that a local search sees.

Under one weight there is one cost, whatever it is the sum of. So the local searches for two
objectives serve here as they are: they are given two costs whose sum is the weighted one. Only the
lengths of what they find are summed under all objectives.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import compiled
from service.search.closing import closing_costs, is_closing, largest_steps
from service.search.costs import Costs, distance
from service.search.sizes import DENSE_BELOW

Array = NDArray[np.float64]
Cities = NDArray[np.int32]


class ObjectiveCosts(NamedTuple):
    """The scaled costs of an instance: a table, or planes where that is empty.

    A forbidden leg costs more than any tour without one. Those of open routes have one more city,
    city 0, which comes before the instance's, and to and from which all steps are free.
    """

    table: Array  # (n, n, m), or (0, 0, m) where the planes are used
    planes: Array  # (n, 2 m), or (n, 0) where the table is used
    symmetric: bool
    closing: Array  # (2, n), as of Costs
    largest: Array  # (m,), of any step


def make_objective_costs(instance: Instance) -> ObjectiveCosts:
    """Return an instance's costs, multiplied by the powers of two that are its shifts."""
    largest = largest_steps(instance)
    closing = closing_costs(instance, float(largest.max()))
    added = 1 if closing.size else 0
    n, objectives = added + instance.n, instance.objectives
    if instance.coordinates is not None and instance.n >= DENSE_BELOW:
        planes = np.zeros((n, 2 * objectives))
        corner = instance.coordinates.min(axis=0)
        planes[added:] = np.ldexp(instance.coordinates - corner, instance.shifts.repeat(2))
        table = np.zeros((0, 0, objectives))
        return ObjectiveCosts(table, planes, instance.symmetric, closing, largest)
    table = np.zeros((n, n, objectives))
    for m, shift in enumerate(instance.shifts.tolist()):
        table[added:, added:, m] = np.ldexp(_costs_under(instance, m), shift)
    return ObjectiveCosts(table, np.zeros((n, 0)), instance.symmetric, closing, largest)


def _costs_under(instance: Instance, m: int) -> Array:
    """Return the costs under one objective, shape (n, n)."""
    if instance.coordinates is None:
        return instance.penalised_matrices[m]
    places = instance.coordinates.view(np.complex128)[:, m]
    return np.abs(places[:, np.newaxis] - places)


def weighted_costs(costs: ObjectiveCosts, weights: Array) -> Costs:
    """Return the costs whose first is the weighted sum and whose second is 0; weights (m,)."""
    n = len(costs.planes)
    largest = np.array([weights @ costs.largest, 0.0])
    if not len(costs.table):
        cities = costs.planes * weights.repeat(2)
        return Costs(cities, np.zeros((0, 0, 2)), True, costs.closing, largest, False)
    matrix = np.zeros((n, n, 2))
    matrix[:, :, 0] = costs.table @ weights
    if costs.closing.size:
        matrix[0, :, 0], matrix[:, 0, 0] = costs.closing
    return Costs(
        np.zeros((n, 4)), matrix, costs.symmetric, costs.closing, largest, not costs.closing.size
    )


@compiled
def sum_lengths(costs: ObjectiveCosts, tour: Cities, lengths: Array) -> None:
    """Sum all lengths of a tour, shape (m,). O(n m)."""
    for m in range(len(lengths)):
        lengths[m] = 0.0
    before = tour[len(tour) - 1]
    for k in range(len(tour)):
        city = tour[k]
        if len(costs.table):
            for m in range(len(lengths)):
                lengths[m] += costs.table[before, city, m]
        elif not is_closing(costs.closing, before, city):
            for m in range(len(lengths)):
                lengths[m] += distance(costs.planes, 2 * m, before, city)
        before = city
