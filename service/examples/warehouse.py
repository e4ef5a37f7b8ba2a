"""A cleaning robot's round through a warehouse: metres driven beside people met."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CELL = 0.5  # metres
ROWS, COLUMNS = 40, 64
BLOCKS = ((5, 21), (25, 41), (45, 59))  # columns of the racks, from and to
# The aisles by which people walk to packing: metres from the left, and people per minute.
CROSS_AISLES = ((11.25, 8.0), (21.5, 2.0))


def cleaning() -> dict[str, Any]:
    """Return the request: the map, places 3 m apart, and a cost layer of people."""
    return {
        "cell_size": CELL,
        "robot_radius": 0.6,
        "spacing": 3.0,
        "paths": True,
        "time_limit": 1.0,
        "seed": 1,
        "grid": _grid().tolist(),
        "cost_layer": _people().round(2).tolist(),
    }


def _grid() -> NDArray[np.int64]:
    """Return the map: walls, six rows of racks in three blocks, the packing station at the top."""
    grid = np.zeros((ROWS, COLUMNS), dtype=np.int64)
    grid[[0, -1]] = 1
    grid[:, [0, -1]] = 1
    for top in range(6, 33, 5):
        for left, right in BLOCKS:
            grid[top : top + 2, left:right] = 1
    grid[1:4, 28:36] = 1
    return grid


def _people() -> Array:
    """Return the number of people near each cell: most in the cross aisles, halfway down."""
    y, x = CELL * np.mgrid[0:ROWS, 0:COLUMNS]
    people = np.full(y.shape, 0.05)
    for middle, people_per_minute in CROSS_AISLES:
        people += people_per_minute * np.exp(-(((y - 10) / 8) ** 2 + ((x - middle) / 0.8) ** 2) / 2)
    return people
