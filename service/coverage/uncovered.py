"""The free cells that no tour comes to, because no path leads there: closed rooms."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.grid import regions

_MOST_REGIONS = 20  # that are described


@dataclass(frozen=True, kw_only=True)
class UncoveredRegion:
    """A region that is out of reach.

    Attributes:
        cells: How many cells it has.
        cell: The row and column of one of them.
        box: The row and column of the first and of the last cell of its bounding box.
    """

    cells: int
    cell: tuple[int, int]
    box: tuple[tuple[int, int], tuple[int, int]]


@dataclass(frozen=True, kw_only=True)
class Uncovered:
    """All free cells out of reach.

    Attributes:
        cells: How many there are.
        square_metres: Their area.
        regions: The largest regions that they form, the largest first.
    """

    cells: int
    square_metres: float
    regions: tuple[UncoveredRegion, ...]


def uncovered(free: NDArray[np.bool_], cell: NDArray[np.int64], cell_size: float) -> Uncovered:
    """Return the free cells that no path joins to a cell, shape (2,). O(cells).

    Args:
        free: The cells that are free for the robot, shape (rows, columns).
        cell: A free cell.
        cell_size: The side of a cell, in metres.
    """
    from scipy import ndimage  # as in the module grid

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


def _described(inside: NDArray[np.bool_], box: tuple[slice, slice]) -> UncoveredRegion:
    """Return the region of the cells that are inside a box."""
    (top, bottom), (left, right) = ((side.start, side.stop - 1) for side in box)
    cells = np.argwhere(inside)
    row, column = cells[len(cells) // 2].tolist()
    return UncoveredRegion(
        cells=len(cells),
        cell=(top + row, left + column),
        box=((top, left), (bottom, right)),
    )
