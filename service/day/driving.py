"""Drive legs through a day, in compiled code.

Within a slice of the day a vehicle drives a leg at the speed of that slice, and where a slice ends
on the way, the rest at the next one's (Ichoua, Gendreau and Potvin, 2003). So who leaves later
never arrives earlier. Under other objectives a leg costs what it does in the slice in which it
begins.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.jit import compiled, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Slices(NamedTuple):
    """The slices of a day, common to m costs of legs.

    `begins`: when each slice begins, shape (s,); the first is minus infinity, and one more at the
    end is infinity. `factors` and `layers`: shape (s, m); in slice s a leg costs
    factors[s, o] * matrices[layers[s, o], i, j].
    """

    begins: Array
    factors: Array
    layers: Indices
    matrices: Array


class Sliced(Protocol):
    """Slices for compiled code, and the index of the costs that are time."""

    @property
    def begins(self) -> Array:
        """As in `Slices`."""

    @property
    def factors(self) -> Array:
        """As in `Slices`."""

    @property
    def layers(self) -> Indices:
        """As in `Slices`."""

    @property
    def matrices(self) -> Array:
        """As in `Slices`."""

    @property
    def clock(self) -> int:
        """The index."""


def slices_of(costs: Sequence[CostsOfDay]) -> Slices:
    """Return common slices of some costs. O(k n^2) for k matrices."""
    inner = np.unique(np.concatenate([each.begins[1:] for each in costs]))
    firsts = np.append(-np.inf, inner)
    factors = np.empty((len(firsts), len(costs)))
    layers = np.empty((len(firsts), len(costs)), np.int64)
    matrices: list[Array] = []
    for index, each in enumerate(costs):
        own = np.searchsorted(each.begins[1:], firsts, "right")
        factors[:, index], layers[:, index] = each.factors[own], each.layers[own] + len(matrices)
        matrices.extend(each.matrices)
    return Slices(np.append(firsts, np.inf), factors, layers, np.stack(matrices))


@compiled
def slice_at(day: Sliced, time: float, known: int) -> int:
    """Return the slice of a time that is not before a known slice."""
    while known + 1 < len(day.factors) and day.begins[known + 1] <= time:
        known += 1
    return known


@inlined
def arrived(day: Sliced, i: int, j: int, time: float, known: int, pace: float) -> tuple[float, int]:
    """Return when who leaves i at a time arrives at j, and the slice of that.

    Args:
        day: The day.
        i: Where the leg begins.
        j: Where it ends.
        time: When it begins.
        known: The slice of this time.
        pace: By what its seconds are multiplied.
    """
    left = 1.0
    while True:
        layer = day.layers[known, day.clock]
        seconds = pace * day.factors[known, day.clock] * day.matrices[layer, i, j]
        ends = day.begins[known + 1]
        if time + left * seconds < ends or ends == np.inf:
            return time + left * seconds, known
        left = max(0.0, left - (ends - time) / seconds) if seconds > 0.0 else 0.0
        time = ends
        known += 1


@compiled
def left_at(day: Sliced, i: int, j: int, arrival: float, pace: float) -> float:
    """Return when who arrives at j at a time has left i at the latest."""
    known = len(day.factors) - 1
    while known > 0 and day.begins[known] >= arrival:
        known -= 1
    time, left = arrival, 1.0
    while True:
        layer = day.layers[known, day.clock]
        seconds = pace * day.factors[known, day.clock] * day.matrices[layer, i, j]
        begins = day.begins[known]
        if time - left * seconds >= begins:
            return time - left * seconds
        left = max(0.0, left - (time - begins) / seconds)
        time = begins
        known -= 1
