"""Drive legs through a day, in compiled code.

Within a slice of the day a vehicle drives a leg at the speed of that slice, and where a slice ends
on the way, the rest at the next one's (Ichoua, Gendreau and Potvin, 2003). So who leaves later
never arrives earlier. Under other objectives a leg costs what it does in the slice in which it
begins. A leg with breakpoints takes, and costs, what these say for the time at which it begins.
"""

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from service.day.breakpoints import Breakpoints
from service.day.costs import CostsOfDay
from service.jit import compiled, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.int64]


class Slices(NamedTuple):
    """The slices of a day, common to m costs of legs.

    `begins`: when each slice begins, shape (s,); the first is minus infinity, and one more at the
    end is infinity. `factors` and `layers`: shape (s, m); in slice s a leg costs
    factors[s, o] * matrices[i, j, layers[s, o]].

    `tables`: shape (m,), the number of each costs' breakpoints, -1 without any. `spans`: shape
    (t, n, n, 2). The breakpoints of a leg in a table are those from number spans[t, i, j, 0] on and
    before spans[t, i, j, 1]; if there are none, the slices hold. `knots`: shape (k, 2), the time
    and the cost of each.
    """

    begins: Array
    factors: Array
    layers: Indices
    matrices: Array
    tables: Indices
    spans: Indices
    knots: Array


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
    def tables(self) -> Indices:
        """As in `Slices`."""

    @property
    def spans(self) -> Indices:
        """As in `Slices`."""

    @property
    def knots(self) -> Array:
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
    begins = np.append(firsts, np.inf)
    # All costs of a leg lie beside each other: who drives it reads several.
    return Slices(begins, factors, layers, np.stack(matrices, axis=-1), *_tables_of(costs))


def _tables_of(costs: Sequence[CostsOfDay]) -> tuple[Indices, Indices, Array]:
    """Return the tables, spans and knots of some costs, as in `Slices`.

    Costs by the same breakpoints have the same table.
    """
    tables = np.full(len(costs), -1)
    known: list[Breakpoints] = []
    spans: list[Indices] = []
    knots: list[Array] = [np.empty((0, 2))]
    for index, pairs in enumerate(each.pairs for each in costs):
        if pairs is None:
            continue
        same = (number for number, each in enumerate(known) if each.same_as(pairs))
        tables[index] = next(same, len(known))
        if tables[index] == len(known):
            known.append(pairs)
            spans.append(pairs.spans + sum(map(len, knots)))
            knots.append(np.stack((pairs.times, pairs.costs), axis=1))
    none = np.empty((0, *costs[0].matrices.shape[1:], 2), np.int64)
    return tables, np.stack(spans) if spans else none, np.concatenate(knots)


@inlined
def has_knots(day: Sliced, objective: int, i: int, j: int) -> bool:
    """Return whether a leg has breakpoints."""
    table = day.tables[objective]
    return bool(table >= 0 and day.spans[table, i, j, 0] < day.spans[table, i, j, 1])


@compiled
def cost_by_knots(day: Sliced, objective: int, i: int, j: int, time: float) -> float:
    """Return the cost of a leg with k breakpoints that begins at a time. O(log k)."""
    table = day.tables[objective]
    low, high = day.spans[table, i, j, 0], day.spans[table, i, j, 1]
    if time <= day.knots[low, 0]:
        return float(day.knots[low, 1])
    last = high - 1
    while high - low > 1:
        middle = (low + high) // 2
        if day.knots[middle, 0] <= time:
            low = middle
        else:
            high = middle
    if low == last:
        return float(day.knots[low, 1])
    part = (time - day.knots[low, 0]) / (day.knots[high, 0] - day.knots[low, 0])
    return float(day.knots[low, 1] + part * (day.knots[high, 1] - day.knots[low, 1]))


@inlined
def cost_of(day: Sliced, objective: int, i: int, j: int, time: float, known: int) -> float:
    """Return the cost of a leg that begins at a time, in a slice."""
    if has_knots(day, objective, i, j):
        return cost_by_knots(day, objective, i, j, time)
    layer = day.layers[known, objective]
    return float(day.factors[known, objective] * day.matrices[i, j, layer])


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
    if has_knots(day, day.clock, i, j):
        time += pace * cost_by_knots(day, day.clock, i, j, time)
        return time, slice_at(day, time, known)
    left = 1.0
    while True:
        layer = day.layers[known, day.clock]
        seconds = pace * day.factors[known, day.clock] * day.matrices[i, j, layer]
        ends = day.begins[known + 1]
        if time + left * seconds < ends or ends == np.inf:
            return time + left * seconds, known
        left = max(0.0, left - (ends - time) / seconds) if seconds > 0.0 else 0.0
        time = ends
        known += 1


@compiled
def left_at(day: Sliced, i: int, j: int, arrival: float, pace: float) -> float:
    """Return when who arrives at j at a time has left i at the latest."""
    if has_knots(day, day.clock, i, j):
        return _left_by_knots(day, i, j, arrival, pace)
    known = len(day.factors) - 1
    while known > 0 and day.begins[known] >= arrival:
        known -= 1
    time, left = arrival, 1.0
    while True:
        layer = day.layers[known, day.clock]
        seconds = pace * day.factors[known, day.clock] * day.matrices[i, j, layer]
        begins = day.begins[known]
        if time - left * seconds >= begins:
            return time - left * seconds
        left = max(0.0, left - (time - begins) / seconds)
        time = begins
        known -= 1


@compiled
def _left_by_knots(day: Sliced, i: int, j: int, arrival: float, pace: float) -> float:
    """Return the same for a leg with k breakpoints. O(log k)."""
    table = day.tables[day.clock]
    low, high = day.spans[table, i, j, 0], day.spans[table, i, j, 1]
    last = high - 1
    if arrival < day.knots[low, 0] + pace * day.knots[low, 1]:
        return float(arrival - pace * day.knots[low, 1])
    while high - low > 1:
        middle = (low + high) // 2
        if day.knots[middle, 0] + pace * day.knots[middle, 1] <= arrival:
            low = middle
        else:
            high = middle
    reached = day.knots[low, 0] + pace * day.knots[low, 1]
    if low == last:
        return float(arrival - pace * day.knots[low, 1])
    part = (arrival - reached) / (day.knots[high, 0] + pace * day.knots[high, 1] - reached)
    return float(day.knots[low, 0] + part * (day.knots[high, 0] - day.knots[low, 0]))
