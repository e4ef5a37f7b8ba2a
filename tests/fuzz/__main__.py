"""`python -m tests.fuzz --count 100000`: fuzz a service of its own, and watch its health.

`python -m tests.fuzz files 2000`: mutate tables, and judge what they become (tests/fuzz/tables.py).

Bodies of each generator are parsed in this process; one in fifty of them, and as many of extreme
numbers, go to a real server. Exit status 1: health took longer than 100 ms, or there was too much
memory or a lost worker.
"""

import argparse
import random
import re
import sys
import time
from collections.abc import Iterator

import httpx
import numpy as np

from service.errors import Refusal
from service.requests.replan.way import ReplanSource
from service.requests.task import TaskSource
from tests.fuzz.attack import largest_memory, parse_many, post_many, watching_health
from tests.fuzz.bodies import GENERATORS, extreme
from tests.fuzz.tables import tried
from tests.helpers.processes import serve_process
from tests.helpers.serving import ACTORS, LIMITS

ONE_IN = 50
HEALTH_SECONDS = 0.1
MEGABYTES = 1024


def main() -> int:
    """Run the attack and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("what", nargs="?", choices=("bodies", "files"), default="bodies")
    parser.add_argument("number", nargs="?", type=int, default=2000, help="of mutated files")
    parser.add_argument("--count", type=int, default=10_000, help="bodies of all generators")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.what == "files":
        return _try_files(options.number)
    began = time.monotonic()
    actors = {actor.info.name: actor.info for actor in ACTORS}
    each = options.count // len(GENERATORS)
    for name in GENERATORS:
        print(name, dict(parse_many(name, each, options.seed, LIMITS, actors)))
    with serve_process({}, ready=True) as service, watching_health(service.url) as watch:
        print("over HTTP", dict(post_many(service.url, _sample(options.count, options.seed))))
        metrics = httpx.get(f"{service.url}/metrics").text
    lost = float(re.findall(r"^paretour_worker_restarts_total (\S+)", metrics, re.M)[0])
    slowest = max(watch.seconds)
    late = np.quantile(watch.seconds, 0.99)
    print(
        f"health: {len(watch.seconds)} answers, the 99th percentile after {1000 * late:.0f} ms,"
        f" the slowest after {1000 * slowest:.0f} ms"
    )
    print(f"{largest_memory():.0f} MB, {lost:g} workers lost, {time.monotonic() - began:.0f} s")
    return int(slowest > HEALTH_SECONDS or largest_memory() > MEGABYTES or lost > 0)


def _try_files(number: int) -> int:
    outcomes, faults = tried(number)
    print("files", dict(outcomes), *faults, sep="\n")
    return int(bool(faults))


def _sample(count: int, seed: int) -> Iterator[TaskSource | ReplanSource]:
    for number in range(count // ONE_IN // (len(GENERATORS) + 1)):
        rng = random.Random(f"http {seed} {number}")
        yield extreme(rng)
        for make in GENERATORS.values():
            made = make(rng)
            if not isinstance(made, Refusal):
                yield made


if __name__ == "__main__":
    sys.exit(main())
