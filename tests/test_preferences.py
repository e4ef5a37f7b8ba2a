"""What an angle means."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.preferences import angles, fan, from_angles, weights

DEGREES = st.lists(st.floats(0, 90), min_size=1, max_size=5).map(np.array)


def test_the_axes_are_exact() -> None:
    np.testing.assert_allclose(from_angles(np.array([0.0, 90.0])), [[1, 0], [0, 1]], atol=1e-15)


@given(DEGREES)
def test_a_preference_is_a_unit_vector_and_never_negative(degrees: np.ndarray) -> None:
    preferences = from_angles(degrees)
    np.testing.assert_allclose(np.linalg.norm(preferences, axis=1), 1)
    assert (preferences >= 0).all()


@given(DEGREES)
def test_the_angle_of_a_preference_is_the_angle_it_was_made_from(degrees: np.ndarray) -> None:
    np.testing.assert_allclose(angles(from_angles(degrees), np.ones(2)), degrees, atol=1e-9)


@given(st.integers(1, 200))
def test_a_fan_is_even_and_keeps_off_the_axes(k: int) -> None:
    degrees = fan(k)
    assert len(degrees) == k
    np.testing.assert_allclose(np.diff(degrees), 90 / k)
    np.testing.assert_allclose(degrees[0], 90 - degrees[-1])
    assert degrees[0] > 0


@pytest.mark.parametrize(
    ("point", "angle"), [((1, 0), 0), ((0, 1), 90), ((2, 2), 45), ((0, 0), 45), ((3**0.5, 1), 30)]
)
def test_angles_by_hand(point: tuple[float, float], angle: float) -> None:
    np.testing.assert_allclose(angles(np.array([point]), np.ones(2)), [angle])


@pytest.mark.parametrize("scale", [1.0, 1e-200, 1e200])
@pytest.mark.parametrize("length", [1e-200, 1.0, 1e200])
def test_a_point_on_an_axis_has_the_angle_of_that_axis(length: float, scale: float) -> None:
    points = np.array([[length, 0.0], [0.0, length]])
    assert angles(points, np.full(2, scale)).tolist() == [0, 90]


def test_a_heavy_weight_goes_with_a_short_component() -> None:
    (weight,) = weights(from_angles(np.array([90.0])))
    np.testing.assert_allclose(weight, [1, 0], atol=1e-15)
