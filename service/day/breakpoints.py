"""Costs that are a piecewise linear function of the time, another one for each pair of stops."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Breakpoints:
    """The costs between n stops, by breakpoints of each pair of them.

    A leg that begins between two breakpoints costs what lies on the line between theirs. Before the
    first and after the last of its breakpoints it costs what it does at these.

    Args:
        spans: Shape (n, n, 2). The breakpoints of the leg from i to j are those from number
            spans[i, j, 0] on and before spans[i, j, 1]. They may be none.
        times: When legs begin, shape (k,), ascending seconds of the day in each span.
        costs: What they cost then, shape (k,).
    """

    spans: NDArray[np.int64]
    times: Array
    costs: Array

    @property
    def known(self) -> NDArray[np.bool_]:
        """Which pairs have breakpoints, shape (n, n)."""
        return self.spans[..., 0] < self.spans[..., 1]

    @property
    def count(self) -> int:
        """The number of breakpoints of all pairs of different stops."""
        numbers = self.spans[..., 1] - self.spans[..., 0]
        return int(numbers.sum() - np.trace(numbers))

    def has(self, a: int, b: int) -> bool:
        """Return whether a pair has breakpoints."""
        return bool(self.spans[a, b, 0] < self.spans[a, b, 1])

    def of(self, a: int, b: int) -> tuple[Array, Array]:
        """Return the times and the costs of one pair, shape (k,) both."""
        first, end = self.spans[a, b].tolist()
        return self.times[first:end], self.costs[first:end]

    def same_as(self, other: "Breakpoints") -> bool:
        """Return whether all legs cost the same under other breakpoints with the same numbers."""
        pairs = ((self.spans, other.spans), (self.times, other.times), (self.costs, other.costs))
        return all(np.array_equal(one, another) for one, another in pairs)

    def among(self, stops: NDArray[np.int64]) -> "Breakpoints":
        """Return the costs between some stops, which may repeat."""
        return replace(self, spans=self.spans[stops[:, np.newaxis], stops])

    def without(self, pairs: NDArray[np.bool_]) -> "Breakpoints":
        """Return these without the breakpoints of some pairs, shape (n, n)."""
        return replace(self, spans=np.where(pairs[..., np.newaxis], 0, self.spans))

    def changed(self, steps: NDArray[np.int64], costs: Array) -> "Breakpoints":
        """Return these with costs of some steps, shape (m, 2), that are the same all day.

        An infinite cost forbids the step.
        """
        spans, k = self.spans.copy(), len(self.times)
        first = np.arange(k, k + len(costs))
        spans[steps[:, 0], steps[:, 1]] = np.stack((first, first + np.isfinite(costs)), axis=1)
        times = np.append(
            self.times, np.full(len(costs), self.times[0] if len(self.times) else 0.0)
        )
        return Breakpoints(spans, times, np.append(self.costs, costs))

    def scaled(self, costs: int, times: int) -> "Breakpoints":
        """Return costs and times multiplied by powers of two."""
        return Breakpoints(self.spans, np.ldexp(self.times, times), np.ldexp(self.costs, costs))

    def bound(self, better: np.ufunc) -> Array:
        """Return the least, or the greatest, cost of each pair that has breakpoints, by rows.

        `better` is np.minimum or np.maximum.
        """
        # What is after the end of a span is in every second result. The last span may end with all.
        ends = self.spans[self.known].ravel()
        return better.reduceat(np.append(self.costs, 0.0), ends)[::2]

    def at(self, times: Array) -> Array:
        """Return the costs at k times, shape (k, n, n); infinite where a pair has no breakpoints.

        O(k n^2 log b) for b breakpoints of a pair.
        """
        known = self.known
        first, end = self.spans[known].T
        found = np.full((len(times), *known.shape), np.inf)
        for costs, time in zip(found, times.tolist(), strict=True):
            costs[known] = self._costs_at(time, first, end)
        return found

    def _costs_at(self, time: float, first: NDArray[np.int64], end: NDArray[np.int64]) -> Array:
        """Return the costs at a time between breakpoints from `first` on and before `end`."""
        # By bisection, of all pairs at once: the first breakpoint after the time.
        low, high = first, end
        for _ in range(int((end - first).max(initial=0)).bit_length()):
            middle = (low + high) // 2
            passed = (low < high) & (self.times[np.minimum(middle, end - 1)] <= time)
            low, high = np.where(passed, middle + 1, low), np.where(passed, high, middle)
        before, after = np.maximum(low - 1, first), np.minimum(low, end - 1)
        times, costs = self.times[before], self.costs[before]
        between = before < after
        span = np.where(between, self.times[after] - times, 1.0)
        slopes = np.where(between, (self.costs[after] - costs) / span, 0.0)
        return slopes * (time - times) + costs
