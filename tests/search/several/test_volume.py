"""Hypervolumes of three and four objectives, and the choice of points by them, against moocore."""

from itertools import combinations

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from service.search.best_subset import best_subset
from service.search.hypervolume import hypervolume

several = pytest.mark.parametrize("objectives", [3, 4])


def shell(k: int, objectives: int, seed: int = 0) -> NDArray[np.float64]:
    """Points that do not dominate one another, some of them not below (1, 1, ...)."""
    points = np.abs(np.random.default_rng(seed).normal(size=(k, objectives)))
    shares: NDArray[np.float64] = 1.05 - points / np.linalg.norm(points, axis=1, keepdims=True)
    return shares


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
    ones = np.ones(objectives)
    for seed in range(10):
        points = shell(14, objectives, seed)
        chosen = best_subset(points, 4, ones)
        best = max(hypervolume(points[list(few)], ones) for few in combinations(range(14), 4))
        assert len(set(chosen.tolist())) == 4
        assert hypervolume(points[chosen], ones) >= 0.97 * best


@several
def test_each_choice_adds_as_much_as_any_other_point_would(objectives: int) -> None:
    points, ones = shell(300, objectives), np.ones(objectives)
    few, more = (set(best_subset(points, size, ones).tolist()) for size in (20, 21))
    assert few < more
    reached = hypervolume(points[sorted(more)], ones)
    for k in range(len(points)):
        assert hypervolume(points[sorted(few | {k})], ones) <= reached + 1e-12


@several
def test_a_choice_that_is_stopped_is_of_as_many_points(objectives: int) -> None:
    points, calls = shell(300, objectives), iter([False] * 5 + [True])
    chosen = best_subset(points, 50, np.ones(objectives), lambda: next(calls))
    assert len(set(chosen.tolist())) == 50
