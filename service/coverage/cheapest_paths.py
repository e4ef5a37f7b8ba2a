"""Find paths on a grid that give up metres for cost. Compiled.

A path is cheapest under a layer of costs that already holds what a metre counts: a step costs its
length times the mean of the layer at both its ends. Steps are those of `shortest_paths`. The
algorithm is Dijkstra's with a binary heap, as the costs of steps may differ by any factor. It ends
once all targets are reached, so that paths to the nearest places are found fast on a large map.
"""

from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from service.coverage.frame import Array, Cells
from service.coverage.shortest_paths import DIAGONAL, Grid
from service.jit import allocating


@allocating
def find_cheapest_paths(grid: Grid, layer: Array, source: int, targets: Cells) -> NDArray[np.int32]:
    """Return the cell before each cell on the cheapest path from a source; -1 if there is none.

    Shape (cells of the grid,). It is final for the targets and for all cells that cost less to
    reach. O(c log c) for the c cells that cost no more than the dearest target.

    Args:
        grid: The grid. Its own layer is not read.
        layer: Positive costs, shape (cells of the grid,).
        source: The number of a free cell.
        targets: Numbers of cells, shape (n,).
    """
    cost = np.full(len(grid.free), np.inf)
    predecessor = np.full(len(grid.free), -1, np.int32)
    missing = np.zeros(len(grid.free), np.bool_)
    missing[targets] = True
    left = missing.sum()
    cost[source] = 0.0
    heap = [(0.0, source)]
    while left > 0 and len(heap) > 0:
        reached, cell = heappop(heap)
        if reached > cost[cell]:  # it got a cheaper path since
            continue
        left -= missing[cell]
        for down in (-grid.width, 0, grid.width):
            if not grid.free[cell + down]:
                continue
            for right in (-1, 0, 1):
                beside = cell + down + right
                if not (grid.free[cell + right] and grid.free[beside]):
                    continue
                length = DIAGONAL if down * right != 0 else 1.0
                over = reached + length * (layer[cell] + layer[beside]) / 2
                if over < cost[beside]:
                    cost[beside], predecessor[beside] = over, cell
                    heappush(heap, (over, beside))
    return predecessor
