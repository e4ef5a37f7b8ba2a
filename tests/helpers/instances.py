"""Instances and tours drawn at random, all tours there are, and one weighted sum."""

from dataclasses import replace
from functools import cache
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance
from service.search.archive.layout import make_archive
from service.search.candidates import Scalarization
from service.search.candidates import weighted_cost as weighted_cost_kernel
from service.search.costs import make_costs
from service.search.open_routes import moved_ends
from service.search.state import SearchState, WeightedCandidates
from service.search.working_tour import make_working_tour
from tests.helpers.kernels import for_python

weighted_cost = for_python(weighted_cost_kernel)

KINDS = ("coordinates", "symmetric", "asymmetric")
ENDS = ("no", "start", "end", "both")  # which ends of an open route are fixed


def small_integers(kind: str, n: int, seed: int, objectives: int = 2) -> Instance:
    """An instance of small whole numbers, so that ties and coincident cities are common."""
    rng = np.random.default_rng(seed)
    if kind == "coordinates":
        return Instance(coordinates=rng.integers(0, 6, (n, 2 * objectives)).astype(float))
    matrices = rng.integers(0, 9, (objectives, n, n)).astype(float)
    if kind == "symmetric":
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


def uniform(n: int, seed: int = 0, objectives: int = 2) -> Instance:
    """Coordinates drawn uniformly from the unit squares."""
    return Instance(coordinates=np.random.default_rng(seed).random((n, 2 * objectives)))


def random_matrices(n: int, seed: int, symmetric: bool, objectives: int = 2) -> Instance:
    """Matrices of uniform costs."""
    matrices = np.random.default_rng(seed).random((objectives, n, n))
    if symmetric:
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


@cache
def all_tours(n: int) -> NDArray[np.int32]:
    """Every closed tour of n cities, from city 0 on, shape ((n - 1)!, n)."""
    tours = np.array([(0, *rest) for rest in permutations(range(1, n))], np.int32)
    tours.setflags(write=False)
    return tours


def every_tour(instance: Instance) -> NDArray[np.int32]:
    """Every tour of an instance: closed ones, or orders of its cities with its ends."""
    n = instance.n
    if instance.closed:
        return all_tours(n)
    orders = all_tours(n + 1)[:, 1:] - 1
    first = instance.start is None or orders[:, 0] == instance.start
    last = instance.end is None or orders[:, -1] == instance.end
    return orders[first & last & np.ones(len(orders), bool)]


def opened(instance: Instance, ends: str, seed: int = 0) -> Instance:
    """The instance for open routes with `no`, a `start`, an `end` or `both` fixed."""
    start, end = np.random.default_rng(seed).permutation(instance.n)[:2].tolist()
    return replace(
        instance,
        closed=False,
        start=start if ends in ("start", "both") else None,
        end=end if ends in ("end", "both") else None,
    )


def random_routes(instance: Instance, m: int, seed: int = 0) -> NDArray[np.int64]:
    """Tours of an instance drawn uniformly, shape (m, n), between its ends."""
    return moved_ends(instance, random_tours(instance.n, m, seed))


def random_tours(n: int, m: int, seed: int = 0) -> NDArray[np.int64]:
    """Tours drawn uniformly, shape (m, n)."""
    rng = np.random.default_rng(seed)
    return np.array([rng.permutation(n) for _ in range(m)], np.int64).reshape(m, n)


def no_tours(n: int) -> NDArray[np.int32]:
    """Tours of n cities, shape (0, n)."""
    return np.empty((0, n), np.int32)


def scalarization_of(instance: Instance) -> Scalarization:
    """The sum of both objectives under equal weights, with eight candidates a city."""
    costs = make_costs(instance)
    n = len(costs.cities)
    sums = costs.matrix.sum(axis=2) + np.diag(np.full(n, np.inf))
    if not instance.closed:  # nobody goes to the invented city
        sums[0], sums[:, 0] = np.inf, np.inf
    candidates = np.argsort(sums, axis=1)[:, : min(8, n - 1)]
    candidate_costs = np.take_along_axis(sums, candidates, axis=1) / 2
    return Scalarization(
        costs, np.ascontiguousarray(candidates, np.int32), candidate_costs, 0.5, 0.5
    )


def state_of(scalarization: Scalarization, seed: int) -> SearchState:
    """The state of a search under one weighted sum of two objectives, without a tour."""
    costs, candidates, candidate_costs, w0, w1 = scalarization
    n = len(costs.cities)
    return SearchState(
        costs,
        WeightedCandidates(np.array([[w0, w1]]), candidates[None], candidate_costs[None]),
        make_archive(n, 2),
        make_working_tour(n),
        np.array([seed]),
    )


def weighted_length(scalarization: Scalarization, tour: NDArray[np.integer]) -> float:
    """The length of a closed tour under one weighted sum, step by step."""
    steps = zip(tour, np.roll(tour, -1), strict=True)
    return sum(weighted_cost(scalarization, i, j) for i, j in steps)


def steps_of(tour: NDArray[np.integer]) -> set[frozenset[int]]:
    """The steps of a closed tour, in either direction."""
    steps = zip(tour.tolist(), np.roll(tour, -1).tolist(), strict=True)
    return {frozenset(step) for step in steps}
