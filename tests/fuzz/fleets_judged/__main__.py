"""`python -m tests.fuzz.fleets_judged --count 10000`: plan small fleets, and judge each plan.

With `--each 1000` it then goes on until that many fleets with each feature (`features.py`), or each
of those that are named, were judged whose plans the judge has all tried.

Exit status 1: a plan breaks a rule or tells other lengths or times than the judge, a front of all
plans lacks one, or a fleet is refused that has a plan.
"""

import argparse
import sys
import time

from tests.fuzz.fleets_judged.attack import judge_each, judge_many
from tests.fuzz.fleets_judged.features import FEATURES


def main() -> int:
    """Judge the plans of many fleets, print the faults, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.fleets_judged", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000, help="fleets")
    parser.add_argument("--each", type=int, default=0, help="fleets with each feature")
    parser.add_argument("features", nargs="*", metavar="feature", help="by default all")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    began = time.monotonic()
    names = options.features or [*FEATURES]
    outcomes = [
        judge_many(options.count, options.seed),
        judge_each(names, options.each, options.seed + 1),
    ]
    for outcome in outcomes:
        print(*outcome.faults, sep="\n")
        print(dict(outcome.counts), dict(outcome.tried), f"{time.monotonic() - began:.0f} s")
    return int(any(outcome.faults for outcome in outcomes))


if __name__ == "__main__":
    sys.exit(main())
