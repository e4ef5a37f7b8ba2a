"""Map frames: where the cells of a grid lie in the frame that a robot's poses are in."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Cells = NDArray[np.int64]

_DIGITS = 6  # after the first one of a cell's side, to which points are rounded


@dataclass(frozen=True, kw_only=True)
class MapFrame:
    """Where a grid lies in the frame of its map, as ROS has it.

    The origin is the pose of the grid's lower left corner (nav_msgs/MapMetaData, and costmap_2d,
    whose cells have their centres half a cell from it). Row 0 of a grid is its top one, as in a
    picture, so rows count against y, where the yaw is 0.

    Args:
        origin: x and y in metres, and the yaw in radians, counterclockwise.
        cell_size: The side of a cell, in metres.
        rows: The number of rows of the grid.
    """

    origin: Sequence[float]
    cell_size: float
    rows: int

    def points(self, cells: Cells) -> Array:
        """Return x and y in metres, shape (n, 2), of the centres of cells.

        They are rounded to a millionth of a cell, which keeps their JSON short.

        Args:
            cells: Rows and columns, shape (n, 2).
        """
        right = (cells[:, 1] + 0.5) * self.cell_size
        up = (self.rows - cells[:, 0] - 0.5) * self.cell_size
        x, y, yaw = self.origin
        cosine, sine = math.cos(yaw), math.sin(yaw)
        points = np.stack((x + cosine * right - sine * up, y + sine * right + cosine * up), axis=1)
        return points.round(_DIGITS - math.floor(math.log10(self.cell_size)))

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return the row and column of the cell around a point, which may lie beside the grid.

        >>> MapFrame(origin=(-10.0, -10.0, 0.0), cell_size=0.05, rows=384).cell(-1.98, -0.52)
        (194, 160)
        """
        left, bottom, yaw = self.origin
        cosine, sine = math.cos(yaw), math.sin(yaw)
        right = cosine * (x - left) + sine * (y - bottom)
        up = cosine * (y - bottom) - sine * (x - left)
        column = math.floor(right / self.cell_size)
        return self.rows - 1 - math.floor(up / self.cell_size), column
