"""Where cities lie in a plane: evenly, in clusters, in a long box, along streets."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Array = NDArray[np.float64]


def uniform(n: int, generator: Generator) -> Array:
    """Anywhere in the unit square, shape (n, 2)."""
    return generator.random((n, 2))


def clustered(n: int, generator: Generator) -> Array:
    """In two to seven Gaussian clusters, which may overlap."""
    centres = generator.random((generator.integers(2, 8), 2))
    cities = centres[generator.integers(len(centres), size=n)]
    return _in_unit_square(cities + generator.normal(scale=0.07, size=(n, 2)))


def stretched(n: int, generator: Generator) -> Array:
    """Evenly in a box whose long side is up to ten times the other."""
    sides = np.array([1.0, 10 ** -generator.random()])
    return generator.random((n, 2)) * generator.permutation(sides)


def streets(n: int, generator: Generator) -> Array:
    """Along the streets of a city laid out as a grid, three to ten in either direction."""
    cities = generator.random((n, 2))
    across = np.arange(n), generator.integers(2, size=n)
    count = generator.integers(3, 11)
    cities[across] = np.rint(cities[across] * (count - 1)) / (count - 1)
    return cities


def _in_unit_square(cities: Array) -> Array:
    # Of cities that all lie in one place there is nothing to scale.
    return (cities - cities.min(axis=0)) / max(np.ptp(cities, axis=0).max(), np.finfo(float).tiny)


KINDS: dict[str, Callable[[int, Generator], Array]] = {
    each.__name__: each for each in (uniform, clustered, stretched, streets)
}
