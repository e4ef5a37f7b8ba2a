"""The constrained problem of the paper, equations 10 to 18."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from models.lagrangian import ascended, lagrangian, violation, weighted_sum

LENGTHS = st.floats(0.01, 1000)
ANGLES = st.floats(0.001, math.pi / 2 - 0.001)


def direction(angle: float) -> torch.Tensor:
    return torch.tensor([[math.cos(angle), math.sin(angle)]], dtype=torch.float64)


@given(length=LENGTHS, angle=ANGLES)
def test_a_point_along_its_preference_violates_nothing(length: float, angle: float) -> None:
    points = length * direction(angle)[None]
    assert violation(points, direction(angle)).item() == pytest.approx(0, abs=1e-9)


@given(length=LENGTHS, angle=ANGLES, preferred=ANGLES)
def test_violation_is_one_minus_the_cosine_of_the_angle_between(
    length: float, angle: float, preferred: float
) -> None:
    points = length * direction(angle)[None]
    expected = 1 - math.cos(angle - preferred)
    assert violation(points, direction(preferred)).item() == pytest.approx(expected, abs=1e-9)


@given(length=LENGTHS, angle=ANGLES, multiplier=st.floats(0, 200))
def test_the_lagrangian_is_the_norm_plus_what_the_violation_costs(
    length: float, angle: float, multiplier: float
) -> None:
    points = length * direction(angle)[None]
    found = lagrangian(points, direction(0.5), torch.tensor([multiplier]).double())
    expected = length + multiplier * (1 - math.cos(angle - 0.5))
    assert found.item() == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_multipliers_rise_by_the_mean_violation_and_stay_within_their_limits() -> None:
    violations = torch.tensor([[0.1, 0.0, 0.9], [0.3, 0.0, 0.9]])
    found = ascended(torch.tensor([1.0, 0.5, 9.9]), violations, 2.0, (0.6, 10.0))
    assert found.tolist() == pytest.approx([1.4, 0.6, 10.0])


def test_the_first_length_counts_little_for_a_tour_that_may_be_long_in_it() -> None:
    nearly_first_axis = direction(math.radians(1)).expand(2, 2)
    points = torch.tensor([[[1.0, 0.0], [0.0, 1.0]]]).double()
    first, second = weighted_sum(points, nearly_first_axis)[0]
    assert first < 0.02
    assert second > 0.98
