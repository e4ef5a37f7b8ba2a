"""The distances of TSPLIB (Reinelt, 1991), rounded as it defines them."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# The axes of places, by the kind of distance between them.
DIMENSIONS = {
    "EUC_2D": 2,
    "CEIL_2D": 2,
    "MAN_2D": 2,
    "MAX_2D": 2,
    "GEO": 2,
    "ATT": 2,
    "EUC_3D": 3,
    "MAN_3D": 3,
    "MAX_3D": 3,
}
_PI = 3.141592  # as TSPLIB defines it
_EARTH = 6378.388  # kilometres, as TSPLIB defines it


def distances(kind: str, places: Array) -> Array:
    """Return the distance from each place to each, shape (n, n)."""
    if kind == "GEO":
        return _geo(places)
    apart = np.abs(places[:, np.newaxis] - places)
    return _PLANAR[kind.partition("_")[0]](apart)


def _nearest(lengths: Array) -> Array:
    return np.floor(lengths + 0.5)


def _euclidean(apart: Array) -> Array:
    return np.sqrt((apart**2).sum(axis=-1))


def _att(apart: Array) -> Array:
    """Return pseudo-Euclidean distances, which are never rounded down."""
    lengths = np.sqrt((apart**2).sum(axis=-1) / 10)
    rounded = _nearest(lengths)
    return rounded + (rounded < lengths)


_PLANAR: dict[str, Callable[[Array], Array]] = {
    "EUC": lambda apart: _nearest(_euclidean(apart)),
    "CEIL": lambda apart: np.ceil(_euclidean(apart)),
    "MAN": lambda apart: _nearest(apart.sum(axis=-1)),
    "MAX": lambda apart: _nearest(apart).max(axis=-1),
    "ATT": _att,
}


def _geo(places: Array) -> Array:
    """Return distances in whole kilometres on the earth, of latitudes and longitudes as DDD.MM."""
    degrees = np.trunc(places)  # TSPLIB says rounded, but the known optima are for this
    latitude, longitude = (_PI * (degrees + 5 * (places - degrees) / 3) / 180).T
    q1 = np.cos(longitude[:, np.newaxis] - longitude)
    q2 = np.cos(latitude[:, np.newaxis] - latitude)
    q3 = np.cos(latitude[:, np.newaxis] + latitude)
    cosine = np.clip(0.5 * ((1 + q1) * q2 - (1 - q1) * q3), -1, 1)
    lengths = np.floor(_EARTH * np.arccos(cosine) + 1)
    np.fill_diagonal(lengths, 0)
    return lengths
