"""Validation: the hypervolume under any number of objectives."""

import moocore
import numpy as np
import pytest

from models.validation import hypervolume


@pytest.mark.parametrize("objectives", [2, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_the_hypervolume_is_that_of_moocore(objectives: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    corner = generator.uniform(1, 3, objectives)
    points = generator.random((25, objectives)) * 1.1 * corner  # some beyond the corner
    points[5:8, -1] = points[4, -1]
    points[9] = points[8]
    expected = moocore.hypervolume(points, ref=corner) / corner.prod()
    assert hypervolume(points, corner) == pytest.approx(expected)


def test_nothing_has_no_hypervolume() -> None:
    assert hypervolume(np.empty((0, 3)), np.ones(3)) == 0
