"""`python -m tests.benchmarks tri`: PA-One under three objectives, in the frame of the literature.

Uniform cities in three unit squares, the 105 weights of the lattice of 13 steps, and for each size
the reference point that is used there. The instances are ours, `public` measures theirs; so the
weighted sums stand beside the network, each nearly as short as it can be, by the search. The rows:
the network without repairs, with as many as the service makes by default, and with more; every tour
of a call counts, with those visited on the way; and the search for the whole front, from nothing,
within a number of seconds by the clock. Seconds are those of the processor, on one thread.
What is stored is not measured again. Stores `results/tri.json`.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from hashlib import sha256
from pathlib import Path

import moocore
import numpy as np
import torch
from numpy.typing import NDArray

from models.data.instances import tour_lengths
from models.data.preferences import fan_or_lattice
from models.expert import expert_tours
from service.construction.repairs import repairs_worth
from service.instance import Instance
from service.onnx_runtime import onnxruntime
from service.search.improve import improve
from service.search.warm_up import warm_up
from service.watch import Watch
from tests.benchmarks.printed import TRI_CORNERS
from tests.benchmarks.rows import resume

ACTOR = Path("service/actors/pa-one.onnx")
OBJECTIVES = 3
COUNT = 200
WEIGHTS = 105
MANY = 50  # repairs
ITERATIONS = 50  # of the search for each city and weight
SEARCHED = (0.3, 1.0, 3.0, 10.0)  # seconds

Array = NDArray[np.float32]
Tours = NDArray[np.int64]
Method = Callable[[onnxruntime.InferenceSession, Array, Array], Tours]


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks tri", description=__doc__)
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS))
    parser.add_argument(
        "--cities", type=int, nargs="+", choices=TRI_CORNERS, default=[*TRI_CORNERS]
    )
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    warm_up()
    session, of_network = opened()
    for n in options.cities:
        instances = [uniform(n, seed) for seed in range(options.count)]
        for row in options.rows:
            digest = "" if row == SUMS else of_network
            measure = partial(measured, session, ROWS[row])
            resume("tri", f"{n} cities: {row}", digest, instances, measure)


def uniform(n: int, seed: int) -> Array:
    """The cities, shape (n, 6), of the instance of this size and number."""
    return np.random.default_rng([n, seed]).random((n, 2 * OBJECTIVES), dtype=np.float32)


def measured(
    session: onnxruntime.InferenceSession, method: Method, cities: Array
) -> dict[str, float]:
    """Hypervolume in per cent, and seconds of the processor."""
    preferences = fan_or_lattice(WEIGHTS, OBJECTIVES, torch.device("cpu")).numpy()
    began = time.process_time()
    tours = method(session, cities, preferences)
    seconds = time.process_time() - began
    assert (np.sort(tours, axis=1) == np.arange(len(cities))).all()
    instance = torch.from_numpy(cities[np.newaxis].astype(np.float64))
    points = tour_lengths(instance, torch.from_numpy(tours[np.newaxis]))[0].numpy()
    corner = np.full(OBJECTIVES, float(TRI_CORNERS[len(cities)]))
    share = moocore.hypervolume(points, ref=corner) / corner.prod()
    return {"hypervolume": round(100 * share, 4), "seconds": round(seconds, 4)}


def _built(
    repairs: Callable[[int], int],
    session: onnxruntime.InferenceSession,
    cities: Array,
    preferences: Array,
) -> Tours:
    given = {"cities": cities, "preferences": preferences}
    given["repairs"] = np.array(repairs(len(cities)), dtype=np.int64)
    tours: Tours = np.concatenate(session.run(["tours", "visited"], given))
    return tours


def _searched(_: onnxruntime.InferenceSession, cities: Array, preferences: Array) -> Tours:
    doubles = (each.astype(np.float64) for each in (cities, preferences))
    return expert_tours(*doubles, iterations=ITERATIONS * len(cities), seed=0).astype(np.int64)


def _whole_front(
    seconds: float, _: onnxruntime.InferenceSession, cities: Array, preferences: Array
) -> Tours:
    instance = Instance(coordinates=cities.astype(np.float64))
    corner = np.full(preferences.shape[1], float(TRI_CORNERS[len(cities)]))
    nothing = np.empty((0, len(cities)), np.int32)
    found = improve(instance, nothing, watch=Watch(seconds), reference_point=corner)
    return found.tours.astype(np.int64)


def opened() -> tuple[onnxruntime.InferenceSession, str]:
    """A session of the network on one thread, and the digest of its file."""
    content = ACTOR.read_bytes()
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    options.enable_mem_pattern = False  # as the service has it
    session = onnxruntime.InferenceSession(content, options, providers=["CPUExecutionProvider"])
    return session, sha256(content).hexdigest()


SUMS = "weighted sums by the search"
ROWS: dict[str, Method] = {
    "PA-One": partial(_built, lambda _: 0),
    "PA-One, repaired": partial(
        _built, partial(repairs_worth, "coordinates", objectives=OBJECTIVES)
    ),
    f"PA-One, {MANY} repairs": partial(_built, lambda _: MANY),
    SUMS: _searched,
    **{f"search, {each:g} s": partial(_whole_front, each) for each in SEARCHED},
}
