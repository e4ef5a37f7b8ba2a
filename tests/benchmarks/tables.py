"""`python -m tests.benchmarks tables --store`: measure the rows that RESULTS.md is missing.

The page, RESULTS.md, is written after every benchmark that stores; `--store --render` does nothing
else. Every part stores what it measures and goes on where it stopped. The long rows of the main
table take days over all instances: `--count` says how many instances a row gets at most.
"""

import argparse


def main(arguments: list[str]) -> None:
    """Measure the missing rows, or nothing with `--render`."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks tables", description=__doc__)
    parser.add_argument("--count", type=int, default=25, help="instances of each size")
    parser.add_argument("--render", action="store_true", help="measure nothing")
    options = parser.parse_args(arguments)
    if not options.render:
        _measure(str(options.count))


def _measure(count: str) -> None:
    # Here and not above, so that the page can be written without the rivals' libraries.
    from tests.benchmarks import concave, fronts, layers, networks, training

    concave.main([])
    training.main([])
    fronts.main([])
    layers.main(["--count", count])
    networks.main(["--count", count])
