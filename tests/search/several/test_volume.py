"""Hypervolumes of three and four objectives, and the choice of points by them, against moocore."""

import time
from functools import partial
from itertools import combinations, product

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from service import pareto
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.nondominated import nondominated
from service.watch import Watch
from tests.helpers.sampled import third

several = pytest.mark.parametrize("objectives", [3, 4])


def shell(k: int, objectives: int, seed: int = 0) -> NDArray[np.float64]:
    """Points that do not dominate one another, some of them not below (1, 1, ...)."""
    points = np.abs(np.random.default_rng(seed).normal(size=(k, objectives)))
    shares: NDArray[np.float64] = 1.05 - points / np.linalg.norm(points, axis=1, keepdims=True)
    return shares


def in_order(points: NDArray[np.float64]) -> FrontPoints:
    """The front of some points, with the reference point (1, 1, ...)."""
    return FrontPoints.among(points, np.ones(points.shape[1]))[1]


@several
@given(data=st.data())
def test_the_hypervolume_is_that_of_moocore(objectives: int, data: st.DataObject) -> None:
    point = st.tuples(*[st.integers(0, 8)] * objectives)
    points = np.array(data.draw(st.lists(point, max_size=60)), float).reshape(-1, objectives)
    reference_point = np.arange(5.0, 5.0 + objectives)
    expected = moocore.hypervolume(points, ref=reference_point) if len(points) else 0.0
    found = hypervolume(points, reference_point)
    assert found * reference_point.prod() == pytest.approx(expected, rel=1e-12)


@several
@pytest.mark.parametrize("k", [100, 2000])
def test_that_of_a_large_front_too(objectives: int, k: int) -> None:
    points, ones = shell(k, objectives), np.ones(objectives)
    assert hypervolume(points, ones) == pytest.approx(moocore.hypervolume(points, ref=ones))


@several
def test_chosen_points_have_nearly_the_largest_hypervolume(objectives: int) -> None:
    for seed in range(third(10)):
        points = shell(14, objectives, seed)
        front = in_order(points)
        chosen = best_subset(front, 4)
        fours = combinations(range(14), 4)
        best = max(hypervolume(points[list(few)], np.ones(objectives)) for few in fours)
        assert len(set(chosen.tolist())) == 4
        assert front.at(chosen).hypervolume >= 0.97 * best


@several
def test_exchanging_one_chosen_point_adds_nothing(objectives: int) -> None:
    front = in_order(shell(31, objectives))
    chosen = set(best_subset(front, 8).tolist())
    reached = front.at(np.array(sorted(chosen))).hypervolume
    for out, other in product(chosen, set(range(len(front))) - chosen):
        exchanged = np.array(sorted(chosen - {out} | {other}))
        assert front.at(exchanged).hypervolume <= reached + 1e-12


@several
def test_a_choice_is_as_good_as_choosing_greedily(objectives: int) -> None:
    front = in_order(shell(160, objectives))
    greedy: list[int] = []
    for _ in range(70):
        left = sorted(set(range(len(front))) - set(greedy))
        greedy.append(max(left, key=lambda k: front.at(np.array(sorted([*greedy, k]))).hypervolume))
    chosen = best_subset(front, 70)
    assert front.at(chosen).hypervolume >= front.at(np.array(sorted(greedy))).hypervolume - 1e-12


@several
@pytest.mark.parametrize("size", [10, 100])
def test_a_choice_in_little_time_loses_little(
    objectives: int, size: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Of this processor: on a busy machine a choice that is held up begins again with less time.
    watch = partial(Watch, clock=time.thread_time)
    monkeypatch.setattr("service.search.best_subset.Watch", watch)
    front = in_order(shell(20_000, objectives))
    best, quick = best_subset(front, size), best_subset(front, size, seconds=0.05)
    assert len(set(quick.tolist())) == size
    assert front.at(quick).hypervolume > 0.96 * front.at(best).hypervolume


@several
def test_points_that_are_close_together_are_thinned_as_well(objectives: int) -> None:
    ends = 0.95 - 0.85 * np.eye(objectives)
    front = in_order(np.concatenate((0.6 + 1e-7 * shell(1_500, objectives), ends)))
    assert len(front) > 1_400
    assert front.quick_hypervolume == pytest.approx(front.hypervolume, rel=1e-3)
    assert len(set(best_subset(front, 1_000, seconds=1e-3).tolist())) == 1_000


@several
def test_nearly_all_of_many_points_are_chosen_without_time_too(objectives: int) -> None:
    front = in_order(shell(3_000, objectives))
    chosen = best_subset(front, 2_000, seconds=1e-3)
    assert len(set(chosen.tolist())) == 2_000


@several
@given(data=st.data())
def test_the_nondominated_are_those_of_moocore(objectives: int, data: st.DataObject) -> None:
    point = st.tuples(*[st.integers(0, 4)] * objectives)
    points = np.array(data.draw(st.lists(point, max_size=40)), float).reshape(-1, objectives)
    kept = nondominated(points)
    expected = moocore.is_nondominated(points) if len(points) else np.empty(0, bool)
    np.testing.assert_array_equal(np.sort(kept), np.flatnonzero(expected))
    np.testing.assert_array_equal(kept, pareto.nondominated(points))


@several
def test_the_nondominated_of_many_are_those_of_moocore(objectives: int) -> None:
    points = np.random.default_rng(0).random((5_000, objectives)).round(2)
    expected = np.flatnonzero(moocore.is_nondominated(points))
    np.testing.assert_array_equal(np.sort(nondominated(points)), expected)


@several
def test_a_choice_that_is_stopped_is_of_as_many_points(objectives: int) -> None:
    front, calls = in_order(shell(300, objectives)), iter([False] * 5 + [True])
    chosen = best_subset(front, 50, stop=lambda: next(calls))
    assert len(set(chosen.tolist())) == 50
