"""The costs of legs in each slice of the day."""

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CostsOfDay:
    """The costs between n stops under one objective, in each slice of the day.

    In slice s the cost of going from i to j is factors[s] * matrices[layers[s], i, j].

    Args:
        begins: When each slice begins, shape (s,), ascending seconds of the day. The first slice
            holds before that too, and the last one without end.
        factors: Shape (s,), positive.
        layers: Shape (s,), the index of the matrix of each slice.
        matrices: Shape (k, n, n). An infinite cost forbids the leg from i to j at all times.
    """

    begins: Array
    factors: Array
    layers: NDArray[np.int64]
    matrices: Array

    @classmethod
    def constant(cls, matrix: Array) -> "CostsOfDay":
        """Return costs that are the same all day, from a matrix of them, shape (n, n)."""
        return cls(np.zeros(1), np.ones(1), np.zeros(1, np.int64), matrix[np.newaxis])

    @property
    def changes(self) -> bool:
        """Whether costs depend on the time."""
        return len(self.begins) > 1

    @property
    def varies(self) -> bool:
        """Whether the costs of one leg change otherwise than those of another."""
        return len(self.matrices) > 1

    def at(self, time: float, a: int, b: int) -> float:
        """Return the cost of a leg that begins at a time."""
        known = int(np.searchsorted(self.begins[1:], time, "right"))
        return float(self.factors[known] * self.matrices[self.layers[known], a, b])

    def least(self) -> Array:
        """Return the least costs of all slices, shape (n, n)."""
        used = np.unique(self.layers)
        factors = [self.factors[self.layers == layer].min() for layer in used]
        costs = (self.matrices[layer] * each for layer, each in zip(used, factors, strict=True))
        return reduce(np.minimum, costs)

    def among(self, stops: NDArray[np.int64]) -> "CostsOfDay":
        """Return the costs between some stops, which may repeat."""
        return replace(self, matrices=self.matrices[:, stops[:, np.newaxis], stops])

    def scaled(self, costs: int, times: int) -> "CostsOfDay":
        """Return costs and times of the day multiplied by powers of two."""
        begins, matrices = np.ldexp(self.begins, times), np.ldexp(self.matrices, costs)
        return replace(self, begins=begins, matrices=matrices)

    def mean(self, earliest: float, latest: float) -> Array:
        """Return the mean costs from one time of the day to a later one, shape (n, n)."""
        ends = np.append(self.begins[1:], np.inf)
        begins = np.append(-np.inf, self.begins[1:])
        seconds = np.maximum(0.0, np.minimum(ends, latest) - np.maximum(begins, earliest))
        shares = seconds / seconds.sum() if latest > earliest else self._at(earliest)
        means = np.zeros_like(self.matrices[0])
        for layer, matrix in enumerate(self.matrices):
            share = float((shares * self.factors).sum(where=self.layers == layer))
            finite = np.isfinite(matrix)
            means[finite] += share * matrix[finite]
            means[~finite] = np.inf  # whatever its share
        return means

    def _at(self, time: float) -> Array:
        shares = np.zeros(len(self.begins))
        shares[max(0, int(np.searchsorted(self.begins, time, "right")) - 1)] = 1.0
        return shares
