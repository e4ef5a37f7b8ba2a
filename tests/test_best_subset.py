"""The best subset is the best of all subsets."""

import time
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.pareto import best_subset, hypervolume

POINTS = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=9)


@given(
    points=POINTS, size=st.integers(1, 6), corner=st.tuples(st.integers(1, 10), st.integers(1, 10))
)
def test_no_subset_has_a_larger_hypervolume(
    points: list[tuple[int, int]], size: int, corner: tuple[int, int]
) -> None:
    given_points, reference_point = np.array(points, float), np.array(corner, float)
    chosen = best_subset(given_points, size, reference_point)
    assert len(chosen) == min(size, len(points))
    assert (np.diff(chosen) > 0).all()
    best = max(
        hypervolume(given_points[list(some)], reference_point)
        for some in combinations(range(len(points)), len(chosen))
    )
    assert hypervolume(given_points[chosen], reference_point) == pytest.approx(best, abs=1e-12)


def test_a_front_beyond_the_reference_point_is_spread_evenly() -> None:
    points = np.stack([np.arange(101.0), 100 - np.arange(101.0)], axis=1) + 10
    assert best_subset(points, 3, np.ones(2)).tolist() == [0, 50, 100]


def test_a_size_that_is_not_positive_is_refused() -> None:
    with pytest.raises(ValueError, match="size must be at least 1, got 0"):
        best_subset(np.ones((3, 2)), 0, np.ones(2))


def test_a_hundred_of_ten_thousand_are_chosen_within_fifty_milliseconds() -> None:
    rng = np.random.default_rng(0)
    points = np.stack([np.sort(rng.random(10_000)), -np.sort(-rng.random(10_000))], axis=1)
    best_subset(points[:200], 100, np.full(2, 1.1))
    used = time.process_time()
    chosen = best_subset(points, 100, np.full(2, 1.1))
    assert time.process_time() - used < 0.05
    assert len(chosen) == 100
