"""Map frames, in which robots have their poses, and the paths of tours over a map."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Cells = NDArray[np.int64]
Mask = NDArray[np.bool_]
_DIGITS = 6  # points are rounded to this many digits after the first one of a cell's side


@dataclass(frozen=True, kw_only=True)
class MapFrame:
    """The position of a grid in the frame of its map, as in ROS.

    The origin is the pose of the grid's lower left corner (nav_msgs/MapMetaData). The centre of the
    first cell is half a cell away from it, as in costmap_2d. Row 0 of a grid is the top one, as in
    a picture: if the yaw is 0, y falls from row to row.

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

        They are rounded to a millionth of a cell, to keep their JSON short.

        Args:
            cells: Rows and columns, shape (n, 2).
        """
        right = (cells[:, 1] + 0.5) * self.cell_size
        up = (self.rows - cells[:, 0] - 0.5) * self.cell_size
        x, y, yaw = self.origin
        cosine, sine = math.cos(yaw), math.sin(yaw)
        points = np.stack((x + cosine * right - sine * up, y + sine * right + cosine * up), axis=1)
        return points.round(_DIGITS - math.floor(math.log10(self.cell_size)))

    def yaws(self, cells: Cells) -> Array:
        """Return the direction in radians, shape (n,), in which a path leaves each of its cells.

        At its last cell it keeps the direction in which it arrived. A path of one cell looks along
        the rows of the grid. Directions are from -pi to pi, counterclockwise from the x axis.

        Args:
            cells: Rows and columns, shape (n, 2), each beside the one before.
        """
        steps = np.diff(cells, axis=0)
        if not len(steps):
            steps = np.array([[0, 1]])
        steps = np.vstack((steps, steps[-1:]))[: len(cells)]
        yaws = self.origin[2] + np.arctan2(-steps[:, 0], steps[:, 1])
        return np.angle(np.exp(1j * yaws)).round(_DIGITS)

    def cell(self, x: float, y: float) -> tuple[int, int]:
        """Return the row and column of the cell at a point. It may lie outside the grid.

        >>> MapFrame(origin=(-10.0, -10.0, 0.0), cell_size=0.05, rows=384).cell(-1.98, -0.52)
        (194, 160)
        """
        left, bottom, yaw = self.origin
        cosine, sine = math.cos(yaw), math.sin(yaw)
        right = cosine * (x - left) + sine * (y - bottom)
        up = cosine * (y - bottom) - sine * (x - left)
        column = math.floor(right / self.cell_size)
        return self.rows - 1 - math.floor(up / self.cell_size), column


@dataclass(frozen=True, eq=False)
class CoveragePath:
    """The path of a tour over a map.

    Args:
        cells: Rows and columns, shape (m, 2). The path of a closed tour ends at its first cell.
        metres: The length.
        visits: The index in `cells` and the place, shape (k, 2), for each place in the order of the
            tour, back to the first if it is closed. All other cells are on the way.
        frame: The frame of the map, if it is known.
    """

    cells: Cells
    metres: float
    visits: Cells
    frame: MapFrame | None = None
