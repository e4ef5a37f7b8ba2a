"""Nearest neighbours: after the cities that are begun with, the tour visits all others."""

import numpy as np
import pytest

from service.search.starts.nearest_neighbour import nearest_neighbour
from tests.helpers.instances import random_matrices, scalarization_of


@pytest.mark.parametrize("symmetric", [True, False])
def test_the_nearest_neighbour_tour_visits_all(symmetric: bool) -> None:
    scalarization = scalarization_of(random_matrices(30, 1, symmetric))
    tour = np.array([5, 2] + [0] * 28, np.int32)
    nearest_neighbour(scalarization, 2, tour)
    assert tour[:2].tolist() == [5, 2]
    assert np.array_equal(np.sort(tour), np.arange(30))
