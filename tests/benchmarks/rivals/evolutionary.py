"""NSGA-II, NSGA-III and MOEA/D by pymoo, over permutations: evolutionary rivals.

The settings are the best of a short trial at 40 and 200 cities: order crossover, as edge
recombination takes so much longer that it wins for equal evaluations and loses for equal time;
a stretch of every offspring reversed; and weighted sums for MOEA/D, ahead of Tchebycheff's by
seven points at 40 cities.
"""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymoo.algorithms.moo.moead import MOEAD
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.algorithms.moo.nsga3 import NSGA3
from pymoo.core.algorithm import Algorithm
from pymoo.core.callback import Callback
from pymoo.core.problem import Problem
from pymoo.decomposition.weighted_sum import WeightedSum
from pymoo.operators.crossover.ox import OrderCrossover
from pymoo.operators.mutation.inversion import InversionMutation
from pymoo.operators.sampling.rnd import PermutationRandomSampling
from pymoo.optimize import minimize
from pymoo.termination.max_time import TimeBasedTermination

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.preferences import spread
from tests.benchmarks.rivals.construction import spread_weights

Array = NDArray[np.float64]
Snapshots = list[tuple[float, Array]]

MEMBERS = 105  # of a population under more than two objectives
APART = 1.05  # a snapshot is taken when this many times as long has passed as at the last


def nsga2(instance: Instance, population: int, evaluations: int, seed: int = 0) -> Snapshots:
    """The fronts after more and more processor seconds, until enough tours were evaluated."""
    algorithm = NSGA2(pop_size=population, **_operators())
    return _snapshots(instance, algorithm, evaluations, seed)


def moead(instance: Instance, population: int, evaluations: int, seed: int = 0) -> Snapshots:
    """As `nsga2`; each member of the population stands for one of as many weights."""
    return _snapshots(instance, _moead(spread_weights(population)), evaluations, seed)


def nsga3(instance: Instance, seconds: float) -> Array:
    """The front after these seconds, of any number of objectives; 105 directions and members."""
    algorithm = NSGA3(ref_dirs=spread(MEMBERS, len(instance.scale)), **_operators())
    return _after(instance, algorithm, seconds)


def moead_for(instance: Instance, seconds: float) -> Array:
    """As `nsga3`, by MOEA/D under as many weights."""
    directions = spread(MEMBERS, len(instance.scale))
    weights = directions / directions.sum(axis=1, keepdims=True)
    return _after(instance, _moead(weights), seconds)


def _moead(weights: Array) -> Algorithm:
    return MOEAD(
        ref_dirs=weights,
        n_neighbors=min(20, len(weights)),
        decomposition=WeightedSum(),
        **_operators(),
    )


def _operators() -> dict[str, Any]:
    return {
        "sampling": PermutationRandomSampling(),
        "crossover": OrderCrossover(),
        "mutation": InversionMutation(),
    }


def _after(instance: Instance, algorithm: Algorithm, seconds: float) -> Array:
    watch = _Watch()
    ends = TimeBasedTermination(max_time=seconds)
    minimize(_Tours(instance), algorithm, ends, callback=watch, seed=0)
    points: Array = watch.snapshots[-1][1] * instance.scale
    return points


def _snapshots(instance: Instance, algorithm: Algorithm, evaluations: int, seed: int) -> Snapshots:
    watch = _Watch()
    minimize(_Tours(instance), algorithm, ("n_eval", evaluations), callback=watch, seed=seed)
    return [(seconds, points * instance.scale) for seconds, points in watch.snapshots]


class _Tours(Problem):
    """An instance as pymoo sees it; its objectives are scaled, as weighted sums need it."""

    def __init__(self, instance: Instance) -> None:
        super().__init__(
            n_var=instance.n, n_obj=len(instance.scale), xl=0, xu=instance.n - 1, vtype=int
        )
        self.instance = instance

    def _evaluate(self, x: NDArray[np.int64], out: dict[str, Array], *_: object, **__: object):
        out["F"] = tour_lengths(self.instance, x) / self.instance.scale


class _Watch(Callback):
    """Keeps what the populations found, also what they lost again, which only helps the rival."""

    def __init__(self) -> None:
        super().__init__()
        self.snapshots: Snapshots = []
        self.front: Array | None = None
        self.began = self.due = time.process_time()

    def notify(self, algorithm: Algorithm) -> None:
        now = time.process_time()
        if now < self.due and algorithm.has_next():
            return
        found = algorithm.pop.get("F")
        points = found if self.front is None else np.concatenate((self.front, found))
        self.front = points[nondominated(points)]
        self.snapshots.append((now - self.began, self.front))
        self.due = self.began + APART * (now - self.began)
