"""Dominance and hypervolume, against moocore and by hand; best subsets against all subsets."""

from itertools import combinations

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.pareto import hypervolume, nondominated
from service.search.best_subset import best_subset
from service.search.front_points import FrontPoints

POINT_LISTS = st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=1, max_size=9)
REFERENCE_POINT = np.array([8.0, 10.0])
# Small integers, so that ties and points beyond the reference point are common.
POINTS = arrays(np.float64, st.tuples(st.integers(1, 12), st.just(2)), elements=st.integers(0, 11))


@given(POINTS)
def test_nondominated_agrees_with_moocore(points: np.ndarray) -> None:
    expected = np.flatnonzero(moocore.is_nondominated(points))
    np.testing.assert_array_equal(np.sort(nondominated(points)), expected)


@given(POINTS)
def test_the_first_length_ascends_and_the_second_descends(points: np.ndarray) -> None:
    front = points[nondominated(points)]
    assert (np.diff(front[:, 0]) > 0).all()
    assert (np.diff(front[:, 1]) < 0).all()


def test_of_equal_points_the_first_stays() -> None:
    assert nondominated(np.array([[1, 1], [0, 2], [1, 1], [0, 2]])).tolist() == [1, 0]


@given(POINTS)
def test_hypervolume_agrees_with_moocore(points: np.ndarray) -> None:
    expected = moocore.hypervolume(points, ref=REFERENCE_POINT) / REFERENCE_POINT.prod()
    assert hypervolume(points, REFERENCE_POINT) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("points", "area"),
    [
        # Printed in moocore's documentation of hypervolume, at the reference point (10, 10).
        ([(5, 5), (4, 6), (2, 7), (7, 4)], 38.0),
        ([(0, 0)], 100.0),
        ([(10, 0)], 0.0),
        ([(11, 11)], 0.0),
    ],
)
def test_hypervolume_by_hand(points: list[tuple[float, float]], area: float) -> None:
    share = hypervolume(np.array(points, dtype=np.float64), np.array([10.0, 10.0]))
    assert share == pytest.approx(area / 100)


@pytest.mark.parametrize("reference_point", [[0, 1], [1, -1], [np.nan, 1]])
def test_a_reference_point_must_be_positive(reference_point: list[float]) -> None:
    with pytest.raises(ValueError, match="reference point must be positive"):
        hypervolume(np.ones((1, 2)), np.array(reference_point))


@given(
    points=POINT_LISTS,
    size=st.integers(1, 6),
    corner=st.tuples(st.integers(1, 10), st.integers(1, 10)),
)
def test_no_subset_has_a_larger_hypervolume(
    points: list[tuple[int, int]], size: int, corner: tuple[int, int]
) -> None:
    given_points, reference_point = np.array(points, float), np.array(corner, float)
    _, front = FrontPoints.among(given_points, reference_point)
    chosen = best_subset(front, size)
    assert len(chosen) == min(size, len(front))
    assert (np.diff(chosen) > 0).all()
    best = max(
        hypervolume(given_points[list(some)], reference_point)
        for some in combinations(range(len(points)), len(chosen))
    )
    assert front.at(chosen).hypervolume == pytest.approx(best, abs=1e-12)


def test_a_front_beyond_the_reference_point_is_spread_evenly() -> None:
    points = np.stack([np.arange(101.0), 100 - np.arange(101.0)], axis=1) + 10
    assert best_subset(FrontPoints(points, np.ones(2)), 3).tolist() == [0, 50, 100]


def test_a_size_that_is_not_positive_is_refused() -> None:
    with pytest.raises(ValueError, match="size must be at least 1, got 0"):
        best_subset(FrontPoints(np.ones((1, 2)), np.ones(2)), 0)


def test_a_hundred_of_ten_thousand_are_the_best_that_exchanges_find() -> None:
    rng = np.random.default_rng(0)
    points = np.stack([np.sort(rng.random(10_000)), -np.sort(-rng.random(10_000))], axis=1)
    corner = np.full(2, 1.1)
    chosen = best_subset(FrontPoints(points, corner), 100)
    best = hypervolume(points[chosen], corner)
    for place in range(100):
        for other in (chosen[place] - 1, chosen[place] + 1):
            exchanged = chosen.copy()
            exchanged[place] = np.clip(other, 0, 9999)
            assert hypervolume(points[exchanged], corner) <= best * (1 + 1e-12)


def test_a_best_subset_that_is_told_to_stop_is_spread_over_the_front() -> None:
    x = np.linspace(0, 1, 101)
    points = np.stack((x, 1 - x), axis=1)
    chosen = best_subset(FrontPoints(points, np.full(2, 1.5)), 5, stop=lambda: True)
    assert chosen.tolist() == [0, 25, 50, 75, 100]
