"""`python -m tests.benchmarks actors [NAME ...]`: actors on the paper's instances.

By default the released ones; with `--own FOLDER` actors of that folder may be named as well.

For each: one inference call with 100 preferences an instance, the network alone and greedy; and
where it can, the best 100 of the tours of a call with as many repairs as the service makes by
default. The plain construction heuristics stand beside them, with 100 weights. Seconds are those of
the processor, of all threads. Prints a table and stores `results/actors.json`.
"""

import argparse
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.actor import OnnxActor
from service.construction.repairs import repairs_worth
from service.front import PlanOptions
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume
from service.planner import plan
from service.preferences import fan, from_angles
from service.search.warm_up import warm_up
from tests.benchmarks.instances import COUNT, SIZES, check_tours, paper_instances, reference_points
from tests.benchmarks.provenance import provenance, store
from tests.benchmarks.rivals.construction import greedy_edge, nearest_neighbour, spread_weights

ACTORS = Path("service/actors")
PREFERENCES = 100

HEURISTICS = {"nearest neighbour": nearest_neighbour, "greedy edge": greedy_edge}

Build = Callable[[Instance], NDArray[np.integer]]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks actors", description=__doc__)
    parser.add_argument("names", nargs="*", help="default: every released actor")
    parser.add_argument("--own", type=Path, help="folder with further ONNX files")
    parser.add_argument(
        "--cities", dest="sizes", type=int, nargs="+", choices=SIZES, default=list(SIZES)
    )
    parser.add_argument("--threads", type=int, default=2, help="of the inference session")
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    warm_up()
    names = options.names or sorted(path.stem for path in ACTORS.glob("*.onnx"))
    rows: dict[str, dict[str, Any]] = {}
    row_of = partial(_row, sizes=options.sizes, count=options.count)
    for name in names:
        actor = OnnxActor(_file_of(name, options.own), options.threads)
        rows |= {
            row: {"digest": actor.info.digest, **row_of(build)}
            for row, build in _builders(actor).items()
        }
    for name, construct in HEURISTICS.items():
        rows[name] = row_of(partial(construct, weights=spread_weights(PREFERENCES)))
    store("actors", {**provenance(options.threads), "preferences": PREFERENCES, "rows": rows})
    _print_table(rows, options.sizes)


def _file_of(name: str, own: Path | None) -> Path:
    """Return the file of an actor, a released one or one of the folder."""
    files = [folder / f"{name}.onnx" for folder in (ACTORS, own) if folder is not None]
    found = [path for path in files if path.exists()]
    if not found:
        sys.exit(f"there must be a file of {name}: {' or '.join(map(str, files))}")
    return found[0]


def measure(build: Build, n: int, count: int) -> dict[str, Any]:
    """Hypervolume in per cent by reference point, and seconds an instance: mean and deviation."""
    seconds: list[float] = []
    shares: dict[str, list[float]] = {name: [] for name in reference_points(n)}
    instances = [Instance(coordinates=cities) for cities in paper_instances(n, count)]
    build(instances[0])  # compiles, and fills caches
    for instance in tqdm(instances, desc=f"{n} cities", leave=False):
        began = time.process_time()
        tours = build(instance)
        seconds.append(time.process_time() - began)
        check_tours(tours, n)
        points = tour_lengths(instance, tours)
        for name, reference_point in reference_points(n).items():
            shares[name].append(100 * hypervolume(points, reference_point))
    return {
        "instances": count,
        "hypervolume": {name: _summary(values) for name, values in shares.items()},
        "seconds": _summary(seconds),
    }


def _builders(actor: OnnxActor) -> dict[str, Build]:
    """Return the rows of an actor: alone, and where it can repair, with its default repairs."""
    preferences = from_angles(fan(PREFERENCES))
    name = actor.info.name
    builders: dict[str, Build] = {name: lambda instance: actor.tours(instance, preferences)}
    if actor.info.repairs:
        builders[f"{name}, repaired"] = partial(_repaired, actor)
    return builders


def _repaired(actor: OnnxActor, instance: Instance) -> NDArray[np.integer]:
    angles = fan(PREFERENCES)
    repairs = repairs_worth(actor.info.inputs, instance.n, instance.objectives)
    return plan(
        actor,
        instance,
        PlanOptions(directions=from_angles(angles), size=len(angles), repairs=repairs),
    ).tours


def _row(build: Build, sizes: list[int], count: int) -> dict[str, Any]:
    return {str(n): measure(build, n, count) for n in sizes}


def _summary(values: list[float]) -> dict[str, float]:
    return {"mean": round(float(np.mean(values)), 4), "deviation": round(float(np.std(values)), 4)}


def _print_table(rows: dict[str, dict[str, Any]], sizes: list[int]) -> None:
    columns = [(n, name) for n in sizes for name in reference_points(n)]
    print("| | " + " | ".join(f"{n} cities, {name}" for n, name in columns) + " |")
    print("|---" * (len(columns) + 1) + "|")
    for row_name, row in rows.items():
        cells = []
        for n, name in columns:
            share, seconds = row[str(n)]["hypervolume"][name], row[str(n)]["seconds"]
            cells.append(
                f"{share['mean']:.2f} ± {share['deviation']:.2f} % in {seconds['mean']:.3f} s"
            )
        print(f"| {row_name} | " + " | ".join(cells) + " |")
