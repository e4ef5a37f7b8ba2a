"""The same bound of three and four objectives: half-spaces cut the box instead of half-planes."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.preferences import lattice, spread_out
from service.search.bound.weighted import SLACK, lowest_sums
from service.search.costs import as_two, make_costs, scaled_reference
from service.watch import Watch

Array = NDArray[np.float64]

PARTS = {3: 6, 4: 4}  # of 1, that the weights share: 28 and 35 weights
LEAST_SHARE = 1e-3  # of a weight, so that every half-space is cut by each axis
THINNEST = 1e-6  # share of the box's diagonal that is left, below which one half-space alone counts


def bound_of_several(instance: Instance, reference_point: Array, watch: Watch[Any]) -> float:
    """Return an upper bound on the hypervolume of any front of the instance, 0 to 1."""
    weights, lowest = lowest_lengths(instance, watch)
    return volume_above(weights * scaled_reference(instance, reference_point), lowest)


def lowest_lengths(instance: Instance, watch: Watch[Any]) -> tuple[Array, Array]:
    """Return weights, shape (k, m), and a lower bound on the length of all tours under each."""
    shares = lattice(instance.objectives, PARTS[instance.objectives]).clip(LEAST_SHARE)
    weights = shares[spread_out(shares)] / np.ldexp(instance.scale, instance.shifts)
    weights /= weights.sum(axis=1, keepdims=True)
    costs = make_costs(instance)
    sums = [as_two(costs, each) for each in weights]
    return weights, lowest_sums(sums, range(len(weights)), weights, watch)


def volume_above(weights: Array, lowest: Array) -> float:
    """Return the volume of the points p of the unit cube with weights @ p >= lowest, or a bit more.

    Weights, shape (k, m), are positive; lowest has shape (k,).
    """
    from scipy import spatial  # imported late: it takes 0.2 s, and two objectives do without

    sums = weights.sum(axis=1)
    room = (sums - lowest) / sums  # on the diagonal, from the corner (1, ..., 1)
    if room.min() <= 0:
        return 0.0
    corners = (room * sums) ** weights.shape[1] / weights.prod(axis=1)
    least = float(corners.min()) / math.factorial(weights.shape[1])
    if room.min() < THINNEST:
        return min(1.0, least * (1 + SLACK))
    identity = np.eye(weights.shape[1])
    ones = np.ones((weights.shape[1], 1))
    half_spaces = np.concatenate(
        (
            np.concatenate((-weights, lowest[:, np.newaxis]), axis=1) / sums[:, np.newaxis],
            np.concatenate((identity, -ones), axis=1),
            np.concatenate((-identity, 0 * ones), axis=1),
        )
    )
    inside = np.full(weights.shape[1], 1 - min(1.0, float(room.min())) / 2)
    corners = spatial.HalfspaceIntersection(half_spaces, inside).intersections
    return min(1.0, float(spatial.ConvexHull(corners).volume) * (1 + SLACK))
