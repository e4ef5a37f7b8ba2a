"""`python -m tests.fuzz.fleets_judged --count 10000`: plan small fleets, and judge each plan.

Exit status 1: a plan breaks a rule or tells other lengths or times than the judge, a front of all
plans lacks one, or a fleet is refused that has a plan.
"""

import argparse
import sys
import time

from tests.fuzz.fleets_judged.attack import judge_many


def main() -> int:
    """Judge the plans of many fleets, print the faults, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz.fleets_judged", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000, help="fleets")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    began = time.monotonic()
    outcome = judge_many(options.count, options.seed)
    for fault in outcome.faults:
        print(fault)
    print(dict(outcome.counts), f"{time.monotonic() - began:.0f} s")
    return int(bool(outcome.faults))


if __name__ == "__main__":
    sys.exit(main())
