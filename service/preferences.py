"""Preferences: angles in degrees, directions in objective space, and weights.

A preference is a *direction* in objective space: the unit vector along which the point of a tour
should lie, all lengths scaled. Of two objectives it is (cos a, sin a) of an angle a: at 0 degrees a
tour would have a first length and no second one; at 90 degrees the reverse. This is the reading of
Mehta, Taghipour and Saeedi (2022), arXiv:2203.01298.

It is not a *weight*. Minimising w1 f1 + w2 f2 for a heavy w1 makes f1 small and so turns the
point towards 90 degrees: the weights that go with a direction are as one over its components.
"""

import math
from functools import lru_cache
from itertools import combinations, count

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_FLAT = 2  # objectives, under which a preference is an angle
_LEAST_SHARE = 1e-3  # of a weight that is 0: its direction would lie along an axis


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


def spread(k: int, objectives: int = _FLAT) -> Array:
    """Return k directions, shape (k, m), that are spread evenly.

    Of two objectives they are those of fan(). Of more, they are those of the weights of a lattice,
    as the literature has them: of three objectives 105 are those that are multiples of 1/13. Where
    the least lattice that is large enough has more than k, they are spread over it.

    >>> spread(3).round(4)
    array([[0.9659, 0.2588],
           [0.7071, 0.7071],
           [0.2588, 0.9659]])
    >>> spread(3, 3).round(3)
    array([[0.707, 0.707, 0.001],
           [0.707, 0.001, 0.707],
           [0.001, 0.707, 0.707]])
    """
    if objectives == _FLAT:
        return from_angles(fan(k))
    parts = next(s for s in count(1) if math.comb(s + objectives - 1, objectives - 1) >= k)
    shares = lattice(objectives, parts)
    if k < len(shares):
        shares = shares[np.sort(spread_out(shares)[:k])]
    return directions_of(shares)


def lattice(objectives: int, parts: int) -> Array:
    """Return all vectors, shape (k, m), of whole numbers of parts of 1 that add to 1.

    >>> lattice(3, 1)
    array([[0., 0., 1.],
           [0., 1., 0.],
           [1., 0., 0.]])
    """
    places = parts + objectives - 1
    bars = np.array(list(combinations(range(places), objectives - 1)))
    bars = np.pad(bars, ((0, 0), (1, 1)), constant_values=((0, 0), (-1, places)))
    return (np.diff(bars, axis=1) - 1) / parts


def spread_out(points: Array) -> NDArray[np.intp]:
    """Return an order of points, shape (k, m), in which each is as far as can be from those before.

    The first is one that is farthest from the middle. O(k^2).
    """
    order = [int(np.linalg.norm(points - points.mean(axis=0), axis=1).argmax())]
    nearest = np.full(len(points), np.inf)
    for _ in range(len(points) - 1):
        nearest = np.minimum(nearest, np.linalg.norm(points - points[order[-1]], axis=1))
        order.append(int(nearest.argmax()))
    return np.array(order)


def directions_of(shares: Array) -> Array:
    """Return the unit vectors, shape (k, m), that go with weights; one of 0 counts as 0.001."""
    directions = weights(shares.clip(_LEAST_SHARE))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def weights(preferences: Array) -> Array:
    """Return the weights, rows adding to 1, of the weighted sum that goes with each direction.

    They are as one over its components: each is the product of the others, over their sum.

    Args:
        preferences: Directions, shape (k, m).

    >>> weights(np.array([[0.6, 0.8], [1.0, 0.0]])).round(4)
    array([[0.5714, 0.4286],
           [0.    , 1.    ]])
    >>> weights(np.array([[0.2, 0.4, 0.4]])).round(4)
    array([[0.5 , 0.25, 0.25]])
    """
    objectives = preferences.shape[1]
    if objectives == _FLAT:
        return preferences[:, ::-1] / preferences.sum(axis=1, keepdims=True)
    own = np.eye(objectives, dtype=bool)
    others: Array = np.where(own, 1.0, preferences[:, np.newaxis]).prod(axis=2)
    return others / others.sum(axis=1, keepdims=True)
