"""`python -m tests.benchmarks large`: what one inference call takes of a processor and of memory.

PA-One, 100 preferences, uniform cities, each size in a process of its own, whose memory at its
highest is what is told, Python and the network included. Ends with 1 where 5,000 cities take
1 GiB or more. What is stored is not measured again. Stores `results/large.json`.
"""

import argparse
import resource
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from service.actor import OnnxActor
from service.instance import Instance
from service.preferences import fan, from_angles
from tests.benchmarks.instances import check_tours
from tests.benchmarks.provenance import load
from tests.benchmarks.rows import TOURS, resume

ACTOR = Path("service/actors/pa-one.onnx")
SIZES = (40, 200, 1000, 2000, 5000, 10_000)
_MOST_MB = 1024.0  # at 5,000 cities


def main(arguments: list[str]) -> str | None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks large", description=__doc__)
    parser.add_argument("--cities", type=int, nargs="+", default=SIZES)
    options = parser.parse_args(arguments)
    digest = OnnxActor(ACTOR, threads=1).info.digest
    for n in options.cities:
        resume("large", f"{n} cities", digest, [n], _alone)
    largest = load("large").get("5000 cities")
    if largest and (peak := largest["instances"][0]["peak_mb"]) >= _MOST_MB:
        return f"5000 cities must take less than {_MOST_MB:g} MB, got {peak:g} MB"
    return None


def measured(n: int) -> dict[str, float]:
    """Seconds of the processor, and the most memory that the process has had."""
    actor = OnnxActor(ACTOR, threads=1)
    actor.load()
    instance = Instance(coordinates=np.random.default_rng(n).random((n, 4)))
    began = time.process_time()
    tours = actor.tours(instance, from_angles(fan(TOURS)))
    seconds = time.process_time() - began
    check_tours(tours, n)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024  # from KiB, on Linux
    return {"seconds": round(seconds, 3), "peak_mb": round(peak, 1)}


def _alone(n: int) -> dict[str, float]:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(measured, n).result()
