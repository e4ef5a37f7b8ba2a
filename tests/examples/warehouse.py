"""Cleaning a warehouse: one robot's metres beside people passed; three robots that share it."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CELL = 0.5  # metres
ROWS, COLUMNS = 40, 64
# Where three robots start: x and y in metres from the lower left corner.
DOCKS = {"north-west": (1.75, 18.25), "north-east": (30.25, 18.25), "south": (16.25, 1.75)}
BLOCKS = ((5, 21), (25, 41), (45, 59))  # columns of the racks, from and to
# The aisles by which people walk to packing: metres from the left, and people per minute.
CROSS_AISLES = ((11.25, 8.0), (21.5, 2.0))


def cleaning() -> dict[str, Any]:
    """Return the request: the map, places 3 m apart, a cost layer of people, and ways round it."""
    return {
        "cell_size": CELL,
        "robot_radius": 0.6,
        "spacing": 3.0,
        "detours": True,
        "paths": True,
        "time_limit": 1.0,
        "seed": 1,
        "grid": _grid().tolist(),
        "cost_layer": _people().round(2).tolist(),
    }


def shared() -> dict[str, Any]:
    """Return the request for three robots that share the same places; both lengths are metres."""
    return {
        "cell_size": CELL,
        "origin": [0.0, 0.0, 0.0],
        "robot_radius": 0.6,
        "spacing": 3.0,
        "robots": [{"id": name, "start_pose": list(pose)} for name, pose in DOCKS.items()],
        "paths": True,
        "time_limit": 2.0,
        "seed": 1,
        "grid": _grid().tolist(),
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
