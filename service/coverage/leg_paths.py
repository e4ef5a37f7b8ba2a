"""The paths over a map that each leg between two places can take: one, or several to choose from.

The paths of a leg have numbers. Path 0 is the shortest. Legs between places that are near each
other may have further paths, which may be longer in metres and cost less in another objective. A
path can be taken in both directions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from service.coverage.cheapest_paths import CheapestPaths
from service.coverage.frame import Array, Cells
from service.coverage.shortest_paths import Grid, ShortestPaths, trace_path
from service.instance import Instance

Indices = NDArray[np.integer]
Numbers = NDArray[np.int8]  # the number of the path that each leg takes
Legs = tuple[Indices, Indices]  # the places where legs begin and end, two arrays of one shape


@dataclass(frozen=True, eq=False, kw_only=True)
class FurtherPaths:
    """All paths of the legs between p pairs of places near each other, the shortest included.

    Each path number has weights of the objectives: a path is the cheapest under its weights.

    Attributes:
        pairs: The two places of each pair, shape (p, 2). The lower number is first.
        lengths: The length of each path under each of m objectives, shape (paths, m, p).
        steps: The number of steps of each path, shape (paths, p).
        layers: The weighted cost of each cell, shape (paths - 1, cells of the grid). Paths with
            number i are the cheapest under row i - 1. Path 0 needs no layer.
        choices: The number of each pair's best path under each of w rows of weights, shape (w, p).
            The first rows are for the weights of path 0, path 1 and so on; then come others.
    """

    pairs: Cells
    lengths: Array
    steps: NDArray[np.int32]
    layers: Array
    choices: Numbers


@dataclass(frozen=True, eq=False, kw_only=True)
class LegPaths:
    """The paths between all places of a map.

    Attributes:
        grid: The free cells and the cost layer.
        cells: The number of each place's cell in the grid, shape (n,).
        instance: The lengths of the shortest paths, as matrices of shape (m, n, n).
        steps: The number of steps of each shortest path, shape (n, n).
        further: The further paths; None if all legs take the shortest.
    """

    grid: Grid
    cells: Cells
    instance: Instance
    steps: NDArray[np.int32]
    further: FurtherPaths | None = None

    @property
    def count(self) -> int:
        """The largest number of paths between which a leg can choose."""
        return 1 if self.further is None else len(self.further.lengths)

    def instances(self) -> Iterator[Instance]:
        """Yield an instance for each path number, in ascending order.

        Its matrices are the lengths of the legs if each leg takes its best path under the weights
        of that path number. In the first instance all legs take the shortest path.
        """
        yield self.instance
        if self.further is None:
            return
        assert self.instance.matrices is not None
        first, second = self.further.pairs.T
        for row in range(1, self.count):
            matrices = self.instance.matrices.copy()
            chosen = self._chosen(row)
            matrices[:, first, second] = matrices[:, second, first] = chosen
            yield replace(self.instance, matrices=matrices)

    def tour_lengths(self, legs: Legs) -> Array:
        """Return the lengths of k tours under each row of `further.choices`, shape (w, k, m).

        Each leg takes the path that the row chooses, or its only path.

        Args:
            legs: The places where the legs of each tour begin and end, each of shape (k, legs).
        """
        assert self.instance.matrices is not None
        assert self.further is not None
        pairs = self._pairs[legs]
        alone = np.where(pairs < 0, self.instance.matrices[(slice(None), *legs)], 0.0).sum(axis=2)
        lengths = np.empty((len(self.further.choices), len(pairs), len(alone)))
        for row in range(len(lengths)):
            # A column of 0 at the end, for pair -1: legs with one path.
            padded = np.pad(self._chosen(row), ((0, 0), (0, 1)))
            lengths[row] = (alone + padded[:, pairs].sum(axis=2)).T
        return lengths

    def chosen(self, legs: Legs, rows: Indices) -> Numbers:
        """Return the number of the path that each leg of k tours takes, shape (k, legs).

        Args:
            legs: The places where the legs of each tour begin and end, each of shape (k, legs).
            rows: The row of `further.choices` of each tour, shape (k,).
        """
        assert self.further is not None
        pairs = self._pairs[legs]
        return np.where(pairs < 0, np.int8(0), self.further.choices[rows[:, np.newaxis], pairs])

    def lengths(self, legs: Legs, taken: Numbers | None = None) -> Array:
        """Return the length of each leg under each objective, shape (..., m).

        Args:
            legs: The places where legs begin and end, each of shape (...).
            taken: The number of the path that each leg takes, shape (...); None for the shortest.
        """
        assert self.instance.matrices is not None
        shortest = np.moveaxis(self.instance.matrices[(slice(None), *legs)], 0, -1)
        if self.further is None or taken is None:
            return shortest
        pairs = self._pairs[legs]
        several = np.moveaxis(self.further.lengths, 1, -1)[taken, pairs]
        return np.where(pairs[..., np.newaxis] < 0, shortest, several)

    def count_steps(self, legs: Legs, taken: Numbers | None = None) -> NDArray[np.int32]:
        """Return the number of steps of each leg, shape (...).

        Args:
            legs: The places where legs begin and end, each of shape (...).
            taken: The number of the path that each leg takes, shape (...); None for the shortest.
        """
        if self.further is None or taken is None:
            return self.steps[legs]
        pairs = self._pairs[legs]
        return np.where(pairs < 0, self.steps[legs], self.further.steps[taken, pairs])

    def trace(self, path: int, origin: int, ends: Sequence[int]) -> list[Cells]:
        """Return the cells of the paths from a place to others, each path of shape (s, 2).

        Args:
            path: The number of the paths.
            origin: The number of the place.
            ends: The numbers of the other places, all above `origin`. A path in the other direction
                is the same path in reverse.

        Returns:
            The row and the column of each cell of a path, for each end in turn.
        """
        source, targets = self.cells[origin], self.cells[list(ends)]
        if path == 0:
            before = self.shortest.find(int(source), targets).predecessor
        else:
            assert self.further is not None
            layer = self.further.layers[path - 1]
            before = self.cheapest.find(layer, int(source), targets)
        return [trace_path(self.grid, before, target) for target in targets]

    @cached_property
    def shortest(self) -> ShortestPaths:
        """The search for shortest paths on the grid."""
        return ShortestPaths(self.grid)

    @cached_property
    def cheapest(self) -> CheapestPaths:
        """The search for cheapest paths on the grid."""
        return CheapestPaths(self.grid)

    def _chosen(self, row: int) -> Array:
        """Return the length of each pair's path under a row of `further.choices`, shape (m, p)."""
        assert self.further is not None
        choice = self.further.choices[row].astype(np.intp)
        return np.take_along_axis(self.further.lengths, choice[np.newaxis, np.newaxis], 0)[0]

    @cached_property
    def _pairs(self) -> NDArray[np.int32]:
        """The number of the pair of any two places, shape (n, n); -1 if they have one path."""
        assert self.further is not None
        pairs = np.full(self.steps.shape, -1, np.int32)
        first, second = self.further.pairs.T
        pairs[first, second] = pairs[second, first] = np.arange(len(first))
        return pairs
