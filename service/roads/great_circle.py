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
    return great_circle_distances(locations[:, np.newaxis], locations)


def great_circle_distances(one: Array, other: Array) -> Array:
    """Return the distances in metres from places to others, of shapes that broadcast.

    Args:
        one: Longitude and latitude of each place in degrees, shape (..., 2).
        other: The other positions, likewise.

    >>> great_circle_distances(np.array([[0.0, 90.0]]), np.array([[17.0, 0.0]])).round()
    array([10007557.])
    """
    one, other = np.radians(one), np.radians(other)
    half_chords = np.sin((one - other) / 2) ** 2
    level = np.cos(one[..., 1]) * np.cos(other[..., 1])
    # The square of half the chord through a sphere of radius 1; rounding may carry it beyond 1.
    square = half_chords[..., 1] + level * half_chords[..., 0]
    return 2 * EARTH_RADIUS * np.arcsin(np.sqrt(np.minimum(square, 1.0)))
