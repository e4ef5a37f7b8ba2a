"""Where on an occupancy grid a robot can be."""

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]

_SLACK = 1e-9  # a distance and a radius that differ by no more than rounding are the same


def inflated(blocked: Mask, cell_size: float, radius: float) -> Mask:
    """The cells that are free for a robot of this radius in the unit of the cell size.

    Those whose centre is farther than the radius from the centre of every blocked cell. What lies
    outside the grid blocks nothing.
    """
    if not blocked.any():
        return ~blocked
    distances = cell_size * ndimage.distance_transform_edt(~blocked)
    return distances > radius * (1 + _SLACK)


def regions(free: Mask) -> NDArray[np.int32]:
    """The number of the region that each cell is in, from 1; 0 where it is not free.

    A region is what can be reached without cutting a corner: by straight steps alone.
    """
    return ndimage.label(free, output=np.int32)[0]


def largest_region(free: Mask) -> Mask:
    """The free cells of the region that has most; of equally large ones, of the first."""
    numbered = regions(free)
    sizes = np.bincount(numbered.ravel())
    sizes[0] = 0
    return free & (numbered == sizes.argmax())


def laid_out(region: Mask, spacing: float) -> Cells:
    """Places from which a region is covered, rows and columns, shape (n, 2), row by row.

    The grid-based decomposition of Bormann, Jordan, Hampp and Hägele (2018): squares with sides of
    `spacing` cells are laid over the region from its upper left, and of each square the free cell
    nearest to its middle is a place. So none is farther than the diagonal of a square from one.
    Squares smaller than a cell are as large as a cell.
    """
    spacing = max(spacing, 1.0)
    cells = np.argwhere(region)
    # Cell centres, from the corner of the region's bounding box.
    centres = cells - cells.min(axis=0) + 0.5
    squares = np.floor(centres / spacing).astype(np.int64)
    offsets = np.square(centres - (squares + 0.5) * spacing).sum(axis=1)
    order = np.lexsort((offsets, squares[:, 1], squares[:, 0]))
    ordered = squares[order]
    first = np.concatenate(([True], (ordered[1:] != ordered[:-1]).any(axis=1)))
    return cells[order[first]]
