"""Compile the search for three and four objectives, or load it from the cache.

Two processes compile it side by side. So it has two pieces, which share little.
"""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.best_subset import best_subset
from service.search.bound.several import lowest_lengths
from service.search.enumeration import exact_tours
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.improve import improve
from service.watch import Watch

_N = 12  # cities: too many to enumerate


def warm_up() -> None:
    """Compile what two objectives do not need; what they need too is compiled before."""
    local_search()
    beside_local_search()


def local_search() -> None:
    """Compile searches."""
    for instance in _instances():
        improve(instance, np.arange(_N)[np.newaxis], iterations=3_000, capacity=16)


def beside_local_search() -> None:
    """Compile what follows a search, and the enumeration of few cities."""
    for objectives in (3, 4):
        front = FrontPoints.among(np.eye(objectives), np.full(objectives, 2.0))[1]
        best_subset(front, 2)
        hypervolume(front.points, front.reference_point)
        exact_tours(Instance(coordinates=_planes(objectives)[:5]))


def bounds() -> None:
    """Compile the bounds on the hypervolume, up to the volume, for which nothing is compiled."""
    for instance in _instances():
        lowest_lengths(instance, Watch())


def _instances() -> tuple[Instance, Instance]:
    """Return an instance by coordinates, and one by matrices."""
    cities = np.arange(float(_N))
    matrices = np.triu(np.outer(cities, cities) % np.array([7.0, 5.0, 3.0]).reshape(3, 1, 1))
    return Instance(coordinates=_planes(3)), Instance(matrices=matrices)


def _planes(objectives: int) -> NDArray[np.float64]:
    """Return coordinates of cities, shape (_N, 2 m)."""
    cities = np.arange(float(_N))
    steps = np.arange(1.0, 2 * objectives + 1)
    return np.outer(cities, steps) % (2 * steps + 9)
