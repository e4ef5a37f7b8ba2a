"""Dominance and hypervolume of points in the plane. Both objectives are minimised."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def nondominated(points: Array) -> NDArray[np.intp]:
    """Indices of the nondominated points among points, shape (m, 2), by ascending first length.

    Of equal points the first one given stays. O(m log m).
    """
    order = np.lexsort((points[:, 1], points[:, 0]))
    second = points[order, 1]
    best_before = np.concatenate(([np.inf], np.minimum.accumulate(second)[:-1]))
    return order[second < best_before]


def hypervolume(points: Array, reference_point: Array) -> float:
    """Share of the box from the origin to the reference point that the points dominate, 0 to 1.

    Exact, by a sweep over the nondominated points; points beyond the reference point add
    nothing. The points, shape (m, 2), may be in any order and may repeat.

    Raises:
        ValueError: a component of the reference point is not positive.
    """
    if not (reference_point > 0).all():
        raise ValueError(f"the reference point must be positive, got {reference_point.tolist()}")
    shares = points / reference_point
    inside = shares[(shares < 1).all(axis=1)]
    front = inside[nondominated(inside)]
    heights = np.concatenate(([1.0], front[:-1, 1])) - front[:, 1]
    return float(((1 - front[:, 0]) * heights).sum())
