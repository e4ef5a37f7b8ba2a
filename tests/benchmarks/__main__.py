"""`python -m tests.benchmarks NAME ...`: run a benchmark, and write RESULTS.md anew."""

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
    """Run the benchmark that the command line names, with the arguments after its name.

    A benchmark with demands returns a sentence on each that does not hold. These are printed, and
    the exit status is 1.
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
