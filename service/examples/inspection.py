"""A drone inspects a power line over hills: metres over ground beside metres of climb."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PYLONS = 16
SPAN = 240.0  # metres between two pylons
HANGING = np.array([18.0, 26.0, 34.0])  # insulators of a pylon, in metres above its foot
HILLS = np.array(
    [  # x, y, reach and height in metres
        [700.0, 300.0, 350.0, 120.0],
        [1600.0, -200.0, 450.0, 180.0],
        [2700.0, 250.0, 400.0, 90.0],
        [3400.0, -100.0, 300.0, 140.0],
    ]
)


def inspection() -> dict[str, Any]:
    """Return the request: the landing pad first, then three insulators of every pylon.

    Plane 1 is the map in metres. Plane 2 has the altitude alone, so that the distance between two
    places is how far the drone climbs or descends; half of a closed tour's length is the climb.
    """
    feet = _line(np.random.default_rng(3))
    pad = feet[PYLONS // 2] + (0.0, -400.0)
    ground = np.concatenate((pad[np.newaxis], feet.repeat(len(HANGING), axis=0)))
    altitudes = _terrain(ground) + np.concatenate(([0.0], np.tile(HANGING, PYLONS)))
    coordinates = np.column_stack((ground, altitudes, np.zeros(len(ground))))
    return {"coordinates": coordinates.round(1).tolist(), "time_limit": 1.0, "seed": 1}


def _line(rng: np.random.Generator) -> Array:
    """Return the places of the pylons, shape (PYLONS, 2): eastward, with random turns."""
    turns = rng.normal(0.0, 0.5, PYLONS)
    steps = SPAN * np.column_stack((np.cos(turns), np.sin(turns)))
    return steps.cumsum(axis=0)


def _terrain(places: Array) -> Array:
    """Return the height of the ground above the sea, shape (n,), at places, shape (n, 2)."""
    squared = ((places[:, np.newaxis] - HILLS[:, :2]) ** 2).sum(axis=-1)
    return 210.0 + (HILLS[:, 3] * np.exp(-squared / (2 * HILLS[:, 2] ** 2))).sum(axis=1)
