"""The instances of the paper's tables, and the reference points that they are measured with."""

import numpy as np
from numpy.typing import NDArray

SIZES = (40, 200, 500, 1000)
COUNT = 25


def paper_instances(n: int, count: int = COUNT) -> list[NDArray[np.float64]]:
    """The first test instances with n cities, each of shape (n, 4).

    As the authors' code draws them: one generator a size, and a shuffle of the cities' numbers
    after each instance.
    """
    generator = np.random.RandomState(1)
    instances = []
    for _ in range(count):
        instances.append(generator.rand(n, 4))
        generator.shuffle(np.arange(n))
    return instances


def check_tours(tours: NDArray[np.integer], n: int) -> None:
    """Raise RuntimeError when some row does not visit each of n cities once."""
    if not (np.sort(tours, axis=1) == np.arange(n)).all():
        raise RuntimeError("not every tour visits every city once")


def reference_points(n: int) -> dict[str, NDArray[np.float64]]:
    """By name, (n, n); and for 40 cities also (50, 50), which the paper's printed column needs."""
    sides = (40, 50) if n == 40 else (n,)
    return {f"({side}, {side})": np.full(2, float(side)) for side in sides}
