"""`python -m tests.benchmarks NAME ...`: runs a benchmark, and writes RESULTS.md anew."""

import argparse
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
    "layers",
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
    """The command line; what follows the name is the benchmark's own."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks", description=__doc__)
    parser.add_argument("name", choices=_NAMES)
    options, rest = parser.parse_known_args()
    import_module(f"tests.benchmarks.{options.name}").main(rest)
    render.PAGE.write_text(render.page())


if __name__ == "__main__":
    main()
