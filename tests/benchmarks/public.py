"""`python -m tests.benchmarks public --data FOLDER`: PA-One on the public sets of the literature.

Each set has 200 uniform instances. Printed networks and weighted sums by LKH are measured on the
same ones. The folder holds `testdata_tsp_size20.pt` and so on, under three objectives
`testdata_tsp_3o_size20.pt` and so on, as in the code of Chen et al. (2023), Neural multi-objective
combinatorial optimization with diversity enhancement. The rows: the network without repairs, and
with as many as the service makes by default. Under two objectives the best 101 tours of a call
count, for 101 directions; under three all of them. Seconds are those of the processor, on one
thread. What is stored is not measured again. Stores `results/public.json`.
"""

import argparse
from functools import partial
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from service.actor import OnnxActor
from service.instance import Instance
from tests.benchmarks import literature, tri
from tests.benchmarks.printed import LITERATURE_CORNERS, TRI_CORNERS
from tests.benchmarks.rows import resume

ROWS = ("PA-One", "PA-One, repaired")


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks public", description=__doc__)
    parser.add_argument("--data", type=Path, required=True, help="holds the .pt files")
    parser.add_argument("--objectives", type=int, nargs="+", choices=(2, 3), default=[2, 3])
    parser.add_argument(
        "--cities", type=int, nargs="+", choices=LITERATURE_CORNERS, default=[*LITERATURE_CORNERS]
    )
    parser.add_argument("--count", type=int, default=200, help="instances of each size")
    options = parser.parse_args(arguments)
    measure = {2: _two, 3: _three}
    for objectives in options.objectives:
        for n in options.cities:
            if objectives == 2 or n in TRI_CORNERS:
                measure[objectives](options.data, n, options.count)


def _two(folder: Path, n: int, count: int) -> None:
    actor = OnnxActor(literature.ACTOR, threads=1)
    actor.load()
    given = _read(folder / f"testdata_tsp_size{n}.pt")[:count].astype(np.float64)
    instances = [Instance(coordinates=cities) for cities in given]
    for row in ROWS:
        measure = partial(literature.measured, actor, literature.ROWS[row])
        resume("public", f"2 objectives, {n} cities: {row}", actor.info.digest, instances, measure)


def _three(folder: Path, n: int, count: int) -> None:
    session, digest = tri.opened()
    instances = list(_read(folder / f"testdata_tsp_3o_size{n}.pt")[:count])
    for row in ROWS:
        measure = partial(tri.measured, session, tri.ROWS[row])
        resume("public", f"3 objectives, {n} cities: {row}", digest, instances, measure)


def _read(file: Path) -> NDArray[np.float32]:
    """The cities, shape (instances, n, 2m)."""
    cities: NDArray[np.float32] = torch.load(file, weights_only=True).numpy()
    return cities
