"""The search for three and four objectives: exact for few cities, and it keeps what limits it."""

from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray

from service.instance import Instance, tour_lengths
from service.pareto import nondominated
from service.search.bound.hypervolume import hypervolume_bound
from service.search.hypervolume import hypervolume
from service.search.improve import improve
from service.search.several.schedule import SearchOfSeveral
from service.watch import Watch
from tests.helpers.instances import (
    ENDS,
    KINDS,
    every_tour,
    no_tours,
    opened,
    random_matrices,
    random_routes,
    small_integers,
    uniform,
)
from tests.helpers.sampled import IS_WHOLE, at_night
from tests.search.test_improve import covers, is_front

several = pytest.mark.parametrize("objectives", [3, 4])


def exact_points(instance: Instance) -> NDArray[np.float64]:
    """The nondominated points of all tours; lengths that differ by rounding are equal."""
    points = tour_lengths(instance, every_tour(instance))
    return in_order(points[nondominated(points.round(9))])


def in_order(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points by ascending lengths; lengths that differ by rounding alone are equal."""
    return points[np.lexsort(points.round(9).T[::-1])]


@several
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
def test_a_few_cities_give_the_exact_front(kind: str, n: int, objectives: int) -> None:
    instance = small_integers(kind, n, n, objectives)
    found = improve(instance, no_tours(n))
    np.testing.assert_allclose(in_order(found.points), exact_points(instance), rtol=1e-12)
    assert is_front(instance, found)
    assert found.terminated == "converged"


@several
@pytest.mark.parametrize("ends", ENDS)
@pytest.mark.parametrize("kind", KINDS)
def test_so_do_open_routes(kind: str, ends: str, objectives: int) -> None:
    for seed in range(6):
        n = 2 + seed
        instance = opened(small_integers(kind, n, seed, objectives), ends, seed)
        found = improve(instance, no_tours(n))
        np.testing.assert_allclose(in_order(found.points), exact_points(instance), rtol=1e-12)
        assert is_front(instance, found)


@several
@pytest.mark.parametrize("kind", KINDS)
def test_the_search_finds_nearly_all_of_an_exact_front(kind: str, objectives: int) -> None:
    instance = small_integers(kind, 8, 3, objectives)
    search = SearchOfSeveral(instance, 0, instance.reference_point)
    for _ in islice(search.run(), 3000):
        pass
    exact = hypervolume(exact_points(instance), instance.reference_point)
    assert hypervolume(search.points(), instance.reference_point) >= 0.999 * exact


@several
@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize("kind", KINDS)
def test_a_front_covers_the_tours_it_began_with(kind: str, ends: str, objectives: int) -> None:
    instance = small_integers(kind, 30, 1, objectives)
    if ends != "closed":
        instance = opened(instance, ends)
    tours = random_routes(instance, 20)
    found = improve(instance, tours, iterations=2000 if IS_WHOLE else 500)
    assert is_front(instance, found)
    assert covers(found.points, tour_lengths(instance, tours))


@pytest.mark.parametrize(
    ("n", "ends"),
    [
        *((n, ends) for n in (40, 300, 600) for ends in ("closed", "both")),
        (2_100, "closed"),
        pytest.param(2_100, "both", marks=at_night),
    ],
)
def test_cities_of_all_numbers_are_planned(n: int, ends: str) -> None:
    instance = uniform(n, objectives=3)
    if ends != "closed":
        instance = opened(instance, ends)
    found = improve(instance, no_tours(n), iterations=n)
    assert is_front(instance, found)
    assert found.points.sum(axis=1).min() < 0.6 * tour_lengths(
        instance, random_routes(instance, 1)
    ).sum(axis=1)


@several
def test_the_same_iterations_give_the_same_front(objectives: int) -> None:
    instance = uniform(40, objectives=objectives)
    first, again, other = (
        improve(instance, no_tours(40), iterations=3000, seed=seed) for seed in (0, 0, 1)
    )
    assert np.array_equal(first.tours, again.tours)
    assert not np.array_equal(first.points, other.points)


@pytest.mark.parametrize("kind", KINDS)
def test_tours_that_take_over_from_others_stay_on_the_front(kind: str) -> None:
    instance = small_integers(kind, 160, 0, 3)  # enough cities for tours to be assembled
    assert is_front(instance, improve(instance, no_tours(160), iterations=3_000))


def test_it_ends_at_its_deadline_with_what_it_has() -> None:
    instance = uniform(200, objectives=3)
    found = improve(instance, no_tours(200), watch=Watch(0.5))
    assert found.terminated == "time_limit"
    assert is_front(instance, found)


def test_forbidden_legs_are_in_no_tour() -> None:
    matrices = np.array(random_matrices(20, 0, symmetric=False, objectives=3).matrices)
    forbidden = np.random.default_rng(1).random((20, 20)) < 0.3
    matrices[:, forbidden] = np.inf
    instance = Instance(matrices=matrices)
    found = improve(instance, no_tours(20), iterations=2000)
    assert len(found.points)
    assert np.isfinite(tour_lengths(instance, found.tours)).all()


@several
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", [6, 12, 25])
def test_no_front_exceeds_the_bound(n: int, kind: str, objectives: int) -> None:
    instance = small_integers(kind, n, n, objectives)
    found = improve(instance, no_tours(n), iterations=4000 if IS_WHOLE else 2000)
    reached = hypervolume(found.points, instance.reference_point)
    bound = hypervolume_bound(instance, instance.reference_point)
    assert reached <= bound <= 1
    assert bound - reached < 0.2


def test_two_objectives_with_a_third_that_is_equal_give_the_front_of_two() -> None:
    flat = uniform(9)
    assert flat.coordinates is not None
    doubled = Instance(coordinates=np.hstack([flat.coordinates, flat.coordinates[:, 2:]]))
    two, three = (improve(each, no_tours(9)) for each in (flat, doubled))
    np.testing.assert_allclose(three.points[:, :2], two.points, rtol=1e-12)
