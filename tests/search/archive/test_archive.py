"""The archive holds the nondominated points and their tours, of two to four objectives."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.pareto import hypervolume, nondominated
from service.search.archive.insertion import accepts, insert
from service.search.archive.layout import best_row, make_archive, rows_of
from service.search.archive.sorted_points import dominated_area, thin

Points = list[tuple[int, ...]]


def points_of(objectives: int) -> st.SearchStrategy[Points]:
    """Points of small whole numbers, so that ties and equal points are common."""
    point = st.tuples(*[st.integers(1, 9)] * objectives)
    return st.lists(point, min_size=1, max_size=150)


@pytest.mark.parametrize("objectives", [2, 3, 4])
@given(data=st.data())
def test_it_holds_just_the_nondominated_points_and_their_tours(
    objectives: int, data: st.DataObject
) -> None:
    points = np.array(data.draw(points_of(objectives)), float)
    archive = make_archive(1, objectives, 256)
    for k, point in enumerate(points):
        insert(archive, point, np.array([k], np.int32))
    rows = rows_of(archive)
    assert np.array_equal(archive.points[rows], points[nondominated(points)])
    assert np.array_equal(points[archive.tours[rows, 0]], archive.points[rows])
    assert archive.counts[0] == len(rows) == 256 - archive.counts[1]
    for point in points:
        assert not accepts(archive, point)
    weights = np.ldexp(1.0, -np.arange(objectives))  # powers of two: equal sums are equal
    assert archive.points[best_row(archive, weights)] @ weights == (points @ weights).min()
    if objectives == 2:
        corner = np.full(2, 10.0)
        area = 100 * hypervolume(points, corner)
        assert dominated_area(archive, corner) == pytest.approx(area)


@pytest.mark.parametrize("objectives", [2, 3, 4])
def test_a_full_archive_makes_room_and_keeps_the_least_of_each_length(objectives: int) -> None:
    rng = np.random.default_rng(objectives)
    points = rng.random((3000, objectives))
    points /= np.linalg.norm(points, axis=1, keepdims=True)  # none dominates another
    points = 2 - points
    archive = make_archive(1, objectives, 200)
    for k, point in enumerate(points):
        assert insert(archive, point, np.array([k], np.int32)) or not accepts(archive, point)
    rows = rows_of(archive)
    assert 100 <= len(rows) <= 200
    assert np.array_equal(points[archive.tours[rows, 0]], archive.points[rows])
    assert np.array_equal(archive.points[rows].min(axis=0), points.min(axis=0))


def test_thousands_of_points_are_compared_with_few() -> None:
    rng = np.random.default_rng(0)
    points = rng.random((20_000, 3))
    points = 2 - points / np.linalg.norm(points, axis=1, keepdims=True)
    archive = make_archive(1, 3, 50_000)
    for k, point in enumerate(points):
        insert(archive, point, np.array([k], np.int32))
    assert archive.counts[0] == len(points)
    blocks = archive.counts[3]
    touched = [(archive.lows[:blocks] <= point).all(axis=1).sum() for point in points[::100]]
    assert np.mean(touched) < 0.05 * blocks


def test_of_two_objectives_thinning_drops_the_points_that_add_least() -> None:
    archive = make_archive(1, 2, 16)
    for point in [(1, 9), (4, 5), (4.1, 4.9), (4.2, 4.8), (8, 1)]:
        insert(archive, np.array(point, float), np.array([0], np.int32))
    thin(archive)
    left = archive.points[rows_of(archive)].tolist()
    assert [1.0, 9.0] in left
    assert [4.1, 4.9] not in left
