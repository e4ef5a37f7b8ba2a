"""The ways to a front of the paper's main table, and those that it left out, by their rows.

Each gives the points of at most 100 tours, on one thread; an evolutionary rival those of its
front. Networks are the released ONNX files; DRL-MOA's come from the checkpoint of
`models.drl_moa`. What is not there has no row.
"""

from collections.abc import Callable
from functools import partial
from hashlib import sha256
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from models.drl_moa import load_actors
from models.networks.pointer_network import build_tours
from service.actor import OnnxActor
from service.instance import Instance, tour_lengths
from service.preferences import fan, from_angles
from tests.benchmarks.instances import check_tours
from tests.benchmarks.rivals import ortools_routing
from tests.benchmarks.rivals.construction import (
    distances,
    greedy_edge,
    nearest_neighbour,
    spread_weights,
)
from tests.benchmarks.rivals.evolutionary import moead, nsga2
from tests.benchmarks.rows import TOURS, Method, Points

Tours = NDArray[np.integer]

ACTORS = Path("service/actors")
DRL_MOA = Path("models/checkpoints/drl-moa.pt")
POPULATION = 100
EVALUATIONS = {"20K": 20_000, "80K": 80_000}
SOLUTION_LIMITS = {"no limit": None, "n_l = 10": 10, "n_l = 100": 100}
NETWORKS = {"PA-EAN": "pa-ean", "PA-AT": "pa-at", "PA-One": "pa-one"}


def methods() -> dict[str, Method]:
    """By row, in the order of the table."""
    rows = {
        f"{name} ({size})": Method(partial(_evolved, evolve, evaluations))
        for name, evolve in (("NSGA-II", nsga2), ("MOEA/D", moead))
        for size, evaluations in EVALUATIONS.items()
    }
    rows |= _networks()
    for name, limit in SOLUTION_LIMITS.items():
        rows[f"OR-Tools ({name})"] = Method(partial(_built, partial(_ortools, limit)))
    for name, construct in (("Nearest neighbour", nearest_neighbour), ("Greedy edge", greedy_edge)):
        weighted = partial(construct, weights=spread_weights(TOURS))
        rows[name] = Method(partial(_built, weighted), True)
    return rows


def _networks() -> dict[str, Method]:
    rows = {}
    if DRL_MOA.exists():
        digest = sha256(DRL_MOA.read_bytes()).hexdigest()
        rows["DRL-MOA"] = Method(partial(_built, drl_moa(DRL_MOA)), True, digest)
    for row, name in NETWORKS.items():
        if (ACTORS / f"{name}.onnx").exists():
            actor = OnnxActor(ACTORS / f"{name}.onnx", threads=1)
            actor.load()
            build = partial(actor.tours, preferences=from_angles(fan(TOURS)))
            rows[row] = Method(partial(_built, build), True, actor.info.digest)
    return rows


def drl_moa(path: Path) -> Callable[[Instance], Tours]:
    """Builds one tour an instance with each of the networks in the checkpoint."""
    actors = load_actors(path)

    def build(instance: Instance) -> Tours:
        torch.set_num_threads(1)
        cities = torch.from_numpy(instance.scaled_coordinates).float()[None]
        return torch.cat([build_tours(actor, cities) for actor in actors]).numpy()

    return build


def _built(build: Callable[[Instance], Tours], instance: Instance) -> Points:
    tours = build(instance)
    check_tours(tours, instance.n)
    return tour_lengths(instance, tours)


def _ortools(limit: int | None, instance: Instance) -> Tours:
    first, second = distances(instance.scaled_coordinates)
    return np.array(
        [ortools_routing.solve(w * first + v * second, limit) for w, v in spread_weights(TOURS)]
    )


def _evolved(
    evolve: Callable[..., list[tuple[float, Points]]], evaluations: int, instance: Instance
) -> Points:
    return evolve(instance, population=POPULATION, evaluations=evaluations)[-1][1]
