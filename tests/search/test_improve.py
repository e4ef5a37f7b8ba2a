"""The search never loses a tour, always returns permutations, and keeps to what limits it."""

import time
from collections.abc import Iterable, Iterator
from itertools import pairwise, permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance, all_tours, tour_lengths
from service.pareto import hypervolume, nondominated
from service.search.improve import Progress, SearchResult, improve
from tests.helpers.instances import KINDS, no_tours, random_tours, small_integers, uniform

pytestmark = pytest.mark.usefixtures("compiled")


def is_front(instance: Instance, found: SearchResult) -> bool:
    """Whether permutations and points go together, sorted, and none dominates another."""
    return (
        (np.sort(found.tours, axis=1) == np.arange(instance.n)).all()
        and np.allclose(tour_lengths(instance, found.tours), found.points, rtol=1e-13)
        and np.array_equal(nondominated(found.points), np.arange(len(found.points)))
    )


def covers(points: NDArray[np.float64], given: NDArray[np.float64]) -> bool:
    """Whether each given point is dominated or equalled."""
    return (points[:, None] <= given[None] * (1 + 1e-11)).all(axis=2).any(axis=0).all()


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("n", range(1, 10))
def test_a_few_cities_give_the_exact_front(kind: str, n: int) -> None:
    for seed in range(10 if n < 9 else 2):
        instance = small_integers(kind, n, seed)
        found = improve(instance, no_tours(n), deadline=0.0)
        assert front_of(found.points) == front_of(all_lengths(instance))
        assert is_front(instance, found)
        assert found.terminated == "converged"


def all_lengths(instance: Instance) -> Iterator[list[float]]:
    """The lengths of every tour, summed here."""
    if instance.matrices is None:
        assert instance.coordinates is not None
        planes = instance.coordinates.reshape(-1, 2, 2)
        costs = np.linalg.norm(planes[:, None] - planes, axis=-1).transpose(2, 0, 1).tolist()
    else:
        costs = instance.matrices.tolist()
    for rest in permutations(range(1, instance.n)):
        yield [sum(cost[a][b] for a, b in pairwise((0, *rest, 0))) for cost in costs]


def front_of(points: Iterable[Iterable[float]]) -> list[tuple[float, ...]]:
    """The nondominated among points, which are equal where they agree to nine digits."""
    front: list[tuple[float, ...]] = []
    for point in sorted({tuple(round(length, 9) for length in point) for point in points}):
        if not front or point[1] < front[-1][1]:
            front.append(point)
    return front


@settings(max_examples=40)
@given(kind=st.sampled_from(KINDS), n=st.integers(10, 30), m=st.integers(0, 5), seed=st.integers(0))
def test_every_given_tour_is_dominated_or_equalled(kind: str, n: int, m: int, seed: int) -> None:
    instance = small_integers(kind, n, seed % 1000)
    tours = random_tours(n, m, seed % 1000)
    found = improve(instance, tours, iterations=500, seed=seed % 1000)
    assert is_front(instance, found)
    assert covers(found.points, tour_lengths(instance, tours))


@pytest.mark.parametrize("kind", KINDS)
def test_ten_cities_come_close_to_the_exact_front(kind: str) -> None:
    for seed in range(2):
        instance = small_integers(kind, 10, seed)
        best = tour_lengths(instance, all_tours(10))
        corner = best.max(axis=0) + 1
        found = improve(instance, no_tours(10), iterations=20_000)
        assert hypervolume(found.points, corner) >= 0.99 * hypervolume(best, corner)


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
    first, second, other = (
        improve(instance, no_tours(40), iterations=20_000, seed=seed) for seed in (1, 1, 2)
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


@pytest.mark.parametrize("factor", [1e-150, 1e-3, 50.0, 1e150])
def test_units_do_not_matter(factor: float) -> None:
    instance = uniform(60)
    scaled = Instance(coordinates=instance.coordinates * [1, 1, factor, factor])
    found = improve(scaled, no_tours(60), iterations=30_000)
    plain = improve(instance, no_tours(60), iterations=30_000)
    corner = np.full(2, 60.0)
    share = hypervolume(found.points / [1, factor], corner)
    assert share == pytest.approx(hypervolume(plain.points, corner), abs=0.003)


@pytest.mark.parametrize("coordinates", [True, False])
def test_a_long_enough_search_converges(coordinates: bool) -> None:
    instance = uniform(10) if coordinates else small_integers("asymmetric", 10, seed=0)
    assert improve(instance, no_tours(10)).terminated == "converged"


@pytest.mark.parametrize(("n", "slack"), [(200, 0.02), (1000, 0.1)])
def test_a_deadline_is_obeyed(n: int, slack: float) -> None:
    instance = uniform(n)
    seconds = []
    for _ in range(3):  # the machine may halt one, but only the search itself holds up all
        used = time.process_time()
        found = improve(instance, no_tours(n), deadline=time.monotonic() + 0.2)
        seconds.append(time.process_time() - used)
        assert found.terminated == "time_limit"
        assert is_front(instance, found)
    assert min(seconds) < 0.2 + slack


def test_a_deadline_that_has_passed_still_gives_a_tour() -> None:
    found = improve(uniform(30), no_tours(30), deadline=time.monotonic() - 1)
    assert len(found.tours) == 1


def test_a_stopped_search_keeps_what_it_found() -> None:
    instance = uniform(100)
    calls = iter(range(300))
    found = improve(instance, no_tours(100), stop=lambda: next(calls) == 250)
    assert found.terminated == "cancelled"
    assert next(calls) == 251
    assert len(found.tours) > 20


def test_progress_is_reported_and_only_ever_upwards() -> None:
    reported: list[Progress] = []
    improve(
        uniform(100),
        no_tours(100),
        deadline=time.monotonic() + 0.5,
        report=lambda progress, _: reported.append(progress),
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
