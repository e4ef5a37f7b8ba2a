"""The costs of three and four objectives, and the weighted sum of them that a local search sees.

Under one weight there is one cost, whatever it is the sum of. So the local searches for two
objectives serve here as they are: they are given the weighted sum as the first of two costs, and
nothing as the second. Only the lengths of what they find are summed under all objectives.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import PLANE, Instance
from service.jit import compiled
from service.search.closing import closing_costs, largest_steps
from service.search.costs import Costs

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

TABULATED = 1_500  # cities up to which costs are looked up; beyond, they are computed at each step


class ObjectiveCosts(NamedTuple):
    """The scaled costs of an instance: a table, or coordinates where that is empty.

    A forbidden leg costs more than any tour without one. Those of open routes have one more city,
    city 0, which comes before the instance's, and to and from which all steps are free.
    """

    cities: Array  # (n, 2 m)
    table: Array  # (n, n, m), or (0, 0, m) where the coordinates are used
    invented: int  # 1 where city 0 is not one of the instance, else 0
    symmetric: bool
    closing: Array  # (2, n), as of Costs
    largest: Array  # (m,), of any step


def make_objective_costs(instance: Instance) -> ObjectiveCosts:
    """Return an instance's costs, multiplied by the powers of two that are its shifts."""
    largest = largest_steps(instance)
    closing = closing_costs(instance, float(largest.max()))
    added = 1 if closing.size else 0
    n, objectives = added + instance.n, instance.objectives
    cities = np.zeros((n, PLANE * objectives))
    if instance.coordinates is not None:
        corner = instance.coordinates.min(axis=0)
        shifts = instance.shifts.repeat(PLANE)
        cities[added:] = np.ldexp(instance.coordinates - corner, shifts)
    if instance.coordinates is None or n <= TABULATED:
        table = np.zeros((n, n, objectives))
        table[added:, added:] = _planes(instance, cities[added:]).transpose(1, 2, 0)
    else:
        table = np.zeros((0, 0, objectives))
    return ObjectiveCosts(cities, table, added, instance.symmetric, closing, largest)


def _planes(instance: Instance, cities: Array) -> Array:
    """Return scaled costs, shape (m, n, n)."""
    if instance.coordinates is None:
        return np.ldexp(instance.penalised_matrices, instance.shifts[:, None, None])
    steps = cities[:, np.newaxis] - cities
    return np.hypot(steps[..., 0::PLANE], steps[..., 1::PLANE]).transpose(2, 0, 1)


def weighted_costs(costs: ObjectiveCosts, weights: Array) -> Costs:
    """Return the costs whose first is the weighted sum and whose second is 0; weights (m,)."""
    largest = np.array([weights @ costs.largest, 0.0])
    matrix = np.zeros((*costs.table.shape[:2], 2))
    if len(matrix):
        matrix[:, :, 0] = costs.table @ weights
        if costs.invented:
            matrix[0, :, 0], matrix[:, 0, 0] = costs.closing
    cities = costs.cities * weights.repeat(PLANE)
    return Costs(cities, matrix, costs.symmetric, costs.closing, largest)


@compiled
def sum_lengths(costs: ObjectiveCosts, tour: Cities, lengths: Array) -> None:
    """Sum all lengths of a tour, shape (m,). O(n m)."""
    for m in range(len(lengths)):
        lengths[m] = 0.0
    before = tour[len(tour) - 1]
    for k in range(len(tour)):
        city = tour[k]
        if costs.invented == 0 or (before != 0 and city != 0):
            add_step(costs, before, city, lengths)
        before = city


@compiled
def add_step(costs: ObjectiveCosts, i: int, j: int, lengths: Array) -> None:
    """Add the costs of the step from city i to city j to lengths."""
    if len(costs.table) > 0:
        for m in range(len(lengths)):
            lengths[m] += costs.table[i, j, m]
    else:
        for m in range(len(lengths)):
            x = costs.cities[i, 2 * m] - costs.cities[j, 2 * m]
            y = costs.cities[i, 2 * m + 1] - costs.cities[j, 2 * m + 1]
            lengths[m] += np.sqrt(x * x + y * y)
