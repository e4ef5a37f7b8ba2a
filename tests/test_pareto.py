"""Dominance and hypervolume, against moocore and by hand."""

from itertools import combinations

import moocore
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.pareto import best_subset, hypervolume, nondominated

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


@given(POINTS, st.integers(1, 5))
def test_no_subset_of_a_size_has_a_larger_hypervolume(points: np.ndarray, size: int) -> None:
    front = points[nondominated(points)]
    chosen = best_subset(front, size, REFERENCE_POINT)
    assert len(chosen) <= size
    assert (np.diff(chosen) > 0).all()
    best = max(
        hypervolume(front[list(subset)], REFERENCE_POINT)
        for subset in combinations(range(len(front)), min(size, len(front)))
    )
    assert hypervolume(front[chosen], REFERENCE_POINT) == pytest.approx(best)
