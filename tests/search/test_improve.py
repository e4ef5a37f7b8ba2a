"""The search never loses a tour, always returns permutations, and keeps to what limits it."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.instance import Instance, all_tours, tour_lengths
from service.pareto import hypervolume, nondominated
from service.search.improve import SearchProgress, SearchResult, improve
from service.search.schedule import Search

KINDS = ("coordinates", "symmetric", "asymmetric")


def drawn(kind: str, n: int, seed: int) -> Instance:
    """An instance of small whole numbers, so that ties and coincident cities are common."""
    rng = np.random.default_rng(seed)
    if kind == "coordinates":
        return Instance(coordinates=rng.integers(0, 6, (n, 4)).astype(float))
    matrices = rng.integers(0, 9, (2, n, n)).astype(float)
    if kind == "symmetric":
        matrices += matrices.transpose(0, 2, 1)
    return Instance(matrices=matrices)


def uniform(n: int, seed: int = 0) -> Instance:
    return Instance(coordinates=np.random.default_rng(seed).random((n, 4)))


def none(n: int) -> NDArray[np.int32]:
    return np.empty((0, n), np.int32)


def shuffled(n: int, m: int, seed: int = 0) -> NDArray[np.int64]:
    rng = np.random.default_rng(seed)
    return np.array([rng.permutation(n) for _ in range(m)], np.int64).reshape(m, n)


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
@pytest.mark.parametrize("n", range(1, 8))
def test_a_few_cities_give_the_exact_front(kind: str, n: int) -> None:
    instance = drawn(kind, n, seed=n)
    found = improve(instance, none(n))
    points = tour_lengths(instance, all_tours(n))
    assert np.array_equal(found.points, points[nondominated(points)])
    assert found.terminated == "converged"


@settings(max_examples=40)
@given(kind=st.sampled_from(KINDS), n=st.integers(8, 30), m=st.integers(0, 5), seed=st.integers(0))
def test_every_given_tour_is_dominated_or_equalled(kind: str, n: int, m: int, seed: int) -> None:
    instance = drawn(kind, n, seed % 1000)
    tours = shuffled(n, m, seed % 1000)
    found = improve(instance, tours, iterations=500, seed=seed % 1000)
    assert is_front(instance, found)
    assert covers(found.points, tour_lengths(instance, tours))


@pytest.mark.parametrize("kind", KINDS)
def test_eight_cities_come_close_to_the_exact_front(kind: str) -> None:
    for seed in range(5):
        instance = drawn(kind, 8, seed)
        best = tour_lengths(instance, all_tours(8))
        corner = best.max(axis=0) + 1
        found = improve(instance, none(8), iterations=20_000)
        assert hypervolume(found.points, corner) >= 0.99 * hypervolume(best, corner)


@pytest.mark.parametrize("kind", KINDS)
def test_the_same_seed_and_iterations_give_the_same_front(kind: str) -> None:
    instance = drawn(kind, 40, seed=3)
    first, second, other = (
        improve(instance, none(40), iterations=20_000, seed=seed) for seed in (1, 1, 2)
    )
    assert np.array_equal(first.tours, second.tours)
    assert not np.array_equal(first.tours, other.tours)


@pytest.mark.parametrize("matrices", [np.zeros((2, 12, 12)), np.ones((2, 12, 12))])
def test_costs_that_are_all_equal_give_one_tour(matrices: NDArray[np.float64]) -> None:
    found = improve(Instance(matrices=matrices), none(12))
    assert len(found.tours) == 1
    assert found.terminated == "converged"


def test_cities_that_all_coincide_give_one_tour() -> None:
    found = improve(Instance(coordinates=np.full((50, 4), 3.5)), none(50))
    assert found.points.tolist() == [[0.0, 0.0]]


@pytest.mark.parametrize("factor", [1e-150, 1e-3, 50.0, 1e150])
def test_units_do_not_matter(factor: float) -> None:
    instance = uniform(60)
    scaled = Instance(coordinates=instance.coordinates * [1, 1, factor, factor])
    found = improve(scaled, none(60), iterations=30_000)
    plain = improve(instance, none(60), iterations=30_000)
    corner = np.full(2, 60.0)
    share = hypervolume(found.points / [1, factor], corner)
    assert share == pytest.approx(hypervolume(plain.points, corner), abs=0.003)


def test_whole_numbered_matrices_stay_exact() -> None:
    instance = drawn("symmetric", 60, seed=1)
    search = Search(instance, 0, 60 * instance.scale)
    for _, _ in zip(range(200), search.run(), strict=False):
        pass
    points = search.state.archive.points[: search.size] / search.cost_factors
    assert np.array_equal(points, tour_lengths(instance, search.tours()))


@pytest.mark.parametrize("coordinates", [True, False])
def test_a_long_enough_search_converges(coordinates: bool) -> None:
    instance = uniform(10) if coordinates else drawn("asymmetric", 10, seed=0)
    assert improve(instance, none(10)).terminated == "converged"


@pytest.mark.parametrize(("n", "slack"), [(200, 0.02), (1000, 0.1)])
def test_a_deadline_is_obeyed(n: int, slack: float) -> None:
    instance = uniform(n)
    seconds = []
    for _ in range(3):  # the machine may halt one, but only the search itself holds up all
        used = time.process_time()
        found = improve(instance, none(n), deadline=time.monotonic() + 0.2)
        seconds.append(time.process_time() - used)
        assert found.terminated == "time_limit"
        assert is_front(instance, found)
    assert min(seconds) < 0.2 + slack


def test_a_deadline_that_has_passed_still_gives_a_tour() -> None:
    found = improve(uniform(30), none(30), deadline=time.monotonic() - 1)
    assert len(found.tours) == 1


def test_a_stopped_search_keeps_what_it_found() -> None:
    instance = uniform(100)
    calls = iter(range(300))
    found = improve(instance, none(100), stop=lambda: next(calls) == 250)
    assert found.terminated == "cancelled"
    assert next(calls) == 251
    assert len(found.tours) > 20


def test_progress_is_reported_and_only_ever_upwards() -> None:
    reported: list[SearchProgress] = []
    improve(uniform(100), none(100), deadline=time.monotonic() + 0.5, report=reported.append)
    assert len(reported) >= 2
    shares = [progress.hypervolume for progress in reported]
    assert shares == sorted(shares)
    assert 0 < shares[0] < 1
    assert reported[-1].points > 20


def test_a_given_tour_that_the_archive_had_to_let_go_is_still_returned() -> None:
    search = Search(uniform(20), 0, np.full(2, 20.0))
    tours = shuffled(20, 3)
    search.add(tours[:1])
    lost = search.not_covered(tours)
    assert all(tour.tolist() != tours[0].tolist() for tour in lost)
    search.add(lost)
    assert not len(search.not_covered(tours))


def test_no_cost_beyond_the_coordinates_is_stored_for_many_cities() -> None:
    search = Search(uniform(700), 0, np.full(2, 700.0))
    assert search.state.costs.matrix.size == 0


def test_random_tours_are_improved_a_great_deal() -> None:
    instance = uniform(100)
    tours = shuffled(100, 20)
    corner = np.full(2, 100.0)
    before = hypervolume(tour_lengths(instance, tours), corner)
    found = improve(instance, tours, iterations=2_000)
    assert hypervolume(found.points, corner) > before + 0.3


def test_the_search_works_where_no_compiled_code_can_be_kept() -> None:
    """With none of numba's ways to find a place for it but one that does not apply."""
    code = (
        "import numpy as np; from service.pareto import best_subset;"
        "points = np.stack([np.arange(9.0), 9 - np.arange(9.0)], axis=1);"
        "print(len(best_subset(points, 3, np.full(2, 10.0))))"
    )
    environment = {
        **os.environ,
        "NUMBA_CACHE_LOCATOR_CLASSES": "numba.core.caching.ZipCacheLocator",
    }
    ran = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True
    )
    assert (ran.stdout, ran.stderr) == ("3\n", "")
