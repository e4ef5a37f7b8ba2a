"""The search never loses a tour, always returns permutations, and keeps to what limits it."""

import time
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.front import SearchResult
from service.instance import Instance, tour_lengths
from service.pareto import hypervolume, nondominated
from service.search.enumeration import exact_tours
from service.search.improve import LEAST_POINTS, improve
from service.search.schedule import BLOCK, Search
from service.search.sizes import MAX_ENUMERATED
from service.watch import Progress, Watch
from tests.helpers.instances import (
    ENDS,
    KINDS,
    every_tour,
    no_tours,
    opened,
    random_routes,
    random_tours,
    small_integers,
    uniform,
)
from tests.helpers.sampled import IS_WHOLE, few, third

pytestmark = pytest.mark.usefixtures("compiled")


def is_front(instance: Instance, found: SearchResult) -> bool:
    """Whether tours with the right ends go with their points, and none dominates another."""
    return (
        (instance.start is None or (found.tours[:, 0] == instance.start).all())
        and (instance.end is None or (found.tours[:, -1] == instance.end).all())
        and (np.sort(found.tours, axis=1) == np.arange(instance.n)).all()
        and np.allclose(lengths_in_parts(instance, found.tours), found.points, rtol=1e-13)
        and np.array_equal(nondominated(found.points), np.arange(len(found.points)))
    )


def lengths_in_parts(instance: Instance, tours: NDArray[np.integer]) -> NDArray[np.float64]:
    """The lengths of tours, some at a time: thousands of long ones at once take gigabytes."""
    parts = np.array_split(tours, len(tours) // 100 + 1)
    return np.concatenate([tour_lengths(instance, part) for part in parts])


def covers(points: NDArray[np.float64], given: NDArray[np.float64]) -> bool:
    """Whether each given point is dominated or equalled."""
    return (points[:, None] <= given[None] * (1 + 1e-11)).all(axis=2).any(axis=0).all()


def nondominated_points(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nondominated of points, once each: lengths that differ by rounding are equal."""
    return points[nondominated(points.round(9))]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", range(1, 10))
def test_a_few_cities_give_the_exact_front(kind: str, n: int) -> None:
    instance = small_integers(kind, n, seed=n)
    found = improve(instance, no_tours(n))
    points = tour_lengths(instance, every_tour(instance))
    np.testing.assert_allclose(found.points, nondominated_points(points), rtol=1e-12)
    assert is_front(instance, found)
    assert found.terminated == "converged"


@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("kind", KINDS)
def test_open_routes_through_a_few_cities_give_the_exact_front(kind: str, ends: str) -> None:
    for seed in range(third(17)):
        n = 2 + seed % 8
        instance = opened(small_integers(kind, n, seed), ends, seed)
        found = improve(instance, no_tours(n))
        points = tour_lengths(instance, every_tour(instance))
        np.testing.assert_allclose(found.points, nondominated_points(points), rtol=1e-12)
        assert is_front(instance, found)


def test_of_an_open_route_through_one_city_there_is_one() -> None:
    for start, end in [(None, None), (0, None), (None, 0), (0, 0)]:
        instance = Instance(coordinates=np.ones((1, 4)), closed=False, start=start, end=end)
        assert improve(instance, no_tours(1)).tours.tolist() == [[0]]


@settings(max_examples=third(40))
@given(kind=st.sampled_from(KINDS), n=st.integers(10, 30), m=st.integers(0, 5), seed=st.integers(0))
def test_every_given_tour_is_dominated_or_equalled(kind: str, n: int, m: int, seed: int) -> None:
    instance = small_integers(kind, n, seed % 1000)
    tours = random_tours(n, m, seed % 1000)
    found = improve(instance, tours, iterations=500, seed=seed % 1000)
    assert is_front(instance, found)
    assert covers(found.points, tour_lengths(instance, tours))


@settings(max_examples=third(60))
@given(
    kind=st.sampled_from(KINDS),
    ends=st.sampled_from(ENDS),
    n=st.integers(10, 30),
    m=st.integers(0, 5),
    seed=st.integers(0, 1000),
)
def test_every_given_route_is_dominated_or_equalled(
    kind: str, ends: str, n: int, m: int, seed: int
) -> None:
    instance = opened(small_integers(kind, n, seed), ends, seed)
    routes = random_routes(instance, m, seed)
    found = improve(instance, routes, iterations=500, seed=seed)
    assert is_front(instance, found)
    assert covers(found.points, tour_lengths(instance, routes))


@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize("kind", KINDS)
def test_ten_cities_come_close_to_the_exact_front(kind: str, ends: str) -> None:
    n = MAX_ENUMERATED + 1
    for seed in few(1, range(3)):
        instance = small_integers(kind, n, seed)
        if ends != "closed":
            instance = opened(instance, ends, seed)
        best = tour_lengths(instance, exact_tours(instance)[0])
        corner = best.max(axis=0) + 1
        found = improve(instance, no_tours(n), iterations=20_000)
        assert is_front(instance, found)
        assert covers(best, found.points)
        assert hypervolume(found.points, corner) >= 0.98 * hypervolume(best, corner)


@pytest.mark.parametrize(
    ("n", "ends"),  # by a matrix of costs, and by coordinates
    [(60, ends) for ends in ENDS] + few(2, [(700, ends) for ends in ENDS[::-1]]),
)
def test_coordinates_and_their_distances_give_routes_as_good(n: int, ends: str) -> None:
    instance = opened(uniform(n), ends, seed=n)
    matrices = instance.scaled_matrices * instance.scale[:, None, None]
    same = replace(instance, coordinates=None, matrices=matrices)
    corner = np.full(2, float(n))
    found, other = (improve(each, no_tours(n), iterations=3000) for each in (instance, same))
    assert is_front(instance, found)
    shares = [hypervolume(each.points, corner) for each in (found, other)]
    assert shares[0] == pytest.approx(shares[1], abs=0.003)


def test_more_given_tours_than_the_search_can_keep_are_all_dominated_or_equalled() -> None:
    # A tour that keeps to the order for k steps has the lengths (40 - k, k).
    in_order = np.roll(np.eye(40), 1, axis=1)
    instance = Instance(matrices=np.stack((1 - in_order, in_order)))
    order = np.arange(40)
    tours = np.stack([np.concatenate((order[:k], order[k:][::-1])) for k in range(40)])
    points = tour_lengths(instance, tours)
    assert len(nondominated(points)) > 16
    found = improve(instance, tours, iterations=1, capacity=16)
    assert len(found.tours) > 16
    assert is_front(instance, found)
    assert covers(found.points, points)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_and_iterations_give_the_same_front(kind: str) -> None:
    instance = small_integers(kind, 40, seed=3)
    rounds = 20_000 if IS_WHOLE else 5_000
    first, second, other = (
        improve(instance, no_tours(40), iterations=rounds, seed=seed) for seed in (1, 1, 2)
    )
    assert np.array_equal(first.tours, second.tours)
    assert not np.array_equal(first.tours, other.tours)


@pytest.mark.parametrize("matrices", [np.zeros((2, 12, 12)), np.ones((2, 12, 12))])
def test_costs_that_are_all_equal_give_one_tour(matrices: NDArray[np.float64]) -> None:
    found = improve(Instance(matrices=matrices), no_tours(12))
    assert len(found.tours) == 1
    assert found.terminated == "converged"


def test_cities_that_all_coincide_give_one_tour() -> None:
    found = improve(Instance(coordinates=np.full((50, 4), 3.5)), no_tours(50))
    assert found.points.tolist() == [[0.0, 0.0]]


def test_units_do_not_matter() -> None:
    instance = uniform(60)
    shares = []
    for factor in (1.0, *few(2, (1e-150, 50.0, 1e-3, 1e150))):
        scaled = Instance(coordinates=instance.coordinates * [1, 1, factor, factor])
        found = improve(scaled, no_tours(60), iterations=30_000)
        shares.append(hypervolume(found.points / [1, factor], np.full(2, 60.0)))
    assert shares[1:] == pytest.approx([shares[0]] * len(shares[1:]), abs=0.003)


@pytest.mark.parametrize("coordinates", [True, False])
def test_a_long_enough_search_converges(coordinates: bool) -> None:
    instance = uniform(10) if coordinates else small_integers("asymmetric", 10, seed=0)
    assert improve(instance, no_tours(10)).terminated == "converged"


@pytest.mark.parametrize("n", [200, 1000])
def test_a_deadline_is_obeyed_at_the_first_look_after_it(n: int) -> None:
    instance = uniform(n)
    looks: list[float] = []

    def stop() -> bool:
        looks.append(time.monotonic())
        return False

    deadline = time.monotonic() + 0.4
    found = improve(instance, no_tours(n), watch=Watch(0.4, stop))
    assert found.terminated == "time_limit"
    assert is_front(instance, found)
    # The deadline may pass between a look at the clock and this one.
    assert sum(look > deadline for look in looks) <= 2
    assert len(looks) > 20


@pytest.mark.parametrize("n", [200, 1000, 2000])
def test_the_search_looks_at_the_clock_after_few_iterations(n: int) -> None:
    search = Search(uniform(n), 0, np.full(2, float(n)))
    assert max(islice(search.run(), 500)) <= BLOCK


@pytest.mark.parametrize("n", [14, 60, 200])
@pytest.mark.parametrize("objectives", [2, 3])
def test_a_deadline_that_has_passed_still_gives_a_small_front(n: int, objectives: int) -> None:
    instance = uniform(n, objectives=objectives)
    found = improve(instance, no_tours(n), watch=Watch(-1.0))
    assert found.terminated == "time_limit"
    assert len(found.tours) >= LEAST_POINTS
    assert is_front(instance, found)


def test_a_deadline_that_has_passed_ends_a_search_from_a_front() -> None:
    instance = uniform(60)
    given = improve(instance, no_tours(60), iterations=2_000)
    looks: list[None] = []

    def stop() -> bool:
        looks.append(None)
        return False

    improve(instance, given.tours, watch=Watch(-1.0, stop))
    assert len(looks) == 1


def test_a_stopped_search_keeps_what_it_found() -> None:
    instance = uniform(100)
    calls = iter(range(300))
    found = improve(instance, no_tours(100), watch=Watch(stop=lambda: next(calls) == 250))
    assert found.terminated == "cancelled"
    assert next(calls) == 251
    assert len(found.tours) > 20
    assert np.array_equal(found.tours_at(np.array([3, 20])), found.tours[[3, 20]])


def test_progress_is_reported_and_only_ever_upwards() -> None:
    reported: list[Progress] = []
    improve(
        uniform(100),
        no_tours(100),
        watch=Watch(1.0, report=lambda progress, _: reported.append(progress)),
    )
    assert len(reported) >= 2
    shares = [progress.hypervolume for progress in reported]
    assert shares == sorted(shares)
    assert 0 < shares[0] < 1
    assert reported[-1].points > 20


def test_random_tours_are_improved_a_great_deal() -> None:
    instance = uniform(100)
    tours = random_tours(100, 20)
    corner = np.full(2, 100.0)
    before = hypervolume(tour_lengths(instance, tours), corner)
    found = improve(instance, tours, iterations=2_000)
    assert hypervolume(found.points, corner) > before + 0.3


@pytest.mark.parametrize("kind", KINDS)
def test_a_search_that_is_stopped_at_once_gives_a_nearest_neighbour_tour(kind: str) -> None:
    instance = small_integers(kind, 60, seed=4)
    found = improve(instance, no_tours(60), watch=Watch(stop=lambda: True))
    search = Search(instance, 0, 60 * instance.scale)
    matrices = np.ldexp(instance.scale, instance.shifts)[:, None, None] * instance.scaled_matrices
    cost = np.tensordot(search.weights[search.middle], matrices, 1)
    [tour] = found.tours.tolist()
    visited = tour[tour.index(0) :] + tour[: tour.index(0)]
    for k in range(1, 60):
        left = visited[k:]
        assert cost[visited[k - 1], visited[k]] == pytest.approx(cost[visited[k - 1], left].min())


def test_the_search_stops_before_its_deadline_by_the_seconds_reserved_for_its_points() -> None:
    instance = uniform(40, seed=1)
    sizes: list[int] = []

    def reserve(points: int) -> float:
        sizes.append(points)
        return 60.0 if points > 20 else 0.0

    found = improve(instance, no_tours(40), watch=Watch(60.0), reserve=reserve)
    assert found.terminated == "time_limit"
    assert len(found.points) == sizes[-1] > 20
