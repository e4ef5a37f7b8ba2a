"""Where cells are in the frame of a map, beside the tests' own way of counting from below."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.coverage.frame import MapFrame

YAWS = st.floats(-math.pi, math.pi)


def point_of(cell: tuple[int, int], frame: MapFrame) -> complex:
    """The middle of a cell as x + iy: up and to the right from the corner, then turned."""
    x, y, yaw = frame.origin
    row_from_below = frame.rows - 1 - cell[0]
    inside = complex((cell[1] + 0.5), (row_from_below + 0.5)) * frame.cell_size
    return complex(x, y) + inside * complex(math.cos(yaw), math.sin(yaw))


@given(
    origin=st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), YAWS),
    cell_size=st.sampled_from([0.01, 0.05, 0.3, 2.0]),
    rows=st.integers(1, 500),
    column=st.integers(0, 500),
    data=st.data(),
)
def test_the_middle_of_a_cell_is_where_it_is_and_in_that_cell(
    origin: tuple[float, float, float],
    cell_size: float,
    rows: int,
    column: int,
    data: st.DataObject,
) -> None:
    cell = (data.draw(st.integers(0, rows - 1)), column)
    frame = MapFrame(origin=origin, cell_size=cell_size, rows=rows)
    [[x, y]] = frame.points(np.array([cell])).tolist()
    assert abs(complex(x, y) - point_of(cell, frame)) < 1e-5 * cell_size + 1e-9
    assert frame.cell(x, y) == cell


STEPS = st.tuples(st.integers(-1, 1), st.integers(-1, 1)).filter(any)


@given(yaw=YAWS, steps=st.lists(STEPS, max_size=20))
def test_a_robot_leaves_each_cell_towards_the_next_and_keeps_its_last_direction(
    yaw: float, steps: list[tuple[int, int]]
) -> None:
    frame = MapFrame(origin=(3.0, -2.0, yaw), cell_size=0.5, rows=60)
    cells = 30 + np.cumsum([(0, 0), *steps], axis=0)
    yaws = frame.yaws(cells)
    assert yaws.shape == (len(cells),)
    assert (np.abs(yaws) < math.pi + 1e-6).all()
    moves = np.diff([point_of((row, column), frame) for row, column in cells.tolist()])
    moves = moves if len(moves) else np.exp([1j * yaw])
    towards = np.append(moves, moves[-1])[: len(cells)]
    np.testing.assert_allclose(np.exp(1j * yaws), towards / np.abs(towards), atol=1e-5)


def test_the_map_of_turtlebot_has_its_robot_where_it_starts() -> None:
    # ROBOTIS-GIT/turtlebot3: turtlebot3_navigation2/map has 384 x 384 cells of 0.05 m from
    # (-10, -10); its simulation starts at (-2, -0.5), the corner of four cells.
    frame = MapFrame(origin=(-10.0, -10.0, 0.0), cell_size=0.05, rows=384)
    assert frame.points(np.array([[193, 160], [194, 159]])).tolist() == [
        [-1.975, -0.475],
        [-2.025, -0.525],
    ]
    assert frame.points(np.array([[0, 0], [383, 383]])).tolist() == [
        [-9.975, 9.175],
        [9.175, -9.975],
    ]
    assert frame.cell(-1.99, -0.49) == (193, 160)


def test_a_quarter_turn_swaps_the_axes() -> None:
    frame = MapFrame(origin=(1.0, 2.0, math.pi / 2), cell_size=1.0, rows=2)
    np.testing.assert_allclose(frame.points(np.array([[1, 0], [1, 3], [0, 0]])), [
        [0.5, 2.5],
        [0.5, 5.5],
        [-0.5, 2.5],
    ])  # fmt: skip
    assert frame.cell(0.5, 5.4) == (1, 3)


@pytest.mark.parametrize("point", [(-0.1, 0), (0, -0.1), (4.1, 0), (0, 2.1), (-1e150, 1e150)])
def test_a_point_beside_the_map_is_in_none_of_its_cells(point: tuple[float, float]) -> None:
    row, column = MapFrame(origin=(0.0, 0.0, 0.0), cell_size=1.0, rows=2).cell(*point)
    assert not (0 <= row < 2 and 0 <= column < 4)


@pytest.mark.parametrize("cell_size", [1e-150, 1e-9, 1.0, 1e9, 1e150])
def test_points_are_finite_at_any_size(cell_size: float) -> None:
    frame = MapFrame(origin=(1e150, -1e150, 1.0), cell_size=cell_size, rows=1000)
    assert np.isfinite(frame.points(np.array([[0, 999]]))).all()
    frame = MapFrame(origin=(0.0, 0.0, 0.0), cell_size=cell_size, rows=1)
    np.testing.assert_allclose(
        frame.points(np.array([[0, 1]])), [[1.5 * cell_size, 0.5 * cell_size]]
    )
