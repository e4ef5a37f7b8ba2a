"""`python -m tests.benchmarks asymmetric`: costs that differ by direction, beside OR-Tools.

Two kinds of matrices: entries uniform between 0 and 1; and such entries closed under the triangle
inequality, each the length of the shortest way there. Rows, seconds and reference point are those
of `beside`. Prints a table and stores `results/asymmetric.json`.
"""

import argparse

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import floyd_warshall

from service.instance import Instance
from tests.benchmarks.beside import measure

SIZES = (20, 50, 100, 200)
COUNT = 10


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks asymmetric", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=SIZES, default=SIZES)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each kind and size")
    parser.add_argument("--methods", nargs="+", default=[], help="names of rows; default: all")
    options = parser.parse_args(arguments)
    groups = {
        f"{n} cities, {kind}": [asymmetric(kind, n, seed) for seed in range(options.count)]
        for kind in ("uniform", "closed")
        for n in options.cities
    }
    measure("asymmetric", groups, options.methods)


def asymmetric(kind: str, n: int, seed: int) -> Instance:
    """The instance of this kind, size and number."""
    matrices: NDArray[np.float64] = np.random.default_rng([n, seed]).random((2, n, n))
    if kind == "closed":
        matrices = np.stack([floyd_warshall(matrix) for matrix in matrices])
    return Instance(matrices=matrices)
