"""Instances drawn at random: planes of several shapes, and coverage maps."""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from service.coverage.grid import largest_region
from service.coverage.shortest_paths import cell_numbers, make_grid, pairwise_paths

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Cells = NDArray[np.int64]


def uniform(n: int, generator: Generator) -> Array:
    """Draw cities anywhere in the unit square, shape (n, 2)."""
    return generator.random((n, 2))


def clustered(n: int, generator: Generator) -> Array:
    """Draw cities in two to seven Gaussian clusters, which may overlap."""
    centres = generator.random((generator.integers(2, 8), 2))
    cities = centres[generator.integers(len(centres), size=n)]
    return _in_unit_square(cities + generator.normal(scale=0.07, size=(n, 2)))


def stretched(n: int, generator: Generator) -> Array:
    """Draw cities evenly in a box whose long side is up to ten times the other."""
    sides = np.array([1.0, 10 ** -generator.random()])
    return generator.random((n, 2)) * generator.permutation(sides)


def streets(n: int, generator: Generator) -> Array:
    """Draw cities along the streets of a grid, three to ten in either direction."""
    cities = generator.random((n, 2))
    across = np.arange(n), generator.integers(2, size=n)
    count = generator.integers(3, 11)
    cities[across] = np.rint(cities[across] * (count - 1)) / (count - 1)
    return cities


def _in_unit_square(cities: Array) -> Array:
    # If all cities are at one place, nothing can be scaled.
    return (cities - cities.min(axis=0)) / max(np.ptp(cities, axis=0).max(), np.finfo(float).tiny)


PLANES: dict[str, Callable[[int, Generator], Array]] = {
    draw.__name__: draw for draw in (uniform, clustered, stretched, streets)
}


Span = tuple[int, int]

SIDE = 64  # cells, as PathBench's maps have
MAPS = ("random", "blocks", "house")
_FILL = (0.1, 0.3)  # least and largest share of cells that are obstacles
_BLOCK = (3, 12)  # least and largest side of a block
_ROOM = 9  # no side of a room is shorter
_DOOR = 3


def coverage_matrices(generator: Generator, n: int, side: int = SIDE) -> Array:
    """Draw costs, shape (2, n, n), between n random places on a map of a random kind.

    The first are lengths of shortest paths, in cells; the second, distances between random points
    of the unit square.
    """
    free, places = coverage_map(generator, n, side)
    grid = make_grid(free)
    lengths, _ = pairwise_paths(grid, cell_numbers(grid, places), lambda: False)
    return np.stack((lengths, uniform_distances(generator, n)))


def coverage_map(generator: Generator, n: int, side: int = SIDE) -> tuple[Mask, Cells]:
    """Draw a map: its free cells as a mask, shape (side, side), and n of them, shape (n, 2).

    These are different and in one region. A map whose largest region is too small is drawn again.
    """
    while True:
        free = drawn_map(generator, MAPS[generator.integers(len(MAPS))], side)
        cells = np.argwhere(largest_region(free))
        if len(cells) >= n:
            return free, generator.permutation(cells)[:n]


def drawn_map(generator: Generator, kind: str, side: int) -> Mask:
    """Draw the mask of free cells, shape (side, side), of a map of this kind.

    Raises:
        ValueError: the kind is unknown.
    """
    match kind:
        case "random":
            return generator.random((side, side)) >= generator.uniform(*_FILL)
        case "blocks":
            return _blocks(generator, side)
        case "house":
            house = np.pad(np.ones((side, side), np.bool_), 1)
            _divide(generator, house, (1, side + 1), (1, side + 1))
            return house[1:-1, 1:-1]
    raise ValueError(f"kind must be one of {', '.join(MAPS)}, got {kind!r}")


def uniform_distances(generator: Generator, n: int) -> Array:
    """Draw distances, shape (n, n), between points uniform in the unit square."""
    points = generator.random((n, 2))
    return np.hypot(*(points[:, np.newaxis] - points).transpose(2, 0, 1))


def _blocks(generator: Generator, side: int) -> Mask:
    free = np.ones((side, side), np.bool_)
    fill = generator.uniform(*_FILL)
    while free.mean() > 1 - fill:
        row, column = generator.integers(side, size=2)
        height, width = generator.integers(*_BLOCK, size=2, endpoint=True)
        free[row : row + height, column : column + width] = False
    return free


def _divide(generator: Generator, house: Mask, rows: Span, columns: Span) -> None:
    """Divide a room by a wall with a door, and each part again as long as there is space."""
    if columns[1] - columns[0] > rows[1] - rows[0]:
        house, rows, columns = house.T, columns, rows
    (top, bottom), (left, right) = rows, columns
    # A wall may not end at a door of another.
    walls = [
        row
        for row in range(top + _ROOM, bottom - _ROOM)
        if not (house[row, left - 1] or house[row, right])
    ]
    if not walls:
        return
    wall = int(generator.choice(walls))
    door = generator.integers(left, right - _DOOR, endpoint=True)
    house[wall, left:right] = False
    house[wall, door : door + _DOOR] = True
    _divide(generator, house, (top, wall), columns)
    _divide(generator, house, (wall + 1, bottom), columns)
