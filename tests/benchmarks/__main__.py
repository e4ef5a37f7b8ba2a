"""`python -m tests.benchmarks NAME ...`: run a benchmark, and write RESULTS.md anew."""

import argparse
import json
import sys
from importlib import import_module

from tests.benchmarks import provenance, render

_NAMES = (
    "ablation",
    "actors",
    "asymmetric",
    "attack",
    "behind",
    "bounds",
    "concave",
    "coverage",
    "curves",
    "day",
    "fleet",
    "fronts",
    "growth",
    "kro",
    "large",
    "layers",
    "literature",
    "load",
    "networks",
    "open_routes",
    "page",
    "replan",
    "roads",
    "scale",
    "search",
    "several",
    "shapes",
    "soak",
    "solomon",
    "start",
    "tables",
    "training",
    "tri",
    "weights",
)


_OURS = ("export", "models", "paretour", "service", "tests")


def main() -> None:
    """Run the benchmark that the command line names, with the arguments after its name.

    A benchmark with demands returns a sentence on each that does not hold. These are printed, and
    the exit status is 1. What was measured and not stored is printed, and why it was not.
    """
    parser = argparse.ArgumentParser("python -m tests.benchmarks", description=__doc__)
    parser.add_argument("name", choices=_NAMES)
    parser.add_argument(
        "arguments", nargs=argparse.REMAINDER, help="of the benchmark: see its --help"
    )
    options = parser.parse_args()
    try:
        unmet = import_module(f"tests.benchmarks.{options.name}").main(options.arguments)
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package in _OURS:
            raise
        sys.exit(f"{options.name} needs {package}: pip install -e '.[bench,train]'")
    finally:
        for name, unstored in provenance.UNSTORED.items():
            print(json.dumps(unstored.rows, indent=2))
            print(f"{name} is not stored: {unstored.reason}", file=sys.stderr)
    render.PAGE.write_text(render.page())
    if unmet:
        sys.exit(unmet)


if __name__ == "__main__":
    main()
