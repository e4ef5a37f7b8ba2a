"""Occupancy grids of ROS in JSON: which way up they are, and every refusal."""

import math
from typing import Any

import numpy as np
import pytest

from service.errors import Refusal
from service.requests.maps.occupancy_grid import OccupancyGrid

ORIGIN = {
    "position": {"x": -1.5, "y": 2.0, "z": 0.0},
    "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
}
INFO = {"resolution": 0.5, "width": 3, "height": 2, "origin": ORIGIN}
# As rosbridge has it: the row at the bottom comes first.
MESSAGE: dict[str, Any] = {
    "header": {"frame_id": "map", "stamp": {"sec": 1, "nanosec": 2}},
    "info": {**INFO, "map_load_time": {"sec": 0, "nanosec": 0}},
    "data": [0, 1, 2, 100, -1, 50],
}


def message(**info: Any) -> OccupancyGrid:
    return OccupancyGrid.model_validate({**MESSAGE, "info": {**INFO, **info}})


def test_the_first_row_of_data_is_the_bottom_of_the_map() -> None:
    found = OccupancyGrid.model_validate(MESSAGE).occupancy(6)
    np.testing.assert_array_equal(found, [[100, -1, 50], [0, 1, 2]])


@pytest.mark.parametrize("yaw", [0.0, 0.3, math.pi / 2, -2.5])
@pytest.mark.parametrize("sign", [1, -1])
def test_the_yaw_is_that_of_the_quaternion(yaw: float, sign: int) -> None:
    turn = {"x": 0.0, "y": 0.0, "z": sign * math.sin(yaw / 2), "w": sign * math.cos(yaw / 2)}
    x, y, found = message(origin={**ORIGIN, "orientation": turn}).origin()
    assert (x, y) == (-1.5, 2.0)
    assert math.remainder(found - yaw, 2 * math.pi) == pytest.approx(0)


@pytest.mark.parametrize(
    "turn",
    [
        {"x": 0.0, "y": 0.0, "z": 0.0, "w": 0.0},
        {"x": 0.7, "y": 0.0, "z": 0.0, "w": 0.7},
        {"x": 0.1, "y": 0.0, "z": 0.0, "w": 1.0},
        {"x": 0.0, "y": 0.0, "z": 1.0, "w": 1.0},
    ],
)
def test_a_map_that_lies_in_no_plane_is_refused(turn: dict[str, float]) -> None:
    with pytest.raises(Refusal) as refused:
        message(origin={**ORIGIN, "orientation": turn}).origin()
    assert refused.value.detail == (
        "occupancy_grid/info/origin/orientation must be a unit quaternion about z"
    )


@pytest.mark.parametrize(
    ("value", "shown"), [(101, "101"), (-2, "-2"), (0.5, "0.5"), (math.nan, "nan"), (1e400, "inf")]
)
def test_data_that_are_no_occupancies_are_named(value: float, shown: str) -> None:
    grid = OccupancyGrid.model_validate({**MESSAGE, "data": [0.0, 0.0, 0.0, value, 0.0, 0.0]})
    with pytest.raises(Refusal) as refused:
        grid.occupancy(6)
    assert refused.value.detail == (
        f"occupancy_grid/data/3 must be a whole number, -1 to 100, got {shown}"
    )


def test_data_are_of_as_many_cells_as_the_size_says() -> None:
    with pytest.raises(Refusal, match="data must have 3 x 3 numbers, got 6"):
        message(height=3).occupancy(9)
    with pytest.raises(Refusal) as refused:
        message(width=2**31 - 1, height=2**31 - 1).occupancy(6)
    assert (refused.value.code, refused.value.limit) == ("too-many-cells", 6)
