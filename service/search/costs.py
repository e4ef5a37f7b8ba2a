"""The costs of a step from one city to another, and of tours, for compiled code."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.jit import by_reference, compiled, inlined
from service.objectives import OBJECTIVES
from service.search.closing import (
    closing_cost,
    closing_costs,
    is_closing,
    largest_steps,
)
from service.search.sizes import DENSE_BELOW

Array = NDArray[np.float64]

SIDES = 4  # coordinates of a city in the first two planes

# Of a reference point, in units in which costs are below 2: products of two are finite, not 0.
LEAST_REFERENCE, LARGEST_REFERENCE = 2.0**-500, 2.0**500


@by_reference
class Costs(NamedTuple):
    """The scaled costs of an instance, or its weighted sum: a matrix, or planes where it is empty.

    A forbidden leg costs more than any tour without one, under all objectives. So a tour that has
    one is dominated by every tour that has none.

    Those of open routes have one more city, city 0, which comes before the instance's. Local
    searches read two costs of each step. A weighted sum of more objectives is the first of them,
    and the second is 0: of more than two planes, the first is the sum of the distances in all.
    """

    cities: Array  # (n, 2 m): coordinates, of city 0 and with matrices all 0
    matrix: Array  # (n, n, m), or (0, 0, m) where the coordinates are used
    symmetric: bool
    closing: Array  # (2, n), the costs from city 0 and to it; (2, 0) of closed tours
    largest: Array  # (m,), of any step: what rounding can add to a gain is a share of these
    plain: bool  # whether no city is invented, and costs are stored in tables


def make_costs(instance: Instance) -> Costs:
    """Return an instance's costs, multiplied by the powers of two that are its shifts.

    A power of two rounds nothing, so sums of whole-numbered costs stay exact, and neither huge
    nor tiny units overflow or underflow in a product of two lengths.
    """
    largest = largest_steps(instance)
    closing = closing_costs(instance, float(largest.max()))
    added = 1 if closing.size else 0
    n, objectives = added + instance.n, instance.objectives
    cities, tabulated = np.zeros((n, 2 * objectives)), n
    if instance.coordinates is not None:
        corner = instance.coordinates.min(axis=0)
        cities[added:] = np.ldexp(instance.coordinates - corner, instance.shifts.repeat(2))
        tabulated = n if instance.n < DENSE_BELOW else 0
    matrix = np.empty((tabulated, tabulated, objectives))
    if instance.coordinates is not None:
        tabulate(cities, matrix)
    else:
        planes = np.ldexp(instance.penalised_matrices, instance.shifts[:, None, None])
        matrix[added:, added:] = planes.transpose(1, 2, 0)
    if added and tabulated:
        matrix[0], matrix[:, 0] = closing[0, :, None], closing[1, :, None]
    return Costs(cities, matrix, instance.symmetric, closing, largest, not added)


def weighted_costs(costs: Costs, weights: Array) -> Costs:
    """Return the costs whose first is the weighted sum and whose second is 0; weights (m,).

    Under one weight there is one cost, whatever it is the sum of. So the local searches for two
    objectives serve for more. Only the lengths of what they find are summed under all objectives.
    """
    n, largest = len(costs.cities), np.array([weights @ costs.largest, 0.0])
    if not len(costs.matrix):
        cities, empty = costs.cities * weights.repeat(2), np.zeros((0, 0, 2))
        return costs._replace(cities=cities, matrix=empty, largest=largest, plain=False)
    matrix = np.zeros((n, n, 2))
    matrix[:, :, 0] = costs.matrix @ weights
    if costs.closing.size:
        matrix[0, :, 0], matrix[:, 0, 0] = costs.closing
    return costs._replace(cities=np.zeros((n, 4)), matrix=matrix, largest=largest)


def as_two(costs: Costs, weights: Array) -> tuple[Costs, float, float]:
    """Return two costs and their weights whose weighted sum is that of all objectives."""
    if len(weights) == OBJECTIVES:
        return costs, float(weights[0]), float(weights[1])
    return weighted_costs(costs, weights), 1.0, 1.0


def scaled_reference(instance: Instance, reference_point: Array) -> Array:
    """Return a reference point in the unit of make_costs(), shape (m,).

    Where it is too far from the costs for areas to be finite, and not 0, it is brought nearer.
    """
    with np.errstate(over="ignore"):
        return np.ldexp(reference_point, instance.shifts).clip(LEAST_REFERENCE, LARGEST_REFERENCE)


@inlined
def step_costs(costs: Costs, i: int, j: int) -> tuple[float, float]:
    """Return both scaled costs of the step from city i to city j."""
    if len(costs.matrix):
        return costs.matrix[i, j, 0], costs.matrix[i, j, 1]
    cities = costs.cities
    if not costs.plain:
        if is_closing(costs.closing, i, j):
            closing = closing_cost(costs.closing, i, j)
            return closing, closing
        if cities.shape[1] > SIDES:
            total = 0.0
            for d in range(0, cities.shape[1], 2):
                total += distance(cities, d, i, j)
            return total, 0.0
    x, y = cities[i, 0] - cities[j, 0], cities[i, 1] - cities[j, 1]
    u, v = cities[i, 2] - cities[j, 2], cities[i, 3] - cities[j, 3]
    return np.sqrt(x * x + y * y), np.sqrt(u * u + v * v)


@inlined
def distance(cities: Array, d: int, i: int, j: int) -> float:
    """Return the distance of two cities in the plane of the coordinates d and d + 1."""
    x, y = cities[i, d] - cities[j, d], cities[i, d + 1] - cities[j, d + 1]
    return float(np.sqrt(x * x + y * y))


@inlined
def travel_costs(costs: Costs, i: int, j: int) -> tuple[float, float]:
    """Return what a step adds to both scaled lengths: nothing to or from an invented city."""
    if is_closing(costs.closing, i, j):
        return 0.0, 0.0
    return step_costs(costs, i, j)


@compiled
def tabulate(cities: Array, matrix: Array) -> None:
    """Fill a matrix, shape (n, n, m), with the distances of all cities, shape (n, 2 m)."""
    for i in range(len(matrix)):
        for j in range(len(matrix)):
            for m in range(matrix.shape[2]):
                matrix[i, j, m] = distance(cities, 2 * m, i, j)


@compiled
def lengths(costs: Costs, tour: NDArray[np.int32]) -> tuple[float, float]:
    """Return both scaled lengths of a tour, summed afresh. O(n)."""
    first, second = travel_costs(costs, tour[-1], tour[0])
    for k in range(len(tour) - 1):
        c = travel_costs(costs, tour[k], tour[k + 1])
        first += c[0]
        second += c[1]
    return first, second


@compiled
def sum_lengths(costs: Costs, tour: NDArray[np.int32], sums: Array) -> None:
    """Sum the scaled lengths of a tour under all objectives, shape (m,). O(n m)."""
    for m in range(len(sums)):
        sums[m] = 0.0
    before = tour[len(tour) - 1]
    for k in range(len(tour)):
        city = tour[k]
        if not is_closing(costs.closing, before, city):
            for m in range(len(sums)):
                if len(costs.matrix):
                    sums[m] += costs.matrix[before, city, m]
                else:
                    sums[m] += distance(costs.cities, 2 * m, before, city)
        before = city
