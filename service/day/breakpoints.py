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
        known: NDArray[np.bool_] = self.spans[..., 0] < self.spans[..., 1]
        return known

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

    def least(self) -> Array:
        """Return the least cost of each pair that has breakpoints, in their order by rows."""
        # What is after the end of a span is in every second result. The last span may end with all.
        ends = self.spans[self.known].ravel()
        least: Array = np.minimum.reduceat(np.append(self.costs, np.inf), ends)[::2]
        return least

    def at(self, times: Array) -> Array:
        """Return the costs at k times, shape (k, n, n); infinite where a pair has no breakpoints.

        O(k n^2).
        """
        found = np.full((len(times), *self.spans.shape[:2]), np.inf)
        for a, b in np.argwhere(self.known).tolist():
            found[:, a, b] = np.interp(times, *self.of(a, b))
        return found
