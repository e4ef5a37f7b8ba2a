"""The paths over a map that a leg between two places can take: one, or several to choose from.

Path 0 of a leg is the shortest. Between places that are near each other there may be further paths,
which give up metres for cost. All paths lead both ways.
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
Numbers = NDArray[np.int8]  # of the paths that legs take
Legs = tuple[Indices, Indices]  # the places where legs begin and end, two arrays of one shape


@dataclass(frozen=True, eq=False, kw_only=True)
class FurtherPaths:
    """The paths of legs between places near each other, the shortest among them.

    Attributes:
        pairs: The two places, shape (p, 2), in ascending order.
        lengths: The lengths of each path, shape (paths, m, p).
        steps: The number of steps of each, shape (paths, p).
        layers: What a metre costs in each cell, weighted as each path weights it, shape (paths - 1,
            cells of the grid,): a path after the first is cheapest under its layer.
        choices: The path of each pair that is best under each of many weights between the
            objectives, shape (w, p). The first are the weights of the paths themselves, in order.
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
        instance: The lengths of the shortest paths.
        steps: The numbers of their steps, shape (n, n).
        further: Further paths; None if all legs take the shortest.
    """

    grid: Grid
    cells: Cells
    instance: Instance
    steps: NDArray[np.int32]
    further: FurtherPaths | None = None

    @property
    def count(self) -> int:
        """The most paths that a leg can take."""
        return 1 if self.further is None else len(self.further.lengths)

    def instances(self) -> Iterator[Instance]:
        """Yield the lengths between all places under the weights of each path, for each path.

        Each leg takes the path that is best under these weights.
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
        """Return the lengths of tours by each row of choices of the further paths, shape (w, k, m).

        Args:
            legs: The legs of each tour, shape (k, legs).
        """
        assert self.instance.matrices is not None
        assert self.further is not None
        pairs = self._pairs[legs]
        alone = np.where(pairs < 0, self.instance.matrices[(slice(None), *legs)], 0.0).sum(axis=2)
        lengths = np.empty((len(self.further.choices), len(pairs), len(alone)))
        for row in range(len(lengths)):
            padded = np.pad(self._chosen(row), ((0, 0), (0, 1)))  # 0 where a leg has one path
            lengths[row] = (alone + padded[:, pairs].sum(axis=2)).T
        return lengths

    def chosen(self, legs: Legs, rows: Indices) -> Numbers:
        """Return the path of each leg, shape (k, legs), by the row of choices of each tour."""
        assert self.further is not None
        pairs = self._pairs[legs]
        return np.where(pairs < 0, np.int8(0), self.further.choices[rows[:, np.newaxis], pairs])

    def lengths(self, legs: Legs, taken: Numbers | None = None) -> Array:
        """Return the lengths of legs that take these paths, or else the shortest.

        With one more axis of m at the end.
        """
        assert self.instance.matrices is not None
        shortest = np.moveaxis(self.instance.matrices[(slice(None), *legs)], 0, -1)
        if self.further is None or taken is None:
            return shortest
        pairs = self._pairs[legs]
        several = np.moveaxis(self.further.lengths, 1, -1)[taken, pairs]
        return np.where(pairs[..., np.newaxis] < 0, shortest, several)

    def count_steps(self, legs: Legs, taken: Numbers | None = None) -> NDArray[np.int32]:
        """Return the number of steps of legs that take these paths, or else the shortest."""
        if self.further is None or taken is None:
            return self.steps[legs]
        pairs = self._pairs[legs]
        return np.where(pairs < 0, self.steps[legs], self.further.steps[taken, pairs])

    def trace(self, path: int, origin: int, ends: Sequence[int]) -> list[Cells]:
        """Return the rows and columns, shape (s, 2), of a path from a place to each of others.

        These must have higher numbers: a path back is the same in reverse.
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
        """Return the lengths of the path that each pair takes by a row of choices, shape (m, p)."""
        assert self.further is not None
        choice = self.further.choices[row].astype(np.intp)
        return np.take_along_axis(self.further.lengths, choice[np.newaxis, np.newaxis], 0)[0]

    @cached_property
    def _pairs(self) -> NDArray[np.int32]:
        """The number of each pair in the further paths, shape (n, n); -1 if it has none."""
        assert self.further is not None
        pairs = np.full(self.steps.shape, -1, np.int32)
        first, second = self.further.pairs.T
        pairs[first, second] = pairs[second, first] = np.arange(len(first))
        return pairs
