"""`python -m tests.benchmarks literature`: PA-One in the frame of the literature's networks.

Uniform cities in two unit squares, 101 directions, and for each size the reference point that is
used there. The instances are ours, for theirs are not at hand. The network alone, called
once and eight times, and with the search for a while: each gives at most 101 tours.
Seconds are those of the processor, on one thread. What is stored is not measured again. Stores
`results/literature.json`.
"""

import argparse
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from service.actor import OnnxActor
from service.instance import Instance
from service.planner import PlanOptions, plan
from service.preferences import fan
from service.search.improve import warm_up
from tests.benchmarks.beside import Nothing
from tests.benchmarks.printed import LITERATURE_CORNERS
from tests.benchmarks.rows import resume

ACTOR = Path("service/actors/pa-one.onnx")
COUNT = 200
TOURS = 101
# Calls of the network, and seconds of search after it.
ROWS = {
    "PA-One": (1, 0.0),
    "PA-One, 8 calls": (8, 0.0),
    "PA-One, 0.5 s of search": (1, 0.5),
}


def main(arguments: list[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser("python -m tests.benchmarks literature", description=__doc__)
    parser.add_argument("--rows", nargs="+", choices=ROWS, default=list(ROWS))
    parser.add_argument(
        "--cities", type=int, nargs="+", choices=LITERATURE_CORNERS, default=[*LITERATURE_CORNERS]
    )
    parser.add_argument("--count", type=int, default=COUNT, help="instances of each size")
    options = parser.parse_args(arguments)
    warm_up()
    actor = OnnxActor(ACTOR, threads=1)
    for n in options.cities:
        instances = [uniform(n, seed) for seed in range(options.count)]
        for row in options.rows:
            measure = partial(measured, actor, row)
            resume("literature", f"{n} cities: {row}", actor.info.digest, instances, measure)


def uniform(n: int, seed: int) -> Instance:
    """The instance of this size and number."""
    return Instance(coordinates=np.random.default_rng([n, seed]).random((n, 4)))


def measured(actor: OnnxActor, row: str, instance: Instance) -> dict[str, float]:
    """Hypervolume in per cent, and seconds of the processor."""
    corner = np.full(2, float(LITERATURE_CORNERS[instance.n]))
    demand = PlanOptions(angles=fan(TOURS), size=TOURS, reference_point=corner)
    augment, searched = ROWS[row]
    began = time.process_time()
    front = plan(actor, instance, replace(demand, augment=augment))
    if searched:  # for so long after the network
        more = replace(demand, time_limit=searched, initial_tours=front.tours)
        front = plan(Nothing(), instance, more)
    seconds = time.process_time() - began
    return {"hypervolume": round(100 * front.hypervolume, 4), "seconds": round(seconds, 4)}
