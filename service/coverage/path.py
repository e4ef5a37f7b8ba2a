"""Paths over a map: the cells that a tour passes."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from service.coverage.frame import MapFrame


@dataclass(frozen=True, eq=False)
class CoveragePath:
    """The path of a tour: rows and columns, shape (m, 2); of a closed one, the first also last.

    The frame is that of the map, where it is known.
    """

    cells: NDArray[np.int64]
    metres: float
    frame: MapFrame | None = None
