"""`python -m tests.benchmarks NAME`: print what is stored of a benchmark, or run it.

Without an option nothing is measured. `NAME --again` measures, and writes into runs/benchmarks
alone: no tracked file changes. `NAME --store` measures the rows that are not stored yet, and writes
the tracked files: the results, their pictures and RESULTS.md. `NAME --again --store` measures
stored rows as well. Further arguments are of the benchmark: `NAME --help` lists them.
"""

import argparse
import json
import sys
from importlib import import_module

# Not what renders tables: it needs packages that only those need who measure.
from tests.benchmarks import provenance, shown

_NAMES = (
    "ablation",
    "actors",
    "asymmetric",
    "attack",
    "behind",
    "bounds",
    "concave",
    "congestion",
    "coverage",
    "curves",
    "day",
    "deadlines",
    "detours",
    "fleets",
    "fronts",
    "growth",
    "kro",
    "large",
    "layers",
    "literature",
    "load",
    "networks",
    "open_routes",
    "optima",
    "page",
    "public",
    "replan",
    "roads",
    "scale",
    "search",
    "served",
    "several",
    "shapes",
    "soak",
    "start",
    "tables",
    "training",
    "tri",
    "weights",
)


_OURS = ("export", "models", "paretour", "service", "tests")


def main() -> None:
    """Print or run the benchmark that the command line names."""
    modes = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    modes.add_argument("--again", action="store_true", help="measure, also what is stored")
    modes.add_argument("--store", action="store_true", help="measure, and write tracked files")
    parser = argparse.ArgumentParser(
        "python -m tests.benchmarks", description=__doc__, parents=[modes]
    )
    parser.add_argument("name", choices=_NAMES)
    parser.add_argument(
        "arguments", nargs=argparse.REMAINDER, help="the options above, and the benchmark's own"
    )
    options = parser.parse_args()
    mode, arguments = modes.parse_known_args(options.arguments, options)
    if mode.again or mode.store:
        provenance.begin(provenance.Run(mode.again, mode.store))
        _run(options.name, arguments)
    elif {"-h", "--help"} & set(arguments):
        _run(options.name, ["--help"])
    else:
        _print(options.name)


def _print(name: str) -> None:
    """Print the stored rows of a benchmark; of `tables` the page of results."""
    if name == "tables":
        rows = provenance.PAGE.read_text(encoding="utf-8")
    else:
        rows = shown.rows(provenance.load(name))
    print(rows or f"Nothing is stored of {name}.")
    print(f"\nMeasure anew: python -m tests.benchmarks {name} --again", file=sys.stderr)


def _run(name: str, arguments: list[str]) -> None:
    """Run a benchmark with its arguments, and print what it measured.

    A benchmark with demands returns a sentence on each that does not hold. These are printed, and
    the exit status is 1. What was measured and not stored is printed, and why it was not.
    """
    try:
        unmet = import_module(f"tests.benchmarks.{name}").main(arguments)
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package in _OURS:
            raise
        sys.exit(f"{name} needs {package}: pip install -e '.[bench,test]'")
    finally:
        for unstored_name, unstored in provenance.UNSTORED.items():
            print(json.dumps(unstored.rows, indent=2))
            print(f"{unstored_name} is not stored: {unstored.reason}", file=sys.stderr)
    if provenance.RUN.stores:
        render = import_module("tests.benchmarks.render")
        provenance.PAGE.write_text(render.page(), encoding="utf-8")
    else:
        _print_measured()
    if unmet:
        sys.exit(unmet)


def _print_measured() -> None:
    for path in sorted(provenance.ANEW.glob("*.json")):
        print(shown.rows(provenance.load(path.stem)))
        print(f"\nAll of it: {path.relative_to(provenance.ROOT)}", file=sys.stderr)


if __name__ == "__main__":
    main()
