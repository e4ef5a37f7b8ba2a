"""`python -m tests.benchmarks literature`: PA-One in the frame of the literature's networks.

Uniform cities in two unit squares, 101 directions, and for each size the reference point that is
used there. The instances are ours; `public` measures theirs. The rows: the network alone, without
repairs, with as many as the service makes by default, and with as many as gain; with the search for
a while after it; and at equal time the network with the repairs that fit, and the search from
nothing. Each gives at most 101 tours. Seconds are those of the processor, on one thread. What is
stored is not measured again. Stores `results/literature.json`.
"""

import argparse
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from service.actor import OnnxActor
from service.construction.repairs import repairs_worth
from service.front import Front, PlanOptions
from service.instance import Instance
from service.planner import plan
from service.preferences import spread
from service.search.warm_up import warm_up
from tests.benchmarks.beside import Nothing
from tests.benchmarks.printed import LITERATURE_CORNERS
from tests.benchmarks.rows import resume

ACTOR = Path("service/actors/pa-one.onnx")
COUNT = 200
TOURS = 101
MANY = 200  # repairs: the most that a request may ask for
MORE, MORE_AT = 800, 100  # repairs that still gain, at this number of cities
# By seconds and number of cities, the repairs with which a call takes so long on one core of a
# 2.5 GHz Xeon. Where a size is missing, a call without repairs takes longer.
REPAIRS = {
    0.02: {20: 1},
    0.05: {20: 4, 50: 1},
    0.1: {20: 10, 50: 5, 100: 0},
    0.3: {20: 32, 50: 22, 100: 13, 150: 9, 200: 4},
}

Method = Callable[[OnnxActor, Instance, PlanOptions], Front]


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
    actor.load()
    for n in options.cities:
        instances = [uniform(n, seed) for seed in range(options.count)]
        for row in (row for row in options.rows if n in SIZES.get(row, [n])):
            measure = partial(measured, actor, ROWS[row])
            resume("literature", f"{n} cities: {row}", actor.info.digest, instances, measure)


def uniform(n: int, seed: int) -> Instance:
    """The instance of this size and number."""
    return Instance(coordinates=np.random.default_rng([n, seed]).random((n, 4)))


def measured(actor: OnnxActor, method: Method, instance: Instance) -> dict[str, float]:
    """Hypervolume in per cent, and seconds of the processor."""
    corner = np.full(2, float(LITERATURE_CORNERS[instance.n]))
    demand = PlanOptions(directions=spread(TOURS), size=TOURS, reference_point=corner)
    began = time.process_time()
    front = method(actor, instance, demand)
    seconds = time.process_time() - began
    return {"hypervolume": round(100 * front.hypervolume, 4), "seconds": round(seconds, 4)}


def _built(repairs: int, actor: OnnxActor, instance: Instance, demand: PlanOptions) -> Front:
    return plan(actor, instance, replace(demand, repairs=repairs))


def _repaired(actor: OnnxActor, instance: Instance, demand: PlanOptions) -> Front:
    return _built(
        repairs_worth("coordinates", instance.n, instance.objectives), actor, instance, demand
    )


def _within(seconds: float, actor: OnnxActor, instance: Instance, demand: PlanOptions) -> Front:
    return _built(REPAIRS[seconds][instance.n], actor, instance, demand)


def _improved(seconds: float, actor: OnnxActor, instance: Instance, demand: PlanOptions) -> Front:
    """Return the front after some seconds of search, which follow the network."""
    first = plan(actor, instance, demand).tours
    return _searched(seconds, actor, instance, replace(demand, initial_tours=first))


def _searched(seconds: float, _: OnnxActor, instance: Instance, demand: PlanOptions) -> Front:
    return plan(Nothing(), instance, replace(demand, time_limit=seconds))


ROWS: dict[str, Method] = {
    "PA-One": partial(_built, 0),
    "PA-One, repaired": _repaired,
    f"PA-One, {MANY} repairs": partial(_built, MANY),
    f"PA-One, {MORE} repairs": partial(_built, MORE),
    "PA-One, 0.5 s of search": partial(_improved, 0.5),
}
for _seconds in REPAIRS:
    ROWS[f"PA-One, repairs for {_seconds} s"] = partial(_within, _seconds)
    ROWS[f"search from nothing, {_seconds} s"] = partial(_searched, _seconds)
SIZES = {f"PA-One, {MORE} repairs": [MORE_AT]} | {
    f"PA-One, repairs for {seconds} s": list(sizes) for seconds, sizes in REPAIRS.items()
}
