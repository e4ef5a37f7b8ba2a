"""Find the cheapest paths on a grid, under a layer with the cost of each cell. Compiled.

A step costs its length times the mean of the layer at both its cells. The layer is a weighted sum
of objectives, metres among them, so a path may be longer than the shortest. Steps are those of
`shortest_paths`.

The algorithm is Dijkstra's with a binary heap, as the costs of steps may differ by any factor. It
ends once all targets are reached, so that paths to near places are found fast on a large map.
"""

from heapq import heappop, heappush
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.coverage.frame import Array, Cells, Mask
from service.coverage.shortest_paths import DIAGONAL, Grid, mark, unmark
from service.jit import allocating, compiled


class _PathsFound(NamedTuple):
    """The paths found so far, and the targets of the search."""

    cost: Array  # (cells,), infinite if no path was found
    predecessor: NDArray[np.int32]  # (cells,), the cell before on the path, or -1
    is_target: Mask  # (cells,)
    reached: NDArray[np.int32]  # (cells,), the cells that have a path
    reached_size: Cells  # (1,)


class CheapestPaths:
    """Searches for cheapest paths on one grid. All searches use the same memory, as it is large.

    The layer of the grid itself is not read.
    """

    def __init__(self, grid: Grid) -> None:
        cells = len(grid.free)
        self._grid = grid
        self._state = _PathsFound(
            np.full(cells, np.inf),
            np.full(cells, -1, np.int32),
            np.zeros(cells, np.bool_),
            np.empty(cells, np.int32),
            np.zeros(1, np.int64),
        )

    def find(self, layer: Array, source: int, targets: Cells) -> NDArray[np.int32]:
        """Return for each cell the cell before it on the cheapest path from a source.

        Shape (cells of the grid,); -1 for the source, and for cells that are not reached. The next
        search overwrites it. Only the paths to the targets, and to cells that cost less to reach,
        are sure to be the cheapest. O(c log c) for the c cells that cost no more to reach than the
        dearest target.

        Args:
            layer: The positive cost of each cell, shape (cells of the grid,).
            source: The number of a free cell.
            targets: Numbers of cells, shape (n,).
        """
        _forget(self._state)
        _search(self._grid, self._state, layer, source, targets)
        return self._state.predecessor


@compiled
def _forget(state: _PathsFound) -> None:
    """Remove the paths of the last search."""
    for k in range(state.reached_size[0]):
        cell = state.reached[k]
        state.cost[cell], state.predecessor[cell] = np.inf, -1


@allocating
def _search(grid: Grid, state: _PathsFound, layer: Array, source: int, targets: Cells) -> None:
    cost, predecessor, is_target, reached, reached_size = state
    left = mark(is_target, targets)
    cost[source], reached[0], reached_size[0] = 0.0, source, 1
    heap = [(0.0, source)]
    while left > 0 and len(heap) > 0:
        so_far, cell = heappop(heap)
        if so_far > cost[cell]:  # a cheaper path to the cell was found later
            continue
        left -= is_target[cell]
        for down in (-grid.width, 0, grid.width):
            if not grid.free[cell + down]:
                continue
            for right in (-1, 0, 1):
                beside = cell + down + right
                if not (grid.free[cell + right] and grid.free[beside]):
                    continue
                length = DIAGONAL if down * right != 0 else 1.0
                over = so_far + length * (layer[cell] + layer[beside]) / 2
                if over < cost[beside]:
                    reached[reached_size[0]] = beside
                    reached_size[0] += cost[beside] == np.inf  # else it is in the list already
                    cost[beside], predecessor[beside] = over, cell
                    heappush(heap, (over, beside))
    unmark(is_target, targets)
