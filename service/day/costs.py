"""The costs of legs in each slice of the day, or by breakpoints of each pair of stops."""

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from service.day.breakpoints import Breakpoints

Array = NDArray[np.float64]
_SLICES = 48  # of costs that are known by breakpoints
_MOST_COSTS = 2**22  # in all of these, if they are more than two


@dataclass(frozen=True, eq=False)
class CostsOfDay:
    """The costs between n stops under one objective, in each slice of the day.

    In slice s the cost of going from i to j is factors[s] * matrices[layers[s], i, j], unless the
    pair has breakpoints.

    Args:
        begins: When each slice begins, shape (s,), ascending seconds of the day. The first slice
            holds before that too, and the last one without end.
        factors: Shape (s,), positive.
        layers: Shape (s,), the index of the matrix of each slice.
        matrices: Shape (k, n, n). An infinite cost forbids the leg from i to j at all times.
        pairs: The exact costs of the pairs that have breakpoints. The slices then have about these,
            for what needs no exact ones.
    """

    begins: Array
    factors: Array
    layers: NDArray[np.int64]
    matrices: Array
    pairs: Breakpoints | None = None

    @classmethod
    def constant(cls, matrix: Array) -> "CostsOfDay":
        """Return costs that are the same all day, from a matrix of them, shape (n, n)."""
        return cls(np.zeros(1), np.ones(1), np.zeros(1, np.int64), matrix[np.newaxis])

    @classmethod
    def by_pair(cls, pairs: Breakpoints) -> "CostsOfDay":
        """Return costs by breakpoints; a leg without any is forbidden. O(s n^2) for s slices."""
        count = max(2, min(_SLICES, _MOST_COSTS // len(pairs.spans) ** 2))
        times = pairs.times if len(pairs.times) else np.zeros(1)
        bounds = np.linspace(times.min(), times.max(), count + 1)
        matrices = pairs.at((bounds[1:] + bounds[:-1]) / 2)
        np.einsum("kii->ki", matrices)[:] = 0.0
        if bounds[0] == bounds[-1]:  # all of them are constant
            return replace(cls.constant(matrices[0]), pairs=pairs)
        return cls(bounds[:-1], np.ones(count), np.arange(count), matrices, pairs)

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
        if self.pairs is not None and self.pairs.has(a, b):
            return float(np.interp(time, *self.pairs.of(a, b)))
        known = int(np.searchsorted(self.begins[1:], time, "right"))
        return float(self.factors[known] * self.matrices[self.layers[known], a, b])

    def least(self) -> Array:
        """Return the least costs of the day, shape (n, n)."""
        return self._bound(np.minimum)

    def greatest(self) -> Array:
        """Return the greatest costs of the day, shape (n, n)."""
        return self._bound(np.maximum)

    def _bound(self, better: np.ufunc) -> Array:
        used = np.unique(self.layers)
        factors = [better.reduce(self.factors[self.layers == layer]) for layer in used]
        costs = (self.matrices[layer] * each for layer, each in zip(used, factors, strict=True))
        bound: Array = reduce(better, costs)
        if self.pairs is not None:
            bound = np.array(bound)
            bound[self.pairs.known] = self.pairs.bound(better)
        return bound

    def among(self, stops: NDArray[np.int64]) -> "CostsOfDay":
        """Return the costs between some stops, which may repeat."""
        matrices = self.matrices[:, stops[:, np.newaxis], stops]
        pairs = None if self.pairs is None else self.pairs.among(stops)
        return replace(self, matrices=matrices, pairs=pairs)

    def scaled(self, costs: int, times: int) -> "CostsOfDay":
        """Return costs and times of the day multiplied by powers of two."""
        begins, matrices = np.ldexp(self.begins, times), np.ldexp(self.matrices, costs)
        pairs = None if self.pairs is None else self.pairs.scaled(costs, times)
        return replace(self, begins=begins, matrices=matrices, pairs=pairs)

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
