"""Instances and tours drawn at random, and one weighted sum of both objectives."""

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.candidates import Scalarization
from service.search.costs import make_costs

KINDS = ("coordinates", "symmetric", "asymmetric")


def small_integers(kind: str, n: int, seed: int) -> Instance:
    """An instance of small whole numbers, so that ties and coincident cities are common."""
    rng = np.random.default_rng(seed)
    if kind == "coordinates":
        return Instance(coordinates=rng.integers(0, 6, (n, 4)).astype(float))
    matrices = rng.integers(0, 9, (2, n, n)).astype(float)
    if kind == "symmetric":
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


def uniform(n: int, seed: int = 0) -> Instance:
    """Coordinates drawn uniformly from the unit squares."""
    return Instance(coordinates=np.random.default_rng(seed).random((n, 4)))


def random_matrices(n: int, seed: int, symmetric: bool) -> Instance:
    """Matrices of uniform costs."""
    matrices = np.random.default_rng(seed).random((2, n, n))
    if symmetric:
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


def random_tours(n: int, m: int, seed: int = 0) -> NDArray[np.int64]:
    """Tours drawn uniformly, shape (m, n)."""
    rng = np.random.default_rng(seed)
    return np.array([rng.permutation(n) for _ in range(m)], np.int64).reshape(m, n)


def no_tours(n: int) -> NDArray[np.int32]:
    """Tours of n cities, shape (0, n)."""
    return np.empty((0, n), np.int32)


def scalarization_of(instance: Instance) -> Scalarization:
    """The sum of both objectives under equal weights, with eight candidates a city."""
    costs = make_costs(instance)
    sums = costs.matrix.sum(axis=2) + np.diag(np.full(instance.n, np.inf))
    candidates = np.argsort(sums, axis=1)[:, : min(8, instance.n - 1)]
    candidate_costs = np.take_along_axis(sums, candidates, axis=1) / 2
    return Scalarization(
        costs, np.ascontiguousarray(candidates, np.int32), candidate_costs, 0.5, 0.5
    )
