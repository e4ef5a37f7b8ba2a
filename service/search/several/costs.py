"""The costs of three and four objectives, and the weighted sum of them that a local search sees.

Under one weight there is one cost, whatever it is the sum of. So the local searches for two
objectives serve here as they are: they are given the weighted sum as the first of two costs, and
nothing as the second. Only the lengths of what they find are summed under all objectives.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import compiled
from service.search.closing import closing_costs, largest_steps
from service.search.costs import Costs

Array = NDArray[np.float64]
Cities = NDArray[np.int32]


class ObjectiveCosts(NamedTuple):
    """The scaled costs of an instance, all of them looked up.

    A forbidden leg costs more than any tour without one. Those of open routes have one more city,
    city 0, which comes before the instance's, and to and from which all steps are free.
    """

    table: Array  # (n, n, m)
    symmetric: bool
    closing: Array  # (2, n), as of Costs
    largest: Array  # (m,), of any step


def make_objective_costs(instance: Instance) -> ObjectiveCosts:
    """Return an instance's costs, multiplied by the powers of two that are its shifts. O(n^2)."""
    largest = largest_steps(instance)
    closing = closing_costs(instance, float(largest.max()))
    added = 1 if closing.size else 0
    n = added + instance.n
    table = np.zeros((n, n, instance.objectives))
    for m, shift in enumerate(instance.shifts.tolist()):
        table[added:, added:, m] = np.ldexp(_costs_under(instance, m), shift)
    return ObjectiveCosts(table, instance.symmetric, closing, largest)


def _costs_under(instance: Instance, m: int) -> Array:
    """Return the costs under one objective, shape (n, n)."""
    if instance.coordinates is None:
        return instance.penalised_matrices[m]
    places = instance.coordinates.view(np.complex128)[:, m]
    return np.abs(places[:, np.newaxis] - places)


def weighted_costs(costs: ObjectiveCosts, weights: Array) -> Costs:
    """Return the costs whose first is the weighted sum and whose second is 0; weights (m,)."""
    n = len(costs.table)
    matrix = np.zeros((n, n, 2))
    matrix[:, :, 0] = costs.table @ weights
    if costs.closing.size:
        matrix[0, :, 0], matrix[:, 0, 0] = costs.closing
    largest = np.array([weights @ costs.largest, 0.0])
    return Costs(np.zeros((n, 4)), matrix, costs.symmetric, costs.closing, largest)


@compiled
def sum_lengths(costs: ObjectiveCosts, tour: Cities, lengths: Array) -> None:
    """Sum all lengths of a tour, shape (m,). O(n m)."""
    for m in range(len(lengths)):
        lengths[m] = 0.0
    before = tour[len(tour) - 1]
    for k in range(len(tour)):
        city = tour[k]
        for m in range(len(lengths)):
            lengths[m] += costs.table[before, city, m]
        before = city
