"""The paper's claim about concave fronts: rays find them, weighted sums do not."""

import numpy as np

from tests.benchmarks.concave import (
    along_rays,
    by_weighted_sums,
    different,
    largest_gap,
    objectives,
    on_front,
)
from tests.helpers.sampled import sixth


def test_every_ray_finds_the_point_of_the_front_that_lies_on_it() -> None:
    points = along_rays(20)
    angles = np.degrees(np.arctan2(points[:, 1], points[:, 0]))
    assert np.allclose(angles, (np.arange(20) + 0.5) * 4.5, atol=1e-3)
    assert np.abs(on_front(points)).max() < 1e-4
    assert different(points) == 20
    assert largest_gap(points) < 0.2


def test_many_weighted_sums_find_the_two_ends_alone() -> None:
    points = by_weighted_sums(sixth(100))
    ends = np.array([[0, 1 - np.exp(-4)], [1 - np.exp(-4), 0]])
    nearest = np.linalg.norm(points[:, None] - ends, axis=2)
    assert (nearest.min(axis=1) < 0.005).all()
    assert different(points) == 2


def test_nothing_lies_below_the_front() -> None:
    x = np.random.default_rng(1).uniform(-2, 2, (2000, 2))
    points = np.array([objectives(each) for each in x])
    assert on_front(points).min() > -1e-6
