"""Occupancy grids as the message nav_msgs/OccupancyGrid of ROS has them, in JSON.

Other members of the message, such as header and map_load_time, are ignored.
"""

import math

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from service.errors import invalid
from service.requests.arrays import check_size
from service.requests.fields import Items, Number, PositiveInteger, PositiveNumber
from service.requests.maps.pictures import UNKNOWN, Occupancy

_OCCUPIED = 100
_TILT = 1e-3  # at most, of a quaternion about the z axis; and how far it may be from a unit one
_INFO = "occupancy_grid/info"


class _Message(BaseModel):
    model_config = ConfigDict(strict=True, extra="ignore", frozen=True, defer_build=True)


class Point(_Message):
    """The position of the lower left corner of a map, in metres."""

    x: Number
    y: Number


class Quaternion(_Message):
    """The rotation of a map about the z axis, as a quaternion."""

    x: Number = 0.0
    y: Number = 0.0
    z: Number
    w: Number


class Pose(_Message):
    """The position and the rotation of a map."""

    position: Point
    orientation: Quaternion


class MapMetaData(_Message):
    """The size of a map, and where it is."""

    resolution: PositiveNumber = Field(description="side of a cell, in metres")
    width: PositiveInteger
    height: PositiveInteger
    origin: Pose


class OccupancyGrid(_Message):
    """A message nav_msgs/OccupancyGrid."""

    info: MapMetaData
    data: Items[float] = Field(
        description="row by row from the lower left cell: occupancy 0 to 100, or -1 for unknown"
    )

    def origin(self) -> tuple[float, float, float]:
        """Return x, y and the yaw of the lower left corner.

        Raises:
            Refusal: The orientation is not a rotation about the z axis.
        """
        at, turn = self.info.origin.position, self.info.origin.orientation
        length = math.hypot(turn.z, turn.w)
        if abs(length - 1) > _TILT or math.hypot(turn.x, turn.y) > _TILT:
            raise invalid(f"{_INFO}/origin/orientation", "not-upright")
        return at.x, at.y, 2 * math.atan2(turn.z, turn.w)

    def occupancy(self, most_cells: int) -> Occupancy:
        """Return the occupancy of each cell, 0 to 100 or UNKNOWN, with the top row first.

        Raises:
            Refusal: The data are not of width x height cells, or not occupancies; or too many.
        """
        width, height = self.info.width, self.info.height
        check_size(width, height, most_cells)
        if len(self.data) != width * height:
            size = {"width": width, "height": height}
            raise invalid("occupancy_grid/data", "not-width-by-height", **size, came=len(self.data))
        values = np.array(self.data)
        _check(values)
        return np.flipud(values.reshape(height, width)).astype(np.int8)


def _check(values: NDArray[np.float64]) -> None:
    with np.errstate(invalid="ignore"):
        occupancies = (values >= UNKNOWN) & (values <= _OCCUPIED) & (values == np.rint(values))
    if not occupancies.all():
        at = int(occupancies.argmin())
        bounds, came = {"least": UNKNOWN, "most": _OCCUPIED}, float(values[at])
        raise invalid(f"occupancy_grid/data/{at}", "not-an-occupancy", **bounds, came=came)
