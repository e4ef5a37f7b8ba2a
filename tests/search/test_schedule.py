"""A search keeps costs exact, and tells which tours its archive dropped."""

import numpy as np
import pytest

from service.instance import tour_lengths
from service.search.schedule import Search
from tests.helpers.instances import ENDS, opened, random_tours, small_integers, uniform


@pytest.mark.parametrize("ends", ["closed", *ENDS])
@pytest.mark.parametrize("kind", ["symmetric", "asymmetric"])
def test_whole_numbered_matrices_stay_exact(kind: str, ends: str) -> None:
    instance = small_integers(kind, 60, seed=1)
    if ends != "closed":
        instance = opened(instance, ends)
    search = Search(instance, 0, 60 * instance.scale)
    for _, _ in zip(range(200), search.run(), strict=False):
        pass
    points = search.state.archive.points[: search.size] * 2.0**-search.shifts
    assert np.array_equal(points, tour_lengths(instance, search.tours()))


def test_a_given_tour_that_the_archive_had_to_let_go_is_still_returned() -> None:
    search = Search(uniform(20), 0, np.full(2, 20.0))
    tours = random_tours(20, 3)
    search.add(tours[:1])
    lost = search.not_covered(tours)
    assert all(tour.tolist() != tours[0].tolist() for tour in lost)
    search.add(lost)
    assert not len(search.not_covered(tours))


def test_no_cost_beyond_the_coordinates_is_stored_for_many_cities() -> None:
    search = Search(uniform(700), 0, np.full(2, 700.0))
    assert search.state.costs.matrix.size == 0
