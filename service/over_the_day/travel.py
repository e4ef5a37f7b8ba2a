"""Drive tours through a day: exact lengths, times and best departures."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.day.driving import arrived, cost_of, has_knots, left_at, slice_at, slices_of
from service.jit import compiled, inlined
from service.over_the_day.day import Day

Array = NDArray[np.float64]
Cities = NDArray[np.int32]

PARTS = 16  # of a range of departures
MOST_TRIES = 2_000  # departures of one tour: more than one of up to eight stops and 100 slices has
EQUAL = 1e-12  # seconds with a smaller relative difference count as equal


class Traffic(NamedTuple):
    """A day with one set of slices for all m objectives, for compiled code.

    The first members are those of `Slices`. `service`: shape (n,). `closed`: whether tours return.
    """

    begins: Array
    factors: Array
    layers: NDArray[np.int64]
    matrices: Array
    tables: NDArray[np.int64]
    spans: NDArray[np.int64]
    knots: Array
    service: Array
    clock: int
    closed: bool


def _penalised(matrices: Array) -> Array:
    """Return costs, shape (k, n, n), in which a forbidden leg costs more than a tour without one.

    A leg that one of the matrices forbids is forbidden all day.
    """
    np.einsum("iik->ik", matrices)[:] = 0.0  # a tour of one stop has a leg from it to itself
    forbidden = np.isinf(matrices).any(axis=-1, keepdims=True)
    if not forbidden.any():
        return matrices
    largest = matrices.max(axis=(0, 1), where=~forbidden, initial=0.0)
    penalties = 2 * matrices.shape[1] * np.where(largest > 0, largest, 1.0)
    return np.where(forbidden, penalties, matrices)


class Moment(NamedTuple):
    """A time, the slice that it is in, and the weighted costs so far of what is not the clock."""

    time: float
    slice: int
    cost: float


def traffic_of(day: Day) -> Traffic:
    """Return the day with common slices. O(k n^2) for k matrices."""
    slices = slices_of(day.costs)
    forbidden: NDArray[np.bool_] = np.isinf(slices.matrices.max(axis=-1))
    matrices = _penalised(slices.matrices)
    return Traffic(
        *slices._replace(
            matrices=matrices,
            spans=np.where(forbidden[..., np.newaxis], 0, slices.spans),
        ),
        service=day.service,
        clock=day.clock,
        closed=day.ends.closed,
    )


@inlined
def begun(traffic: Traffic, departure: float) -> Moment:
    """Return the moment at which a tour begins at a time."""
    return Moment(departure, slice_at(traffic, departure, 0), 0.0)


@compiled
def driven(traffic: Traffic, i: int, j: int, at: Moment, weights: Array) -> Moment:
    """Return the moment of arrival at j of who leaves i at a moment."""
    cost = at.cost
    for objective in range(len(weights)):
        if objective != traffic.clock:
            cost += weights[objective] * cost_of(traffic, objective, i, j, at.time, at.slice)
    time, known = arrived(traffic, i, j, at.time, at.slice, 1.0)
    return Moment(time, known, cost)


@compiled
def served(traffic: Traffic, stop: int, at: Moment) -> Moment:
    """Return the moment at which the visit to a stop that begins at a moment has ended."""
    time = at.time + traffic.service[stop]
    return Moment(time, slice_at(traffic, time, at.slice), at.cost)


@compiled
def toured(traffic: Traffic, tour: Cities, departure: float, weights: Array) -> Moment:
    """Return the moment at which a tour ends that begins at a time. O(n)."""
    at = served(traffic, tour[0], begun(traffic, departure))
    for place in range(1, len(tour)):
        at = served(
            traffic, tour[place], driven(traffic, tour[place - 1], tour[place], at, weights)
        )
    return driven(traffic, tour[-1], tour[0], at, weights) if traffic.closed else at


@compiled
def seconds_of(traffic: Traffic, tour: Cities, departure: float) -> float:
    """Return the seconds that a tour takes. O(n)."""
    return toured(traffic, tour, departure, traffic.begins[:0]).time - departure


@compiled
def departure_for(traffic: Traffic, tour: Cities, place: int, time: float) -> float:
    """Return when a tour has to begin for the visit at a place to begin at a time. O(place)."""
    for at in range(place - 1, -1, -1):
        time = left_at(traffic, tour[at], tour[(at + 1) % len(tour)], time, 1.0)
        time -= traffic.service[tour[at]]
    return time


@compiled
def best_departure(traffic: Traffic, tour: Cities, earliest: float, latest: float) -> float:
    """Return the departure in a range, as early as may be, after which a tour takes least time.

    The seconds are a piecewise linear function of the departure. They can be least only at an end
    of the range, or where a visit begins or ends just as a slice begins, or a leg at one of its
    breakpoints. O(s n^2) for s slices or breakpoints of each leg; of very many such departures, the
    first ones are tried.
    """
    best, least = earliest, seconds_of(traffic, tour, earliest)
    if latest == earliest:
        return best
    best, least = sooner(traffic, tour, latest, best, least)
    if traffic.tables[traffic.clock] >= 0:
        return _best_by_knots(traffic, tour, earliest, latest, (best, least))
    tries = 0
    for known in range(1, len(traffic.factors)):
        for event in range(2 * len(tour) + (1 if traffic.closed else 0)):
            place = event // 2  # whose visit begins, or ends, with the slice
            service = traffic.service[tour[place % len(tour)]] if event % 2 else 0.0
            departure = departure_for(traffic, tour, place, traffic.begins[known] - service)
            if departure < earliest or tries >= MOST_TRIES:
                break  # it would be so for all later places
            tries += 1
            if departure <= latest:
                best, least = sooner(traffic, tour, departure, best, least)
    return best


@compiled
def _best_by_knots(
    traffic: Traffic, tour: Cities, earliest: float, latest: float, known: tuple[float, float]
) -> float:
    """Return the best departure of those after which a leg begins at a breakpoint, and of a known.

    The known one is given with the seconds that the tour takes after it.
    """
    best, least = known
    tries, n = 0, len(tour)
    first, last = begun(traffic, earliest), begun(traffic, latest)
    for place in range(n if traffic.closed else n - 1):
        i, j = tour[place], tour[(place + 1) % n]
        first, last = served(traffic, i, first), served(traffic, i, last)
        if has_knots(traffic, traffic.clock, i, j):
            table = traffic.tables[traffic.clock]
            for knot in range(traffic.spans[table, i, j, 0], traffic.spans[table, i, j, 1]):
                time = traffic.knots[knot, 0]
                if first.time < time < last.time and tries < MOST_TRIES:
                    tries += 1
                    departure = departure_for(traffic, tour, place, time - traffic.service[i])
                    best, least = sooner(traffic, tour, departure, best, least)
        first = driven(traffic, i, j, first, traffic.begins[:0])
        last = driven(traffic, i, j, last, traffic.begins[:0])
    return best


@compiled
def sooner(
    traffic: Traffic, tour: Cities, departure: float, best: float, least: float
) -> tuple[float, float]:
    """Return the better one of two departures, and the seconds that the tour takes after it."""
    seconds = seconds_of(traffic, tour, departure)
    if seconds < least * (1 - EQUAL):
        return departure, seconds
    if departure < best and seconds <= least * (1 + EQUAL):
        return departure, min(seconds, least)
    return best, least


@compiled
def good_departure(traffic: Traffic, tour: Cities, earliest: float, latest: float) -> float:
    """Return the best one of evenly spread departures. O(n)."""
    best, least = earliest, seconds_of(traffic, tour, earliest)
    if latest == earliest:
        return best
    for part in range(1, PARTS + 1):
        departure = earliest + (latest - earliest) * part / PARTS
        best, least = sooner(traffic, tour, departure, best, least)
    return best


@compiled
def best_departure_near(
    traffic: Traffic, tour: Cities, departure: float, earliest: float, latest: float
) -> float:
    """Return the best departure of the parts of a range that meet at one of good_departure()."""
    part = (latest - earliest) / PARTS
    return best_departure(
        traffic, tour, max(earliest, departure - part), min(latest, departure + part)
    )


@inlined
def add_costs(traffic: Traffic, i: int, j: int, at: Moment, lengths: Array) -> None:
    """Add the costs of a leg that begins at a moment to lengths, shape (m,)."""
    for objective in range(len(lengths)):
        lengths[objective] += cost_of(traffic, objective, i, j, at.time, at.slice)


@compiled
def sum_lengths(traffic: Traffic, tour: Cities, departure: float, lengths: Array) -> None:
    """Write the lengths of a tour, shape (m,). O(n)."""
    at = begun(traffic, departure)
    lengths[:] = 0.0
    n = len(tour)
    for place in range(n):
        at = served(traffic, tour[place], at)
        if place + 1 < n or traffic.closed:
            i, j = tour[place], tour[(place + 1) % n]
            add_costs(traffic, i, j, at, lengths)
            at = driven(traffic, i, j, at, traffic.begins[:0])
    lengths[traffic.clock] = at.time - departure


@compiled
def write_reached(traffic: Traffic, tours: Cities, departures: Array, reached: Array) -> None:
    """Write all lengths of k tours up to the arrival at each place, and at the end.

    `reached` has shape (k, n + 1, m). A closed tour ends with its return, an open route with its
    last visit.
    """
    n = tours.shape[1]
    for k in range(len(tours)):
        departure, lengths = departures[k], reached[k]
        at = begun(traffic, departure)
        lengths[0] = 0.0
        for place in range(n):
            i, j = tours[k, place], tours[k, (place + 1) % n]
            at = served(traffic, i, at)
            for objective in range(lengths.shape[1]):
                lengths[place + 1, objective] = lengths[place, objective]
            if place + 1 < n or traffic.closed:
                add_costs(traffic, i, j, at, lengths[place + 1])
                at = driven(traffic, i, j, at, traffic.begins[:0])
            lengths[place + 1, traffic.clock] = at.time - departure
