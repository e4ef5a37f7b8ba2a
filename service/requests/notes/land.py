"""The land of the earth, in cells of half a degree.

A cell is land if any of its area is, islands too, and the land is north of 60 degrees south. Made
from the land of Natural Earth at a scale of 1:10 million, which is in the public domain.
"""

import zlib
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_PER_DEGREE = 2
_ROWS, _COLUMNS = 180 * _PER_DEGREE, 360 * _PER_DEGREE  # from the north, and from the west
_FILE = Path(__file__).with_name("land.bin")


def on_land(places: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which places lie on land; those that are not on the earth do not.

    Args:
        places: Longitude and latitude of each in degrees, shape (n, 2).
    """
    rows = np.floor((90 - places[:, 1]) * _PER_DEGREE)
    columns = np.floor((places[:, 0] + 180) * _PER_DEGREE)
    on_earth = (np.abs(places[:, 0]) <= 180) & (np.abs(places[:, 1]) <= 90)
    at = (
        np.where(on_earth, rows, 0).clip(0, _ROWS - 1).astype(np.intp),
        np.where(on_earth, columns, 0).clip(0, _COLUMNS - 1).astype(np.intp),
    )
    return on_earth & _land()[at]


@cache
def _land() -> NDArray[np.bool_]:
    """Return whether each cell is land, shape (rows, columns)."""
    bits = np.frombuffer(zlib.decompress(_FILE.read_bytes()), np.uint8)
    return np.unpackbits(bits).reshape(_ROWS, _COLUMNS).astype(np.bool_)
