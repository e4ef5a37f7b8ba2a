"""Offer points and their tours to an archive, of two objectives or more."""

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled
from service.search.archive import blocks, sorted_points
from service.search.archive.layout import Archive, is_sorted

Array = NDArray[np.float64]


@compiled
def accepts(archive: Archive, point: Array) -> bool:
    """Return whether no point dominates or equals the given one, but for rounding."""
    if is_sorted(archive):
        return sorted_points.accepts(archive, point)
    return blocks.accepts(archive, point)


@compiled
def insert(archive: Archive, point: Array, tour: NDArray[np.int32]) -> bool:
    """Insert a tour unless it is dominated or equalled, and drop those that it dominates.

    Returns whether it was inserted. A full archive is thinned first.
    """
    if is_sorted(archive):
        return sorted_points.insert(archive, point, tour)
    return blocks.insert(archive, point, tour)
