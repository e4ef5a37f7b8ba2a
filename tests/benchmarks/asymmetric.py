"""`python -m tests.benchmarks asymmetric`: costs that differ by direction, beside OR-Tools.

Two kinds of matrices: entries uniform between 0 and 1; and such entries closed under the triangle
inequality, each the length of the shortest way there. Of 50 cities also the kinds that
`models.data.matrices` draws for training: roads, coverage maps, and distances in planes. Rows,
seconds and reference point are those of `beside`. Prints a table and stores
`results/asymmetric.json`.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import floyd_warshall

from models.data.matrices import maps, planes, roads
from service.instance import Instance
from tests.benchmarks.beside import measure, parser

SIZES = (20, 50, 100, 200)
MORE_KINDS = {"roads": roads, "maps": maps, "planes": planes}
_SIZE_OF_MORE_KINDS = 50


def main(arguments: list[str]) -> None:
    """The command line."""
    options = parser("asymmetric", __doc__, SIZES, "cities").parse_args(arguments)
    groups = {
        f"{n} cities, {kind}": [asymmetric(kind, n, seed) for seed in range(options.count)]
        for kind in ("uniform", "closed")
        for n in options.sizes
    }
    if (n := _SIZE_OF_MORE_KINDS) in options.sizes:
        for kind in MORE_KINDS:
            groups[f"{n} cities, {kind}"] = [drawn(kind, n, i) for i in range(options.count)]
    measure("asymmetric", groups, options)


def asymmetric(kind: str, n: int, seed: int) -> Instance:
    """The instance of this kind, size and number."""
    matrices: NDArray[np.float64] = np.random.default_rng([n, seed]).random((2, n, n))
    if kind == "closed":
        matrices = np.stack([floyd_warshall(matrix) for matrix in matrices])
    return Instance(matrices=matrices)


def drawn(kind: str, n: int, seed: int) -> Instance:
    """The instance of this kind of those for training, size and number."""
    return Instance(matrices=MORE_KINDS[kind](n, np.random.default_rng([n, seed])))
