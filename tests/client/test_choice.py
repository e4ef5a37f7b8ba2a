"""Balances and the knee by hand; what is chosen by them stands in `tests/requests/test_tour.py`."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from paretour.choice import balances, knee

from service.pareto import nondominated

# Small integers, so that ties are common.
POINTS = arrays(np.float64, st.tuples(st.integers(1, 12), st.just(2)), elements=st.integers(0, 11))


@given(POINTS)
def test_a_balance_is_the_mean_of_nearness_to_either_end(points: np.ndarray) -> None:
    (least1, least2), (most1, most2) = points.min(axis=0), points.max(axis=0)
    for (first, second), balance in zip(points, balances(points), strict=True):
        u = (first - least1) / (most1 - least1) if most1 > least1 else 0
        v = (second - least2) / (most2 - least2) if most2 > least2 else 0
        assert balance == pytest.approx((u + (1 - v)) / 2)


@given(POINTS, st.floats(1e-9, 1e9), st.floats(1e-9, 1e9))
def test_balances_of_a_front_ascend_from_0_to_1_in_any_unit(
    points: np.ndarray, first: float, second: float
) -> None:
    front = points[nondominated(points)] * (first, second)
    found = balances(front)
    if len(front) == 1:
        assert found.tolist() == [0.5]
    else:
        assert (found[0], found[-1]) == (0, 1)
        assert (np.diff(found) > 0).all()


def test_no_points_have_no_balances() -> None:
    assert balances(np.empty((0, 2))).shape == (0,)


@given(POINTS)
@example(np.array([[0.0, 10.0], [1.0, 8.0], [5.0, 5.0], [10.0, 0.0]]))  # not that of the least most
def test_no_point_has_a_smaller_sum_in_the_box_than_the_knee(points: np.ndarray) -> None:
    least, most = points.min(axis=0), points.max(axis=0)
    box = np.where(most > least, most - least, 1)
    sums = [float(sum((point - least) / box)) for point in points]
    assert sums[knee(points)] == pytest.approx(min(sums))
