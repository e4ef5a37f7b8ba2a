"""`python -m tests.benchmarks open_routes`: how soon the front of open routes is found.

The search alone on the paper's 25 instances of 200 cities, on one thread: closed tours, routes with
free ends, with a fixed start, and with both ends fixed, each within 0.1 s and within 1 s. Stores
hypervolumes in per cent, reference point (200, 200), in `results/open_routes.json`, instance by
instance; what is stored is not measured again.
"""

import argparse
from functools import partial
from typing import Any

import numpy as np

from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.instances import COUNT, check_tours, paper_instances
from tests.benchmarks.markdown import table
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import resume

CITIES = 200
LIMITS = (0.1, 1.0)  # seconds
ENDS: dict[str, dict[str, Any]] = {
    "closed tours": {"closed": True},
    "free ends": {"closed": False},
    "fixed start": {"closed": False, "start": 0},
    "fixed ends": {"closed": False, "start": 0, "end": 1},
}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks open_routes", description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT, help="instances")
    options = parser.parse_args(arguments)
    warm_up()
    for name, ends in ENDS.items():
        instances = [
            Instance(coordinates=cities, **ends)
            for cities in paper_instances(CITIES, options.count)
        ]
        resume("open_routes", name, "", instances, partial(shares, limits=LIMITS))
    print(open_routes_table())


def shares(instance: Instance, limits: tuple[float, ...]) -> list[float]:
    """Return the hypervolume in per cent that a search of its own finds within each limit."""
    return [round(100 * _found(instance, limit), 4) for limit in limits]


def open_routes_table() -> str:
    """What is stored, as a table."""
    stored = load("open_routes")
    if not stored:
        return "Not measured.\n"
    rows = []
    for name, entry in stored.items():
        found = np.array(entry["instances"])
        means = [f"{share:.2f}" for share in found.mean(axis=0)]
        below = f"{(found[:, -1] - found[:, 0]).mean():.3f}"
        rows.append([name, *means, below, str(len(found)), str(entry["busy"])])
    limits = [f"{limit:g} s" for limit in LIMITS]
    return table(["routes", *limits, "below", "instances", "load a core"], rows)


def section() -> str:
    """What is stored, for the page of results."""
    return (
        "## Open routes\n\nNot in the paper: `python -m tests.benchmarks open_routes`. The search "
        "alone on the paper's\ninstances of 200 cities, reference point (200, 200), and how far "
        f"the shorter limit is below.\n\n{open_routes_table()}"
    )


def _found(instance: Instance, limit: float) -> float:
    none = np.empty((0, instance.n), np.int32)
    tours = improve(instance, none, watch=Watch(limit)).tours
    check_tours(tours, instance.n)
    return hypervolume(tour_lengths(instance, tours), np.full(2, float(instance.n)))
