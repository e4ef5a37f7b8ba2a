"""The places of a task: those of a caller, of a spacing, and of the poses of a robot."""

from typing import Any

import numpy as np
import pytest

from service.coverage.coverage import Coverage
from service.coverage.grid import free_cells, regions
from service.coverage.places import Places, find_places
from service.errors import InvalidCoverage, TooManyPlaces
from service.instance import RouteEnds

# Two rooms with a wall between, the smaller one at the left: 1 is an obstacle.
ROOMS = np.array(
    [
        [0, 0, 1, 0, 0, 0],
        [0, 0, 1, 0, 0, 0],
        [0, 0, 1, 0, 0, 0],
    ],
    dtype=np.bool_,
)
GIVEN = np.array([[0, 3], [2, 5], [0, 3]])
LAYER = np.ones(ROOMS.shape)


def places(max_places: int = 50, **members: Any) -> Places:
    task = {
        "blocked": ROOMS,
        "cell_size": 1.0,
        "origin": (10.0, 20.0, 0.0),
        "cost_layers": LAYER[np.newaxis],
    }
    coverage = Coverage(**{**task, **members})
    free = free_cells(coverage.blocked, coverage.cell_size, coverage.robot_radius)
    return find_places(coverage, free, max_places)


def fault(**members: Any) -> tuple[str, str]:
    with pytest.raises(InvalidCoverage) as refused:
        places(**members)
    [found] = refused.value.faults
    return str(found.part), found.demand


def test_a_pose_becomes_a_place_behind_the_others_and_the_start() -> None:
    found = places(places=GIVEN, start_pose=(14.5, 21.5))
    assert found.cells.tolist() == [*GIVEN.tolist(), [1, 4]]
    assert found.start == 3


def test_a_pose_at_a_place_is_that_place() -> None:
    found = places(places=GIVEN, start_pose=(13.2, 22.9, 1.57))
    assert (found.cells.tolist(), found.start) == (GIVEN.tolist(), 0)


@pytest.mark.parametrize("pose", [(10.5, 20.5), (13.5, 22.5)])
def test_a_spacing_covers_the_region_of_the_robot(pose: tuple[float, float]) -> None:
    found = places(spacing=1.0, start_pose=pose)
    region = regions(~ROOMS)
    row, column = found.cells[found.start]
    assert {tuple(cell) for cell in found.cells.tolist()} == {
        tuple(cell) for cell in np.argwhere(region == region[row, column]).tolist()
    }
    assert (column + 10.5, 22.5 - row) == pose


def test_without_a_pose_a_spacing_covers_the_largest_region() -> None:
    found = places(spacing=1.0)
    assert (found.cells[:, 1].min(), len(found.cells), found.start) == (3, 9, 0)


@pytest.mark.parametrize(
    ("members", "sentence"),
    [
        ({"start_pose": (9.9, 20.5)}, "must be a cell of the grid of 3 x 6 cells, got [2, -1]"),
        ({"start_pose": (1e150, 0)}, "must be a cell of the grid of 3 x 6 cells, got [22, 1e+150]"),
        ({"start_pose": (12.5, 20.5)}, "must be a free cell, and [2, 2] is an obstacle"),
        (
            {"start_pose": (13.5, 20.5), "robot_radius": 1.0, "places": GIVEN[1:2]},
            "must be a cell farther than 1 m from every obstacle, and [2, 3] is not",
        ),
        (
            {"start_pose": (14.5, 20.5), "cost_layers": None, "second_matrix": np.zeros((3, 3))},
            "must be in the cell of a place, as only a cost layer has costs of other cells",
        ),
        (
            {"start_pose": (14.5, 20.5), "origin": None},
            "must be in the frame of a map with an origin",
        ),
    ],
)
def test_a_pose_where_no_tour_can_begin_is_named(members: dict[str, Any], sentence: str) -> None:
    assert fault(**{"places": GIVEN, **members}) == ("start_pose", sentence)


def test_the_poses_are_the_ends_of_open_routes() -> None:
    anywhere = RouteEnds(closed=False, start=None, end=None)
    found = places(
        places=GIVEN, ends=anywhere, start_pose=(14.5, 21.5), end_pose=(15.5, 20.5, 1.57)
    )
    assert found.cells.tolist() == [*GIVEN.tolist(), [1, 4]]
    assert (found.start, found.ends) == (3, RouteEnds(closed=False, start=3, end=1))
    found = places(places=GIVEN, ends=anywhere, end_pose=(14.5, 21.5))
    assert found.ends == RouteEnds(closed=False, start=None, end=3)
    found = places(spacing=1.0, ends=anywhere, end_pose=(10.5, 20.5))
    assert (len(found.cells), found.cells[found.ends.end].tolist()) == (6, [2, 0])


def test_an_open_route_does_not_end_in_the_cell_where_it_starts() -> None:
    ends = RouteEnds(closed=False, start=0, end=None)
    poses = {"start_pose": (14.5, 21.5), "end_pose": (14.4, 21.4)}
    assert fault(places=GIVEN, ends=ends, **poses) == (
        "end_pose",
        "must not be the start, or tours are closed, got place 3",
    )


def test_an_end_that_the_robot_cannot_reach_is_named() -> None:
    ends = RouteEnds(closed=False, start=0, end=None)
    assert fault(places=GIVEN, ends=ends, end_pose=(10.5, 20.5)) == (
        "end_pose",
        "must be reachable from places/0, and no path leads there",
    )


def test_a_place_that_the_robot_cannot_reach_is_named() -> None:
    assert fault(places=GIVEN[:1], start_pose=(10.5, 20.5)) == (
        "places/0",
        "must be reachable from start_pose, and no path leads there",
    )


def test_a_pose_at_a_place_needs_no_costs_of_its_own() -> None:
    found = places(
        places=GIVEN, start_pose=(15.5, 20.5), cost_layers=None, second_matrix=np.zeros((3, 3))
    )
    assert found.start == 1


def test_the_place_of_a_pose_counts_as_one() -> None:
    with pytest.raises(TooManyPlaces) as refused:
        places(max_places=1, spacing=9.0, start_pose=(13.5, 20.5))
    assert (refused.value.limit, refused.value.actual) == (1, 2)
