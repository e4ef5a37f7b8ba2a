"""`python -m tests.benchmarks ablation`: what the search gains from the tours it sets out from.

On the paper's instances, at equal total time, building the first tours included: from the
network's tours for 100 and for 10 preferences, from those of greedy edge for 17 weights, from
100 random tours, and from nothing, when the search builds its own by nearest neighbour. One
thread. Prints a table and stores `results/ablation.json`.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.actor import Actor
from service.front import hypervolume
from service.improve import improve, warm_up
from service.instance import Instance, tour_lengths
from service.preferences import fan, from_angles
from tests.benchmarks.actors import ACTORS
from tests.benchmarks.instances import paper_instances, reference_points
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.rivals.construction import greedy_edge, spread_weights

SECONDS = {40: (0.02, 0.05, 0.2), 200: (0.1, 0.3, 1.0), 500: (0.5, 1.0, 3.0), 1000: (2.0, 5.0)}

Build = Callable[[Instance], NDArray[np.integer]]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks ablation", description=__doc__)
    parser.add_argument("--actor", default="pa-one")
    parser.add_argument("--count", type=int, default=10, help="instances of each size")
    options = parser.parse_args(arguments)
    actor = Actor(ACTORS / f"{options.actor}.onnx", threads=1)
    builders = _builders(actor)
    warm_up()
    results: dict[str, Any] = {**provenance(1), "digest": actor.facts.digest, "rows": {}}
    for n, limits in SECONDS.items():
        instances = [Instance(coordinates=x) for x in paper_instances(n, options.count)]
        for limit in limits:
            row = {name: _mean(build, instances, limit) for name, build in builders.items()}
            results["rows"][f"{n} cities, {limit} s"] = row
            store("ablation", results)
    _print_table(results["rows"])


def _builders(actor: Actor) -> dict[str, Build]:
    def network(k: int, instance: Instance) -> NDArray[np.integer]:
        return actor.tours(instance, from_angles(fan(k)))

    def at_random(instance: Instance) -> NDArray[np.integer]:
        generator = np.random.default_rng(0)
        return np.stack([generator.permutation(instance.n) for _ in range(100)])

    return {
        "nothing": lambda instance: np.empty((0, instance.n), np.int64),
        "100 tours of the network": partial(network, 100),
        "10 tours of the network": partial(network, 10),
        "17 tours of greedy edge": lambda instance: greedy_edge(instance, spread_weights(17)),
        "100 random tours": at_random,
    }


def _mean(build: Build, instances: list[Instance], limit: float) -> dict[str, float]:
    """Mean hypervolume in per cent, mean seconds, and how many builds alone took too long."""
    build(instances[0])  # compiles, and fills caches
    shares, seconds, late = [], [], 0
    for instance in tqdm(instances, desc=f"{instances[0].n} cities, {limit} s", leave=False):
        began = time.monotonic()
        tours = build(instance)
        late += time.monotonic() - began > limit
        found = improve(instance, tours, deadline=began + limit)
        seconds.append(time.monotonic() - began)
        [reference_point, *_] = reference_points(instance.n).values()
        shares.append(100 * hypervolume(tour_lengths(instance, found.tours), reference_point))
    return {
        "hypervolume": round(float(np.mean(shares)), 3),
        "seconds": round(float(np.mean(seconds)), 3),
        "late": late,
    }


def _print_table(rows: dict[str, dict[str, dict[str, float]]]) -> None:
    names = list(next(iter(rows.values())))
    print("| hypervolume, %, at (n, n), searching from | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for title, row in rows.items():
        cells = [
            f"{row[name]['hypervolume']:.2f}" + (" (late)" if row[name]["late"] else "")
            for name in names
        ]
        print(f"| {title} | " + " | ".join(cells) + " |")
