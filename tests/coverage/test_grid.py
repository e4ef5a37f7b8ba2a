"""Where a robot can be, and from where a region is covered."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from service.coverage.grid import covering_places, free_cells, largest_region, regions

MAPS = arrays(np.bool_, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.booleans())


@given(MAPS, st.sampled_from([0.0, 0.5, 1.0, 1.5, 2.9]), st.sampled_from([0.1, 1.0, 3.0]))
def test_a_free_cell_is_farther_from_every_obstacle_than_the_radius(
    blocked: np.ndarray, radius: float, cell_size: float
) -> None:
    free = free_cells(blocked, cell_size, radius * cell_size)
    obstacles = np.argwhere(blocked)
    for cell, is_free in np.ndenumerate(free):
        near = np.square(obstacles - cell).sum(axis=1) <= radius**2
        assert is_free == (not near.any())


def test_a_distance_equal_to_the_radius_is_not_farther() -> None:
    # In floating point, 3 cells of 0.1 are more than 0.3.
    free = free_cells(np.array([[True, False, False, False, False]]), 0.1, 0.3)
    assert free.tolist() == [[False, False, False, False, True]]


def test_regions_touch_at_sides_and_not_at_corners() -> None:
    free = np.array([[True, False, True], [False, True, True]])
    assert regions(free).tolist() == [[1, 0, 2], [0, 2, 2]]
    assert largest_region(free).tolist() == [[False, False, True], [False, True, True]]


def test_nowhere_is_the_largest_region_of_nothing() -> None:
    assert not largest_region(np.zeros((3, 3), np.bool_)).any()


@given(MAPS.filter(lambda free: free.any()), st.sampled_from([0.3, 1.0, 1.7, 2.0, 3.5]))
def test_every_cell_is_near_a_place(free: np.ndarray, spacing: float) -> None:
    places = covering_places(free, spacing)
    assert free[tuple(places.T)].all()
    assert len(np.unique(places, axis=0)) == len(places)
    for cell in np.argwhere(free):
        assert np.hypot(*(places - cell).T).min() <= spacing * np.sqrt(2)


@pytest.mark.parametrize(
    ("side", "spacing", "expected"),
    [(4, 4.0, [[1, 1]]), (3, 3.0, [[1, 1]]), (6, 3.0, [[1, 1], [1, 4], [4, 1], [4, 4]])],
)
def test_on_open_ground_places_are_the_middles_of_squares(
    side: int, spacing: float, expected: list[list[int]]
) -> None:
    assert covering_places(np.ones((side, side), np.bool_), spacing).tolist() == expected


def test_the_squares_begin_at_the_region() -> None:
    free = np.zeros((9, 9), np.bool_)
    free[4:7, 5:8] = True
    assert covering_places(free, 3.0).tolist() == [[5, 6]]
