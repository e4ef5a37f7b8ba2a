"""`python -m tests.benchmarks kro --data FOLDER`: kroA100 with kroB100, in the front's own box.

Both files are TSPLIB's, in a folder of the user's; distances are rounded to whole numbers as
TSPLIB says, and given as two matrices. The search runs without a network and with its default
reference point, on one thread. The best known front is what three seeds find until they converge,
merged. From its ideal point to its nadir, the corner that its own extremes span, is the box whose
hypervolume is measured: the reference point is that nadir, and a gap is the share of the best
known front's hypervolume that a front lacks. Prints a table and stores `results/kro.json`.
"""

import argparse
import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tqdm import tqdm

from service.front import SearchResult
from service.instance import Instance
from service.pareto import hypervolume, nondominated
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.provenance import provenance, store

Array = NDArray[np.float64]

NAMES = ("kroA100", "kroB100")
LIMITS = (0.1, 0.5, 1.0, 2.0, 5.0, None)  # seconds; None until the search converges
SEEDS = 3


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks kro", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="holds both .tsp files")
    options = parser.parse_args(arguments)
    planes = [rounded_distances(options.data / f"{name}.tsp") for name in NAMES]
    instance = Instance(matrices=np.stack(planes))
    warm_up()
    runs = [
        {"limit": limit, "seed": seed, **_run(instance, limit, seed)}
        for limit in tqdm(LIMITS, leave=False)
        for seed in range(SEEDS)
    ]
    box = _measure(runs)
    store("kro", {**provenance(1), **box, "runs": runs})
    _print_table(box, runs)


def rounded_distances(path: Path) -> Array:
    """Distances, shape (n, n), of a TSPLIB file of kind EUC_2D: Euclidean, to the nearest whole."""
    lines = [line.strip() for line in path.read_text(encoding="utf-8").splitlines()]
    if "EDGE_WEIGHT_TYPE:EUC_2D" not in {line.replace(" ", "") for line in lines}:
        raise ValueError(f"{path} must be of kind EUC_2D")
    first = lines.index("NODE_COORD_SECTION") + 1
    rows = [line.split() for line in lines[first:] if line[:1].isdigit()]
    coordinates = np.array([row[1:3] for row in rows], float)
    steps = coordinates[:, None] - coordinates
    return np.floor(np.hypot(steps[..., 0], steps[..., 1]) + 0.5)


def _run(instance: Instance, limit: float | None, seed: int) -> dict[str, Any]:
    began = time.monotonic()
    watch = Watch[SearchResult](np.inf if limit is None else limit)
    found = improve(instance, np.empty((0, instance.n), np.int32), watch=watch, seed=seed)
    seconds = time.monotonic() - began
    return {"seconds": round(seconds, 3), "points": len(found.points), "front": found.points}


def _measure(runs: list[dict[str, Any]]) -> dict[str, Any]:
    """Turns the fronts of runs into gaps to the best known front; describes that front's box."""
    points = np.concatenate([run["front"] for run in runs if run["limit"] is None])
    front = points[nondominated(points)]
    ideal, nadir = front.min(axis=0), front.max(axis=0)
    best = hypervolume(front - ideal, nadir - ideal)
    for run in runs:
        share = hypervolume(run.pop("front") - ideal, nadir - ideal)
        run["gap"] = 100 * (1 - share / best)
    return {"ideal": ideal.tolist(), "nadir": nadir.tolist(), "points": len(front), "share": best}


def _print_table(box: dict[str, Any], runs: list[dict[str, Any]]) -> None:
    print(f"Best known front: {box['points']} points, reference point (its nadir) {box['nadir']},")
    print(f"ideal {box['ideal']}; it dominates {100 * box['share']:.3f} % of the box between them.")
    print("| limit | seconds | points | gap, %, mean | gap, %, worst |")
    print("|---|---|---|---|---|")
    for limit in LIMITS:
        rows = [run for run in runs if run["limit"] == limit]
        seconds, points = (np.mean([row[key] for row in rows]) for key in ("seconds", "points"))
        gaps = [row["gap"] for row in rows]
        title = "until it converges" if limit is None else f"{limit} s"
        cells = f"{seconds:.2f} | {points:.0f} | {np.mean(gaps):.4f} | {max(gaps):.4f}"
        print(f"| {title} | {cells} |")
