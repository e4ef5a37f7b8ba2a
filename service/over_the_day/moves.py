"""Moves of the local search over the day: what they change, and what they are worth.

A tour is four parts, A B C D. A move swaps B and C, or reverses B where C is empty; of swapped
parts, one may be reversed as well. Its worth is first estimated, with each leg's cost as of the
time at which the tour now leaves its place, and only what looks good is driven through the day.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined
from service.over_the_day.travel import Cities, Moment, Traffic, begun, driven, served

Array = NDArray[np.float64]


class Move(NamedTuple):
    """A move: B begins at place `first`, C at `middle`, and D at `last`.

    With `first` < `middle` <= `last`; where C is empty, B is reversed.
    """

    first: int
    middle: int
    last: int
    turned_b: bool
    turned_c: bool


class DrivenTour(NamedTuple):
    """A tour that a search changes, by place, with the moments at which it leaves each place."""

    tour: Cities  # (n,)
    place: NDArray[np.int64]  # (n,), by city
    times: Array  # (n,)
    slices: NDArray[np.int64]  # (n,)
    costs: Array  # (n,), so far, of what is not the clock
    ahead: Array  # (n,), estimates of all legs up to each place
    back: Array  # (n,), the same of these legs in the other direction
    value: Array  # (2,): the weighted sum of the lengths, and the departure
    buffer: Cities  # (n,)


def make_driven_tour(n: int) -> DrivenTour:
    """Return a tour of n cities, to be loaded."""
    arrays = [np.zeros(n) for _ in range(4)]
    return DrivenTour(
        tour=np.zeros(n, np.int32),
        place=np.zeros(n, np.int64),
        times=arrays[0],
        slices=np.zeros(n, np.int64),
        costs=arrays[1],
        ahead=arrays[2],
        back=arrays[3],
        value=np.zeros(2),
        buffer=np.zeros(n, np.int32),
    )


@inlined
def estimate(traffic: Traffic, weights: Array, known: int, i: int, j: int) -> float:
    """Return the weighted cost of a leg in a slice."""
    total = 0.0
    for objective in range(len(weights)):
        factor = weights[objective] * traffic.factors[known, objective]
        total += factor * traffic.matrices[i, j, traffic.layers[known, objective]]
    return total


@compiled
def load(
    walk: DrivenTour, traffic: Traffic, weights: Array, tour: Cities, departure: float
) -> None:
    """Take a tour."""
    for k in range(len(tour)):
        walk.tour[k] = tour[k]
    walk.value[1] = departure
    drive_on(walk, traffic, weights, 0)


@compiled
def drive_on(walk: DrivenTour, traffic: Traffic, weights: Array, place: int) -> None:
    """Bring all that is known of a tour up to date, from a place on. O(n)."""
    tour, departure = walk.tour, walk.value[1]
    if place == 0:
        note(walk, 0, served(traffic, tour[0], begun(traffic, departure)))
        walk.ahead[0] = walk.back[0] = 0.0
    first = max(1, place)
    at = moment(walk, first - 1)
    for k in range(first, len(tour)):
        i, j = tour[k - 1], tour[k]
        walk.ahead[k] = walk.ahead[k - 1] + estimate(traffic, weights, at.slice, i, j)
        walk.back[k] = walk.back[k - 1] + estimate(traffic, weights, at.slice, j, i)
        at = served(traffic, j, driven(traffic, i, j, at, weights))
        note(walk, k, at)
    if traffic.closed:
        at = driven(traffic, tour[-1], tour[0], at, weights)
    walk.value[0] = weights[traffic.clock] * (at.time - departure) + at.cost


@inlined
def note(walk: DrivenTour, k: int, at: Moment) -> None:
    """Write down the moment at which a tour leaves a place."""
    walk.place[walk.tour[k]] = k
    walk.times[k], walk.slices[k], walk.costs[k] = at.time, at.slice, at.cost


@inlined
def moment(walk: DrivenTour, k: int) -> Moment:
    """Return the moment at which a tour leaves a place."""
    return Moment(walk.times[k], walk.slices[k], walk.costs[k])


@compiled
def write_moved(walk: DrivenTour, move: Move) -> None:
    """Write what stands at the places from `first` to before `last` after a move, to the buffer."""
    to = copied(walk, move.middle, move.last, move.first, move.turned_c)
    copied(walk, move.first, move.middle, to, move.turned_b or move.middle == move.last)


@compiled
def copied(walk: DrivenTour, first: int, last: int, to: int, turned: bool) -> int:
    """Write cities of a tour to its buffer; return the place after them."""
    for k in range(last - first):
        walk.buffer[to + k] = walk.tour[last - 1 - k if turned else first + k]
    return to + last - first


@inlined
def estimated_gain(walk: DrivenTour, traffic: Traffic, weights: Array, move: Move) -> float:
    """Return by how much a move is estimated to shorten a tour. O(1)."""
    first, middle, last = move.first, move.middle, move.last
    b, b_end = walk.tour[first], walk.tour[middle - 1]
    if middle == last:
        gain = turning_gain(walk, first, middle)
        gain += relinked(walk, traffic, weights, first - 1, b, b_end)
        return gain + unlinked(walk, traffic, weights, last, b)
    c, c_end = walk.tour[middle], walk.tour[last - 1]
    gain = estimate(traffic, weights, walk.slices[middle - 1], b_end, c)
    if move.turned_b:
        gain += turning_gain(walk, first, middle)
        b, b_end = b_end, b
    if move.turned_c:
        gain += turning_gain(walk, middle, last)
        c, c_end = c_end, c
    gain -= estimate(traffic, weights, walk.slices[last - 1], c_end, b)
    gain += relinked(walk, traffic, weights, first - 1, walk.tour[first], c)
    return gain + unlinked(walk, traffic, weights, last, b_end)


@inlined
def turning_gain(walk: DrivenTour, first: int, last: int) -> float:
    """Return by how much a part gets shorter inside if it is reversed."""
    return (walk.ahead[last - 1] - walk.ahead[first]) - (walk.back[last - 1] - walk.back[first])


@inlined
def relinked(
    walk: DrivenTour, traffic: Traffic, weights: Array, place: int, old: int, new: int
) -> float:
    """Return the gain if the leg from a place leads to another city; 0 before the first place."""
    if place < 0:
        return 0.0
    known, city = walk.slices[place], walk.tour[place]
    return estimate(traffic, weights, known, city, old) - estimate(
        traffic, weights, known, city, new
    )


@inlined
def unlinked(walk: DrivenTour, traffic: Traffic, weights: Array, last: int, new: int) -> float:
    """Return the gain if the leg to the city at place `last` comes from another one."""
    if last == len(walk.tour) and not traffic.closed:
        return 0.0
    known, city = walk.slices[last - 1], walk.tour[last % len(walk.tour)]
    return estimate(traffic, weights, known, walk.tour[last - 1], city) - estimate(
        traffic, weights, known, new, city
    )


@compiled
def value_after(walk: DrivenTour, traffic: Traffic, weights: Array, move: Move) -> float:
    """Return the weighted sum of the lengths after a move, by driving it; write_moved() was called.

    Infinity, where what follows the move begins no earlier and at no less cost than before.
    """
    tour, first, last = walk.tour, move.first, move.last
    if first == 0:
        city = walk.buffer[0]
        at = served(traffic, city, begun(traffic, walk.value[1]))
        first = 1
    else:
        city = tour[first - 1]
        at = moment(walk, first - 1)
    for k in range(first, last):
        at = served(traffic, walk.buffer[k], driven(traffic, city, walk.buffer[k], at, weights))
        city = walk.buffer[k]
    for k in range(last, len(tour)):
        at = served(traffic, tour[k], driven(traffic, city, tour[k], at, weights))
        city = tour[k]
        if at.time >= walk.times[k] and at.cost >= walk.costs[k]:
            return np.inf
    if traffic.closed:
        at = driven(traffic, city, tour[0], at, weights)
    return weights[traffic.clock] * (at.time - walk.value[1]) + at.cost


@compiled
def make(walk: DrivenTour, traffic: Traffic, weights: Array, move: Move) -> None:
    """Make a move; write_moved() was called."""
    for k in range(move.first, move.last):
        walk.tour[k] = walk.buffer[k]
    drive_on(walk, traffic, weights, move.first)
