"""Hypervolumes of points of two, three or four objectives."""

import numpy as np
from numpy.typing import NDArray

from service import pareto
from service.objectives import OBJECTIVES
from service.search.several.volume import volume

Array = NDArray[np.float64]


def hypervolume(points: Array, reference_point: Array) -> float:
    """Return the hypervolume of points: the share of the box that they dominate, 0 to 1.

    Exact. O(k log k) of two and of three objectives, O(k^2 log k) of four.

    Args:
        points: Shape (k, m), not negative, in any order; k may be 0.
        reference_point: Shape (m,), positive, in the unit of the points.

    Raises:
        ValueError: A component of the reference point is not positive.
    """
    if len(reference_point) == OBJECTIVES:
        return pareto.hypervolume(points, reference_point)
    if not (reference_point > 0).all():
        raise ValueError(f"the reference point must be positive, got {reference_point.tolist()}")
    return volume(pareto.shares_of(points, reference_point))
