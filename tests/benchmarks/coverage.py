"""`python -m tests.benchmarks coverage [--plot]`: the paper's coverage table, and a picture.

10 maps of 64 x 64 cells a size, of the kinds of PathBench, with 40, 100 and 200 places at random:
the first costs are lengths of shortest paths, the second are distances of random points in a
plane. Rows, seconds and reference point are those of `beside`; the paper names none. Prints a
table and stores `results/coverage.json`. With `--plot` it draws the guide's `coverage.png` instead.
"""

import numpy as np

from models.data.generators import coverage_matrices
from service.instance import Instance
from tests.benchmarks import coverage_plot
from tests.benchmarks.beside import measure, parser

SIZES = (40, 100, 200)


def main(arguments: list[str]) -> None:
    """The command line."""
    command = parser("coverage", __doc__, SIZES, "places")
    command.add_argument("--plot", action="store_true", help="draw the picture, measure nothing")
    options = command.parse_args(arguments)
    if options.plot:
        coverage_plot.draw()
        return
    groups = {
        f"{n} places": [coverage_instance(n, seed) for seed in range(options.count)]
        for n in options.sizes
    }
    measure("coverage", groups, options)


def coverage_instance(n: int, seed: int) -> Instance:
    """The instance of this size and number."""
    return Instance(matrices=coverage_matrices(np.random.default_rng([n, seed]), n))
