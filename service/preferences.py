"""Preferences: angles in degrees, directions in objective space, and weights.

A preference is a *direction* in objective space: the unit vector (cos a, sin a) along which
the point (f1, f2) of a tour should lie, both lengths scaled. At 0 degrees a tour would have
a first length and no second one; at 90 degrees the reverse. This is the reading of Mehta,
Taghipour and Saeedi (2022), arXiv:2203.01298.

It is not a *weight*. Minimising w1 f1 + w2 f2 for a heavy w1 makes f1 small and so turns the
point towards 90 degrees: the weights that go with a direction are its components exchanged.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@lru_cache(maxsize=64)  # nearly all requests have the same k
def fan(k: int) -> Array:
    """Return the middles of k equal parts of the interval from 0 to 90 degrees, ascending.

    >>> fan(3)
    array([15., 45., 75.])
    """
    middles = (np.arange(k, dtype=np.float64) + 0.5) * (90.0 / k)
    middles.setflags(write=False)
    return middles


def from_angles(degrees: Array) -> Array:
    """Return unit vectors, shape (k, 2), of angles from 0 to 90 degrees, shape (k,).

    >>> from_angles(np.array([0.0, 30.0, 90.0])).round(4)
    array([[1.   , 0.   ],
           [0.866, 0.5  ],
           [0.   , 1.   ]])
    """
    radians = np.deg2rad(degrees)
    directions = np.empty((len(radians), 2))
    np.cos(radians, out=directions[:, 0])
    np.sin(radians, out=directions[:, 1])
    return directions.clip(0.0, 1.0, out=directions)


def angles(points: Array, scale: Array) -> Array:
    """Return the angles in degrees, shape (k,), of points, shape (k, 2), once they are scaled.

    A point on an axis has the angle of that axis, however small it is once it is scaled. The origin
    has the angle 45.

    >>> angles(np.array([[2.0, 0.0], [1.0, 1.0], [0.0, 0.0], [0.0, 1e-200]]), np.full(2, 1e200))
    array([ 0., 45., 45., 90.])
    """
    with np.errstate(over="ignore"):
        scaled = points / scale
    degrees = np.rad2deg(np.arctan2(scaled[:, 1], scaled[:, 0]))
    first, second = (points > 0).T
    at_origin = (scaled == 0).all(axis=1)
    return np.select([first & ~second, second & ~first, at_origin], [0.0, 90.0, 45.0], degrees)


def weights(preferences: Array) -> Array:
    """Return the weights, rows adding to 1, of the weighted sum that goes with each direction.

    Args:
        preferences: Directions, shape (k, 2), as from_angles() returns them.

    >>> weights(np.array([[0.6, 0.8], [1.0, 0.0]])).round(4)
    array([[0.5714, 0.4286],
           [0.    , 1.    ]])
    """
    return preferences[:, ::-1] / preferences.sum(axis=1, keepdims=True)
