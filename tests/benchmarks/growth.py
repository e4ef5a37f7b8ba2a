"""`python -m tests.benchmarks growth`: how the time to a good front grows with the cities.

Uniform cities, the search alone, on one thread. A front is good from when on its hypervolume is
within 1 % of that of the last front of the run, in the box from that one's least lengths to its
greatest. The growth is the exponent e of the law seconds ~ cities^e that fits best, by least
squares of the logarithms. All takes three minutes. What is stored is not measured again. Stores
`results/growth.json`.
"""

import argparse
import time
from typing import Any

import numpy as np

from service.pareto import hypervolume
from service.search.schedule import Search
from service.search.warm_up import warm_up
from tests.benchmarks.growth_table import growth_table
from tests.benchmarks.rows import Points, resume
from tests.benchmarks.scale import LIMITS, drawn

SHARE = 0.99  # of the last front's hypervolume
STEP = 1.05  # between the times at which the front is looked at


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks growth", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", choices=LIMITS, default=list(LIMITS))
    options = parser.parse_args(arguments)
    warm_up()
    for n in options.cities:
        resume("growth", f"{n} cities", "", [n], measured)
    print(growth_table())


def measured(n: int) -> dict[str, Any]:
    """The seconds until the front of n cities is good, and those of the whole run."""
    limit = LIMITS[n][-1]
    fronts = followed(Search(drawn("uniform", n), 0, np.full(2, float(n))), limit)
    return {"seconds": round(seconds_to(SHARE, fronts), 4), "limit": limit}


def followed(search: Search, limit: float) -> list[tuple[float, Points]]:
    """The fronts of a search by their seconds, the last at the limit."""
    began, due = time.monotonic(), 0.001
    fronts = []
    for _ in search.run():
        seconds = time.monotonic() - began
        if seconds >= due:
            fronts.append((seconds, search.points()))
            due = STEP * seconds
        if seconds >= limit:
            break
    return [*fronts, (time.monotonic() - began, search.points())]


def seconds_to(share: float, fronts: list[tuple[float, Points]]) -> float:
    """When the first front had this share of the last one's hypervolume, in the last one's box."""
    last = fronts[-1][1]
    least, extent = last.min(axis=0), np.ptp(last, axis=0)

    def volume(points: Points) -> float:
        scaled = np.maximum((points - least) / extent, 0.0)
        return hypervolume(scaled, np.ones(2))

    enough = share * volume(last)
    return next(seconds for seconds, points in fronts if volume(points) >= enough)
