"""What an angle means.

A preference is a *direction* in objective space: the unit vector (cos a, sin a) along which
the point (f1, f2) of a tour should lie, both lengths scaled. At 0 degrees a tour would have
a first length and no second one; at 90 degrees the reverse. This is the reading of Mehta,
Taghipour and Saeedi (2022), arXiv:2203.01298.

It is not a *weight*. Minimising w1 f1 + w2 f2 for a heavy w1 makes f1 small and so turns the
point towards 90 degrees: the weights that go with a direction are its components exchanged.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def fan(k: int) -> Array:
    """Angles in degrees that cut the open interval (0, 90) into k equal parts, at their middles."""
    return (np.arange(k, dtype=np.float64) + 0.5) * (90.0 / k)


def from_angles(degrees: Array) -> Array:
    """Unit vectors, shape (k, 2), of angles in degrees, shape (k,)."""
    radians = np.deg2rad(degrees)
    return np.stack((np.cos(radians), np.sin(radians)), axis=-1).clip(0.0, 1.0)


def angles(points: Array) -> Array:
    """Angles in degrees, shape (k,), of scaled points, shape (k, 2); the origin counts as 45."""
    at_origin = (points == 0).all(axis=-1)
    degrees = np.rad2deg(np.arctan2(points[:, 1], points[:, 0]))
    return np.where(at_origin, 45.0, degrees)


def weights(preferences: Array) -> Array:
    """Weights of the weighted sum that goes with each direction, shape (k, 2), rows adding to 1."""
    return preferences[:, ::-1] / preferences.sum(axis=1, keepdims=True)
