"""`python -m tests.benchmarks NAME ...`: runs a benchmark, and writes RESULTS.md anew."""

import argparse
import sys
from importlib import import_module

from tests.benchmarks import render

_NAMES = (
    "ablation",
    "actors",
    "asymmetric",
    "concave",
    "coverage",
    "curves",
    "fronts",
    "kro",
    "large",
    "layers",
    "literature",
    "load",
    "networks",
    "page",
    "search",
    "shapes",
    "soak",
    "tables",
    "training",
)


def main() -> None:
    """The command line; what follows the name is the benchmark's own.

    A benchmark that knows what it must find gives a sentence on what it did not, which is printed,
    and the exit status is 1.
    """
    parser = argparse.ArgumentParser("python -m tests.benchmarks", description=__doc__)
    parser.add_argument("name", choices=_NAMES)
    options, rest = parser.parse_known_args()
    unmet = import_module(f"tests.benchmarks.{options.name}").main(rest)
    render.PAGE.write_text(render.page())
    if unmet:
        sys.exit(unmet)


if __name__ == "__main__":
    main()
