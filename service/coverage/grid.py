"""Occupancy grids: the cells free for a robot, their regions, and places that cover a region."""

import numpy as np
from numpy.typing import NDArray

Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]

_LONGEST = 2.0**30  # cells of a side, beyond any grid, and its square is finite
_SLACK = 1e-9  # relative: a distance and a radius that differ by less count as equal


def free_cells(blocked: Mask, cell_size: float, robot_radius: float) -> Mask:
    """Return the cells that are free for a robot: the complement of the inflated obstacles.

    The centre of a free cell is farther than the radius from the centre of every blocked cell.
    Outside the grid there are no obstacles. O(cells).

    Args:
        blocked: Obstacles, shape (rows, columns).
        cell_size: The side of a cell, in any unit.
        robot_radius: In the same unit.
    """
    if not blocked.any():
        return ~blocked
    from scipy import ndimage  # here, as it takes a process 0.3 s, and few requests have a map

    distances = cell_size * ndimage.distance_transform_edt(~blocked)
    return distances > robot_radius * (1 + _SLACK)


def regions(free: Mask) -> NDArray[np.int32]:
    """Return the number of each cell's region, from 1; 0 for cells that are not free.

    A region is a connected component of the free cells over their four sides: the cells that a
    robot can reach from one another without cutting a corner.
    """
    from scipy import ndimage

    return ndimage.label(free, output=np.int32)[0]


def largest_region(free: Mask) -> Mask:
    """Return the cells of the region with the most cells, the first of equally large ones."""
    numbers = regions(free)
    sizes = np.bincount(numbers.ravel())
    sizes[0] = 0
    return free & (numbers == sizes.argmax())


def region_of(free: Mask, cell: Cells) -> Mask:
    """Return the cells of the region of a free cell, shape (2,)."""
    numbers = regions(free)
    return numbers == numbers[tuple(cell)]


def covering_places(region: Mask, spacing: float) -> Cells:
    """Return places that cover a region: rows and columns, shape (n, 2), row by row.

    The grid-based decomposition of Bormann, Jordan, Hampp and Hägele (2018): the region is divided
    into squares from its upper left, and of each square the free cell nearest to its middle is a
    place. So no cell is farther from a place than the diagonal of a square.

    Args:
        region: The cells to cover, shape (rows, columns).
        spacing: The side of a square in cells; below 1 it counts as 1.
    """
    spacing = min(max(spacing, 1.0), _LONGEST)
    cells = np.argwhere(region)
    # Cell centres, from the corner of the region's bounding box.
    centres = cells - cells.min(axis=0) + 0.5
    squares = np.floor(centres / spacing).astype(np.int64)
    offsets = np.square(centres - (squares + 0.5) * spacing).sum(axis=1)
    order = np.lexsort((offsets, squares[:, 1], squares[:, 0]))
    ordered = squares[order]
    first = np.concatenate(([True], (ordered[1:] != ordered[:-1]).any(axis=1)))
    return cells[order[first]]
