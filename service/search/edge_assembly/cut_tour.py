"""A tour that is cut at some steps, and the circuits that new links between the ends make.

The ends of cut i are numbered 2 i, the city before it, and 2 i + 1, the city behind it. Segment i
begins behind cut i and goes on to the next cut along the tour. Each end has a mate, to which a step
is added. Following segments and mates in turn gives one circuit, which is a tour again, or several,
which are not.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, by_reference, compiled, inlined
from service.search.working_tour import wrap

Cities = NDArray[np.int32]
Numbers = NDArray[np.int64]

MOST_CUTS = 400
NONE = -1


@by_reference
class CutTour(NamedTuple):
    """A tour, its inverse, the cuts, and the circuits that its segments make."""

    tour: Cities  # (n,)
    position: Cities  # (n,)
    places: Numbers  # (MOST_CUTS,), by cut: the position of the city before it
    mates: Numbers  # (2 MOST_CUTS,), by end
    order: Numbers  # (MOST_CUTS,), the cuts along the tour
    ranks: Numbers  # (MOST_CUTS,), by cut: where it is in that order
    circuits: Numbers  # (MOST_CUTS,), by segment: the circuit that it is part of
    sizes: Numbers  # (MOST_CUTS,), by circuit: the number of cities
    counts: Numbers  # (2,): of cuts, of circuits
    buffer: Cities  # (n,), scratch space of lay_out()


@allocating
def make_cut_tour(tour: Cities, position: Cities) -> CutTour:
    """Return a tour, given with the position of each city, without any cut."""
    return CutTour(
        tour,
        position,
        np.zeros(MOST_CUTS, np.int64),
        np.zeros(2 * MOST_CUTS, np.int64),
        np.zeros(MOST_CUTS, np.int64),
        np.zeros(MOST_CUTS, np.int64),
        np.zeros(MOST_CUTS, np.int64),
        np.zeros(MOST_CUTS, np.int64),
        np.zeros(2, np.int64),
        np.empty(len(tour), np.int32),
    )


@inlined
def add_cut(cut: CutTour, place: int) -> int:
    """Cut the step from the city at a position to the next, and return the number of the cut."""
    number = rank = cut.counts[0]
    cut.counts[0] += 1
    cut.places[number] = place
    while rank > 0 and cut.places[cut.order[rank - 1]] > place:
        cut.order[rank] = cut.order[rank - 1]
        cut.ranks[cut.order[rank]] = rank
        rank -= 1
    cut.order[rank], cut.ranks[number] = number, rank
    return number


@inlined
def link(cut: CutTour, end: int, other: int) -> None:
    """Make two ends each other's mates."""
    cut.mates[end], cut.mates[other] = other, end


@inlined
def neighbouring_cut(cut: CutTour, number: int, direction: int) -> int:
    """Return the cut that comes next along the tour in a direction."""
    return cut.order[wrap(cut.ranks[number] + direction, cut.counts[0])]


@inlined
def size_of(cut: CutTour, segment: int) -> int:
    """Return the number of cities of a segment."""
    last = cut.places[neighbouring_cut(cut, segment, 1)]
    return wrap(last - cut.places[segment], len(cut.tour))


@inlined
def segment_at(cut: CutTour, place: int) -> int:
    """Return the segment that holds the city at a position."""
    low, high = 0, cut.counts[0]
    while low < high:
        middle = (low + high) // 2
        if cut.places[cut.order[middle]] < place:
            low = middle + 1
        else:
            high = middle
    return cut.order[wrap(low - 1, cut.counts[0])]


@inlined
def segment_from(cut: CutTour, end: int) -> int:
    """Return the segment that begins or ends with this end of a cut."""
    return end // 2 if end % 2 == 1 else neighbouring_cut(cut, end // 2, -1)


@inlined
def across(cut: CutTour, end: int) -> int:
    """Return the end on the other side of the segment that begins or ends with this one."""
    if end % 2 == 1:
        return 2 * neighbouring_cut(cut, end // 2, 1)
    return 2 * neighbouring_cut(cut, end // 2, -1) + 1


@compiled
def trace_circuits(cut: CutTour) -> None:
    """Find the circuits that the segments make, and their sizes."""
    segments = cut.counts[0]
    for segment in range(segments):
        cut.circuits[segment] = NONE
    count = 0
    for first in range(segments):
        if cut.circuits[first] != NONE:
            continue
        cut.sizes[count] = 0
        end, segment = 2 * first + 1, first
        while cut.circuits[segment] == NONE:
            cut.circuits[segment] = count
            cut.sizes[count] += size_of(cut, segment)
            end = cut.mates[across(cut, end)]
            segment = segment_from(cut, end)
        count += 1
    cut.counts[1] = count


@compiled
def lay_out(cut: CutTour) -> None:
    """Put the tour in its new order, and clear the cuts: all segments must make one circuit.

    The longest segment stays where it is.
    """
    n = len(cut.tour)
    longest = 0
    for segment in range(1, cut.counts[0]):
        if size_of(cut, segment) > size_of(cut, longest):
            longest = segment
    end = cut.mates[across(cut, 2 * longest + 1)]
    moved = 0
    while segment_from(cut, end) != longest:
        segment = segment_from(cut, end)
        size = size_of(cut, segment)
        for k in range(1, size + 1):
            step = k if end % 2 == 1 else size + 1 - k
            cut.buffer[moved] = cut.tour[wrap(cut.places[segment] + step, n)]
            moved += 1
        end = cut.mates[across(cut, end)]
    place = cut.places[neighbouring_cut(cut, longest, 1)]
    for k in range(moved):
        place = wrap(place + 1, n)
        cut.tour[place] = cut.buffer[k]
        cut.position[cut.buffer[k]] = place
    cut.counts[0] = 0
