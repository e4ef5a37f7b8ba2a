"""Great-circle distances between places on the earth, taken as a sphere.

The haversine formula (Sinnott, 1984, Virtues of the haversine, Sky and Telescope 68), which keeps
its digits where places are near each other. Against an ellipsoid it errs by up to half a percent.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
EARTH_RADIUS = 6371008.8  # metres, the mean radius of the earth (Moritz, 2000)


def great_circle_matrix(locations: Array) -> Array:
    """Return the distances in metres between all places, shape (n, n).

    They are symmetric, and at most half of the earth's circumference. O(n^2).

    Args:
        locations: Longitude and latitude of each place in degrees, shape (n, 2).

    >>> pole_and_equator = np.array([[0.0, 90.0], [17.0, 0.0]])
    >>> great_circle_matrix(pole_and_equator).round()
    array([[       0., 10007557.],
           [10007557.,        0.]])
    """
    longitude, latitude = np.radians(locations).T
    north = _half_chords(latitude)
    east = _half_chords(longitude)
    # The square of half the chord through a sphere of radius 1; rounding may carry it beyond 1.
    square = north + np.outer(np.cos(latitude), np.cos(latitude)) * east
    return 2 * EARTH_RADIUS * np.arcsin(np.sqrt(np.minimum(square, 1.0)))


def _half_chords(angles: Array) -> Array:
    """Return the squared sines of half the differences of all angles, shape (n, n)."""
    return np.sin((angles[:, np.newaxis] - angles) / 2) ** 2


def great_circle_distances(one: Array, other: Array) -> Array:
    """Return the distances in metres from each place to the other of its row, shape (k,).

    Args:
        one: Longitude and latitude of each place in degrees, shape (k, 2).
        other: Likewise.

    >>> great_circle_distances(np.array([[0.0, 90.0]]), np.array([[17.0, 0.0]])).round()
    array([10007557.])
    """
    longitude, latitude = np.radians(one).T
    other_longitude, other_latitude = np.radians(other).T
    north = np.sin((latitude - other_latitude) / 2) ** 2
    east = np.sin((longitude - other_longitude) / 2) ** 2
    square = north + np.cos(latitude) * np.cos(other_latitude) * east
    return 2 * EARTH_RADIUS * np.arcsin(np.sqrt(np.minimum(square, 1.0)))
