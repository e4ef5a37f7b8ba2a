"""The costs of a fleet over the day as the arrays that the search reads."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay
from service.day.driving import arrived, cost_of, slices_of
from service.fleet.fleet import Fleet
from service.jit import by_reference, inlined

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

_MOST_KNOTS = 2**13  # of the function from the departure of a route to a time on its way


@by_reference
class FleetDay(NamedTuple):
    """Both costs in the slices of a day, and scratch space.

    Attributes:
        begins: As in `Slices`.
        factors: As in `Slices`.
        layers: As in `Slices`.
        matrices: As in `Slices`, shape (p n, n, k): the rows of one profile of vehicles after those
            of another. A forbidden leg costs a finite sum that no plan may cost.
        tables: As in `Slices`.
        spans: As in `Slices`, shape (t, p n, n, 2).
        knots: As in `Slices`.
        clock: The number of the costs that are time.
        paces: By what each type of vehicles multiplies them, shape (v,).
        rows: The first row of each type of vehicles in the matrices, shape (v,).
        departures: Scratch space, shape (2, k): the departures of some routes that are alike.
        times: When these are at a place on the way, shape (2, k).
        changes: When a leg becomes slower or faster, shape (2 s,), or more for its breakpoints.
    """

    begins: Array
    factors: Array
    layers: Indices
    matrices: Array
    tables: Indices
    spans: Indices
    knots: Array
    clock: int
    paces: Array
    rows: Indices
    departures: Array
    times: Array
    changes: Array


def day_of(fleet: Fleet, forbidden: float) -> FleetDay | None:
    """Return the costs of a fleet over the day; None if they do not change."""
    if fleet.day is None or fleet.rules.clock is None:
        return None
    slices = slices_of([_stacked(each) for each in zip(*fleet.days, strict=True)])
    # In every slice it costs as much, whatever the factor.
    most = forbidden / min(1.0, float(slices.factors.min()))
    matrices = np.where(np.isinf(slices.matrices), most, slices.matrices)
    knots = _MOST_KNOTS
    return FleetDay(
        *slices._replace(matrices=matrices),
        clock=fleet.rules.clock,
        paces=1.0 / np.array([vehicle.speed_factor for vehicle in fleet.rules.vehicles]),
        rows=fleet.rules.n * np.array([vehicle.profile for vehicle in fleet.rules.vehicles]),
        departures=np.zeros((2, knots)),
        times=np.zeros((2, knots)),
        changes=np.zeros(max(2 * len(slices.factors), np.diff(slices.spans).max(initial=0))),
    )


def _stacked(costs: Sequence[CostsOfDay]) -> CostsOfDay:
    """Return costs whose matrices have the rows of each profile, given those of all profiles.

    If they have breakpoints, these are the same for all profiles.
    """
    first, *others = costs
    if not others:
        return first
    pairs = first.pairs
    if pairs is not None:
        spans = [pairs.spans, *(each.pairs.spans for each in others if each.pairs is not None)]
        pairs = replace(pairs, spans=np.concatenate(spans))
    matrices = np.concatenate([each.matrices for each in costs], axis=1)
    return replace(first, matrices=matrices, pairs=pairs)


class Moment(NamedTuple):
    """A time, the slice that it is in, and both costs of the leg that ends then."""

    time: float
    slice: int
    first: float
    second: float


@inlined
def last_until(times: Array, count: int, time: float) -> int:
    """Return the place of the last of some ascending times up to another; 0 if none is. O(log)."""
    low, high = 0, count - 1
    while low < high:
        middle = (low + high + 1) // 2
        if times[middle] <= time:
            low = middle
        else:
            high = middle - 1
    return low


@inlined
def slice_of(day: FleetDay, time: float) -> int:
    """Return the slice of a time. O(log s)."""
    return last_until(day.begins, len(day.factors), time)


@inlined
def driven(day: FleetDay, between: tuple[int, int], kind: int, time: float, known: int) -> Moment:
    """Return the moment at which a vehicle arrives that begins a leg; at once from or to anywhere.

    Args:
        day: The day.
        between: The places where the leg begins and ends.
        kind: The type of the vehicle.
        time: When it begins.
        known: The slice of this time.
    """
    a, b = between
    if a < 0 or b < 0:
        return Moment(time, known, 0.0, 0.0)
    other, row = 1 - day.clock, day.rows[kind] + a
    arrival, later = arrived(day, row, b, time, known, day.paces[kind])
    if day.tables[other] == day.tables[day.clock] >= 0 and day.paces[kind] == 1.0:
        return Moment(arrival, later, arrival - time, arrival - time)
    cost = cost_of(day, other, row, b, time, known)
    if day.clock == 0:
        return Moment(arrival, later, arrival - time, cost)
    return Moment(arrival, later, cost, arrival - time)
