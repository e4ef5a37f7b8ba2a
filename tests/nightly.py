"""`python -m tests.nightly`: run all tests on all their cases, and then the fuzzing by itself.

The suite tries a tenth of the random bodies, kills and crowds, a third or a sixth of the seeds and
a few of many cases that are alike, and makes no clients by generators (tests/helpers/sampled.py).
Arguments are those of pytest, such as `-n 2` or a folder. Exit status 1: something has failed.
"""

import os
import subprocess
import sys
from collections.abc import Sequence

from tests.helpers.sampled import WHOLE

FUZZING = (
    ("tests.fuzz", "--count", "100000"),
    ("tests.fuzz", "files", "20000"),
    ("tests.fuzz.fleets_judged", "--count", "10000", "--each", "1000"),
)


def main(arguments: Sequence[str]) -> int:
    """Run the tests, and the fuzzing unless only some tests are asked for; return the status."""
    commands: list[tuple[str, ...]] = [("pytest", *arguments), *(() if arguments else FUZZING)]
    environment = {**os.environ, WHOLE: "1"}
    statuses = [
        subprocess.run([sys.executable, "-m", *command], env=environment, check=False).returncode
        for command in commands
    ]
    return int(any(statuses))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
