"""The archive holds the nondominated points and their tours."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.pareto import hypervolume, nondominated
from service.search.archive import best_point, dominated_area, insert, make_archive, thin

POINTS = st.lists(st.tuples(st.integers(1, 12), st.integers(1, 12)), min_size=1, max_size=40)


@given(points=POINTS)
def test_the_archive_holds_just_the_nondominated_points_and_their_tours(
    points: list[tuple[int, int]],
) -> None:
    archive = make_archive(1, 64)
    for k, (first, second) in enumerate(points):
        insert(archive, (float(first), float(second)), np.array([k], np.int32))
    kept = np.array(points, float)[nondominated(np.array(points, float))]
    size = archive.counts[0]
    assert np.array_equal(archive.points[:size], kept)
    owners = archive.tours[archive.slots[:size], 0]
    assert np.array_equal(np.array(points, float)[owners], kept)
    assert dominated_area(archive, 13.0, 13.0) == pytest.approx(
        169 * hypervolume(kept, np.full(2, 13.0))
    )
    # Powers of two, so that equal sums are equal to the last bit.
    assert best_point(archive, 0.25, 0.75) == np.argmin(kept @ [0.25, 0.75])


def test_a_full_archive_makes_room_and_keeps_its_ends() -> None:
    archive = make_archive(1, 16)
    for k in range(60):
        insert(archive, (1.0 + k, 100.0 - k), np.array([k], np.int32))
    size = archive.counts[0]
    assert 4 <= size <= 16
    assert archive.points[0].tolist() == [1.0, 100.0]
    assert archive.points[size - 1].tolist() == [60.0, 41.0]
    assert np.array_equal(archive.tours[archive.slots[:size], 0] + 1, archive.points[:size, 0])


def test_thinning_drops_the_points_that_add_least() -> None:
    archive = make_archive(1, 16)
    for first, second in [(1, 9), (4, 5), (4.1, 4.9), (4.2, 4.8), (8, 1)]:
        insert(archive, (float(first), float(second)), np.array([0], np.int32))
    thin(archive)
    assert [1.0, 9.0] in archive.points[: archive.counts[0]].tolist()
    assert [4.1, 4.9] not in archive.points[: archive.counts[0]].tolist()
