"""Compile the search, or load it from the cache: by searches of a few cities that use all of it.

Two processes compile a part side by side, and load what the other one has compiled before. So each
part has two pieces, which take about as long and begin with what they do not share.
"""

from itertools import islice

import numpy as np

from service.instance import Instance
from service.search import candidates
from service.search.archive.insertion import insert
from service.search.archive.layout import make_archive
from service.search.archive.sorted_points import dominated_area
from service.search.best_subset import best_subset
from service.search.bound.hypervolume import hypervolume_bound
from service.search.candidates import Scalarization, rank_candidates
from service.search.costs import lengths
from service.search.edge_assembly.assembly import assemble
from service.search.enumeration import exact_tours
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.improve import improve
from service.search.local_search import least_gain, offer, sum_afresh
from service.search.pareto_local_search import fill_gaps
from service.search.schedule import Search
from service.search.starts.constructed_tour import constructed_tour
from service.search.three_opt.choice import LocalSearch, ThreeOptSearch
from service.search.three_opt.undoable_tour import make_undoable_tour
from service.search.weights import WEIGHTS
from service.search.working_tour import enqueue_cities

_N = 12  # cities: one too many to enumerate at once
_TOUR = np.arange(_N, dtype=np.int32)


def warm_up() -> None:
    """Compile the whole search."""
    for compile_part in (
        few_cities,
        fewest_cities,
        more_cities,
        several_objectives,
        many_cities,
        bounds,
    ):
        compile_part()


def few_cities() -> None:
    """Compile what a few hundred cities need whose costs are the same both ways."""
    two_opt()
    beside_two_opt()
    improve(_instance(coordinates=True), _TOUR[np.newaxis], iterations=5_000)


def two_opt() -> None:
    """Compile the local search by two-opt, and that from points of the front."""
    search = _search(_instance(coordinates=True))
    # This compiles iteration too: by two-opt, descent and iteration are one compiled function.
    search.local_search.descend(search.descents.scalarization(0), 0)
    fill_gaps(search.state, search.common, 0)


def beside_two_opt() -> None:
    """Compile what a search by two-opt needs besides."""
    insert(make_archive(_N, 3), np.ones(3), _TOUR)  # which the other piece needs too, but later
    instance = _instance(coordinates=True)
    points = np.array([[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]])
    best_subset(FrontPoints(points, np.full(2, 4.0)), 2)
    search = _search(instance)
    for _ in search.pool_candidates():
        pass
    for number in range(WEIGHTS):
        scalarization = search.descents.scalarization(number)
        rank_candidates(search.pool, scalarization)
    search.add(_TOUR[np.newaxis])
    search.not_covered(_TOUR[np.newaxis])
    search.descents.load_best(0, scalarization, search.local_search)
    _offer(search, search.local_search, scalarization)
    dominated_area(search.state.archive, search.corner)
    constructed_tour(instance, scalarization, greedy=False)


def fewest_cities() -> None:
    """Compile the enumeration of tours."""
    exact_tours(_instance(coordinates=True, n=5))


def more_cities() -> None:
    """Compile what hundreds of cities need, and costs that differ by direction."""
    three_opt()
    beside_three_opt()
    matrices = _instance(coordinates=False)
    improve(matrices, _TOUR[np.newaxis], iterations=5_000)
    _step_through_three_opt(_instance(coordinates=True))


def three_opt() -> None:
    """Compile the local search by three-opt."""
    search = _search(_instance(coordinates=True))
    local_search, scalarization = _three_opt(search), search.descents.scalarization(0)
    local_search.descend(scalarization, 0)
    local_search.iterate(scalarization, 0)


def beside_three_opt() -> None:
    """Compile the assembly of tours."""
    search = _search(_instance(coordinates=True))
    tour, scalarization = _TOUR.copy(), search.descents.scalarization(WEIGHTS // 2)
    _rank_candidates(scalarization)
    assemble((tour, tour.copy(), tour[::-1].copy()), scalarization, 0.0, search.state.random)
    local_search = _three_opt(search)
    _offer(search, local_search, scalarization)
    enqueue_cities(local_search.working, _TOUR)
    least_gain(scalarization, 1.0)


def many_cities() -> None:
    """Compile what finds the candidates and the first tour of many cities."""
    instance = _instance(coordinates=True)
    candidates.warm_up(instance)
    search = _search(instance)
    constructed_tour(instance, search.descents.scalarization(WEIGHTS // 2), greedy=True)


def several_objectives() -> None:
    """Compile what three and four objectives need besides."""
    for objectives in (3, 4):
        instance = _instance(coordinates=True, objectives=objectives)
        improve(instance, _TOUR[np.newaxis], iterations=3_000, capacity=16)
        front = FrontPoints.among(np.eye(objectives), np.full(objectives, 2.0))[1]
        best_subset(front, 2)
        hypervolume(front.points, front.reference_point)


def bounds() -> None:
    """Compile the bounds on the hypervolume."""
    for coordinates in (True, False):
        instance = _instance(coordinates=coordinates)
        hypervolume_bound(instance, instance.reference_point)


def _search(instance: Instance) -> Search:
    return Search(instance, 0, instance.reference_point)


def _three_opt(search: Search) -> ThreeOptSearch:
    return ThreeOptSearch(search.state, make_undoable_tour(search.n), every=1)


def _offer(search: Search, local_search: LocalSearch, scalarization: Scalarization) -> None:
    """Offer a local optimum to the archive."""
    local_search.load(_TOUR, *lengths(scalarization.costs, _TOUR))
    sum_afresh(local_search.working, scalarization)
    offer(search.state, local_search.working)


def _rank_candidates(scalarization: Scalarization) -> None:
    """Rank candidates without compiled code, which the other piece compiles meanwhile."""
    costs = scalarization.costs.matrix @ (scalarization.w0, scalarization.w1)
    np.fill_diagonal(costs, -1.0)
    order = costs.argsort(axis=1)[:, 1 : 1 + scalarization.candidates.shape[1]]
    scalarization.candidates[:] = order
    scalarization.candidate_costs[:] = np.take_along_axis(costs, order, axis=1)


def _step_through_three_opt(instance: Instance) -> None:
    """Take a few steps of the search of many cities."""
    search = _search(instance)
    search.local_search = search.descents.local_search = _three_opt(search)
    for _ in islice(search.run(), 2 * WEIGHTS):  # a descent under each weight takes one or more
        pass
    scalarization = search.descents.scalarization(WEIGHTS // 2)
    for _ in search.descents.descend_from_neighbours(WEIGHTS // 2, scalarization, assembling=True):
        pass


def _instance(*, coordinates: bool, n: int = _N, objectives: int = 2) -> Instance:
    """Return an instance of n cities, by coordinates or by matrices that differ by direction."""
    cities = np.arange(float(n))
    if coordinates:
        planes = np.stack([cities, cities**2 % 11, cities**2 % 7, cities], axis=1)
        more = np.outer(cities, np.arange(5.0, 2 * objectives + 1)) % 13
        return Instance(coordinates=np.concatenate((planes, more), axis=1))
    matrices = np.triu(np.outer(cities, cities)[None] % np.array([7, 5]).reshape(2, 1, 1))
    return Instance(matrices=matrices)
