"""`python -m tests.benchmarks shapes`: planes of other shapes, beside the construction heuristics.

Both planes of an instance are clustered, boxes of one by ten, or a city's streets; or one is
uniform and the other a box, in units a thousand times as large. Each actor that reads coordinates
builds 100 tours alone. Seconds are those of the processor, on one thread; the reference point is
n times the scale. What is stored is not measured again. Prints a table and stores
`results/shapes.json`.
"""

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from models.data.generators import clustered, streets, uniform
from service.actor import load_actors
from service.instance import Instance
from service.preferences import fan, from_angles
from tests.benchmarks.beside import measured
from tests.benchmarks.provenance import load
from tests.benchmarks.rivals.construction import greedy_edge, nearest_neighbour, spread_weights
from tests.benchmarks.rows import resume

ACTORS = Path("service/actors")
SIZES = (40, 200, 500)
COUNT = 10
TOURS = 100

Build = Callable[[Instance], NDArray[np.integer]]
Plane = NDArray[np.float64]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks shapes", description=__doc__)
    parser.add_argument("names", nargs="*", default=["pa-one"], help="actors; default: pa-one")
    parser.add_argument("--actors", type=Path, default=ACTORS, help="directory of ONNX files")
    parser.add_argument("--cities", dest="sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size and kind")
    options = parser.parse_args(arguments)
    for row, (digest, build) in builders(options.actors, options.names).items():
        for kind in KINDS:
            for n in options.sizes:
                instances = [shaped(kind, n, seed) for seed in range(options.count)]
                key = f"{n} cities, {kind}: {row}"
                resume("shapes", key, digest, instances, partial(measured, build))
    _print_table()


def builders(actors: Path, names: list[str]) -> dict[str, tuple[str, Build]]:
    """By the name of its row, the digest of its network (or nothing) and how tours are built."""
    loaded = load_actors(actors, threads=1)
    weights, preferences = spread_weights(TOURS), from_angles(fan(TOURS))
    rows: dict[str, tuple[str, Build]] = {
        name: (loaded[name].info.digest, partial(loaded[name].tours, preferences=preferences))
        for name in names
    }
    rows["Nearest neighbour"] = "", partial(nearest_neighbour, weights=weights)
    rows["Greedy edge"] = "", partial(greedy_edge, weights=weights)
    return rows


def shaped(kind: str, n: int, seed: int) -> Instance:
    """The instance of this kind, size and number."""
    generator = np.random.default_rng([n, seed])
    both = [draw(n, generator) for draw in KINDS[kind]]
    return Instance(coordinates=np.concatenate(both, axis=1))


def _box(n: int, generator: Generator) -> Plane:
    return generator.random((n, 2)) * (1.0, 0.1)


def _large_box(n: int, generator: Generator) -> Plane:
    return 1000 * _box(n, generator)


KINDS = {
    "clusters": (clustered, clustered),
    "boxes": (_box, _box),
    "streets": (streets, streets),
    "square and box": (uniform, _large_box),
}


def _print_table() -> None:
    stored = load("shapes")
    rows = dict.fromkeys(key.partition(": ")[2] for key in stored)
    groups = dict.fromkeys(key.partition(": ")[0] for key in stored)
    print("| | " + " | ".join(rows) + " |")
    print("|---" * (len(rows) + 1) + "|")
    for group in groups:
        shares = [
            [each["hypervolume"] for each in stored[f"{group}: {row}"]["instances"]] for row in rows
        ]
        print(f"| {group} | " + " | ".join(f"{np.mean(each):.2f}" for each in shares) + " |")
