"""Occupancy grids: free cells, their regions, places that cover one, and regions out of reach."""

import numpy as np
from numpy.typing import NDArray
from paretour.values import Uncovered, UncoveredRegion

from service.coverage.frame import Cells, Mask

_LONGEST = 2.0**30  # cells of a side, beyond any grid, and its square is finite
_SLACK = 1e-9  # relative: a distance and a radius that differ by less count as equal
_MOST_REGIONS = 20  # the most regions out of reach that are described


def free_cells(blocked: Mask, cell_size: float, robot_radius: float) -> Mask:
    """Return the cells that are free for a robot: those outside of the inflated obstacles.

    The centre of a free cell is farther than the radius from the centre of every blocked cell.
    All cells outside the grid are free. O(cells).

    Args:
        blocked: Obstacles, shape (rows, columns).
        cell_size: The side of a cell, in any unit.
        robot_radius: The radius of the robot, in the same unit.
    """
    if not blocked.any():
        return ~blocked
    from scipy import ndimage  # imported late: it takes 0.3 s, and few requests have a map

    distances = cell_size * ndimage.distance_transform_edt(~blocked)
    return distances > robot_radius * (1 + _SLACK)


def regions(free: Mask) -> NDArray[np.int32]:
    """Return the number of each cell's region, from 1; 0 for cells that are not free.

    A region is a connected component: a robot can reach each of its cells from every other one
    over the four sides of cells, without cutting a corner.
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

    The grid-based decomposition of Bormann, Jordan, Hampp and Hägele (2018): squares divide the
    region from its upper left. In each square, the free cell nearest to the middle is a place. So
    no cell is farther from a place than the diagonal of a square.

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


def uncovered(free: Mask, cell: Cells, cell_size: float) -> Uncovered:
    """Return the free cells that no path joins to a cell, shape (2,). O(cells).

    Args:
        free: The cells that are free for the robot, shape (rows, columns).
        cell: A free cell.
        cell_size: The side of a cell, in metres.
    """
    from scipy import ndimage

    numbers = regions(free)
    sizes = np.bincount(numbers.ravel())
    sizes[[0, numbers[tuple(cell)]]] = 0
    largest = np.argsort(-sizes, kind="stable")[:_MOST_REGIONS]
    largest = largest[sizes[largest] > 0]
    # Only these are numbered: there may be hundreds of thousands of regions.
    places = np.zeros(len(sizes), np.int32)
    places[largest] = np.arange(1, len(largest) + 1)
    numbered = places[numbers]
    boxes = ndimage.find_objects(numbered, max_label=len(largest))
    total = int(sizes.sum())
    return Uncovered(
        cells=total,
        square_metres=total * cell_size**2,
        regions=tuple(
            _described(numbered[box] == place, box) for place, box in enumerate(boxes, start=1)
        ),
    )


def _described(inside: Mask, box: tuple[slice, slice]) -> UncoveredRegion:
    """Return the region of the cells that are inside a box."""
    (top, bottom), (left, right) = ((side.start, side.stop - 1) for side in box)
    cells = np.argwhere(inside)
    row, column = cells[len(cells) // 2].tolist()
    return UncoveredRegion(
        cells=len(cells),
        cell=(top + row, left + column),
        box=((top, left), (bottom, right)),
    )
