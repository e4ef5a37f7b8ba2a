"""`python -m tests.benchmarks networks`: the paper's main table, hypervolume and seconds.

On the paper's instances of 40, 200, 500 and 1000 cities. Seconds are those of the processor, which
another program's load stretches little. Stores `results/networks.json`, instance by instance;
what is stored is not measured again, so that a run may be broken off, and a later one with a
larger `--count` adds to it. An instance of 1000 cities takes OR-Tools without limit an hour, and
the evolutionary rivals a minute.
"""

import argparse
from functools import partial

from service.instance import Instance
from tests.benchmarks.instances import COUNT, SIZES, paper_instances
from tests.benchmarks.methods import methods
from tests.benchmarks.rows import measured, resume


def main(arguments: list[str]) -> None:
    """The command line."""
    known = methods()
    parser = argparse.ArgumentParser("python -m tests.benchmarks networks", description=__doc__)
    parser.add_argument("--rows", nargs="+", choices=known, help="default: all")
    parser.add_argument("--cities", type=int, nargs="+", choices=SIZES, default=SIZES)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    tiny = Instance(coordinates=paper_instances(10, 1)[0])
    for row in options.rows or known:
        if known[row].fills_caches:
            known[row].find(tiny)
    for n in options.cities:
        instances = [Instance(coordinates=x) for x in paper_instances(n, options.count)]
        for row in options.rows or known:
            method = known[row]
            resume("networks", f"{n} {row}", method.digest, instances, partial(measured, method))
