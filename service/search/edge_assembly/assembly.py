"""Edge assembly: improve a tour by those parts of another tour that are better.

The steps in which two tours differ are divided into alternating cycles: a step of the one tour, a
step of the other, and so on. For each cycle the tour takes the other's steps if that makes it
shorter under its weighted sum. It may fall into several circuits then. These are joined again, the
smallest first, by the cheapest exchange of two steps, if enough of the gain is left. Costs must be
the same in both directions.
"""

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, compiled, inlined
from service.search.candidates import Scalarization, weighted_cost
from service.search.edge_assembly.alternating_cycles import alternating_cycles
from service.search.edge_assembly.cut_tour import (
    MOST_CUTS,
    CutTour,
    add_cut,
    lay_out,
    link,
    make_cut_tour,
    neighbouring_cut,
    segment_at,
    size_of,
    trace_circuits,
)
from service.search.three_opt.exchanges import wide
from service.search.working_tour import wrap

Cities = NDArray[np.int32]

LARGEST_CIRCUIT = 1_000  # cities: to look for a joint at each of them takes that long

# The cost of joining two circuits; then, for each of the two steps that are exchanged, the place in
# the tour at which it begins, and its direction. The directions are 0 where no joint was found.
Joint = tuple[float, int, int, int, int]


@allocating
def assemble(
    tours: tuple[Cities, Cities, Cities],
    scalarization: Scalarization,
    threshold: float,
    random: NDArray[np.int64],
) -> float:
    """Change a tour by all that gains more than a threshold of what another one has instead.

    Args:
        tours: The tour and the position of each city in it, which change, and the other tour.
        scalarization: The weighted sum, of symmetric costs, and the candidates.
        threshold: What a cycle must gain.
        random: The state of random_below().

    Returns:
        What has been gained in all.
    """
    tour, position, other = tours
    cities, ends = alternating_cycles(tour, position, other, random)
    cut = make_cut_tour(tour, position)
    gained, begin = 0.0, 0
    for end in ends:
        cycle = cities[begin:end]
        begin = end
        gain = gain_of(scalarization, cycle)
        if gain > threshold and cut_and_linked(cut, cycle):
            gained += join_circuits(cut, scalarization, gain, threshold)
    return gained


@compiled
def gain_of(scalarization: Scalarization, cycle: Cities) -> float:
    """Return what the own steps of a cycle cost more than those of the other tour."""
    gain = 0.0
    for k in range(0, len(cycle), 2):
        after = cycle[wrap(k + 2, len(cycle))]
        gain += weighted_cost(scalarization, cycle[k], cycle[k + 1])
        gain -= weighted_cost(scalarization, cycle[k + 1], after)
    return gain


@compiled
def cut_and_linked(cut: CutTour, cycle: Cities) -> bool:
    """Cut the tour at the own steps of a cycle, and link the ends by those of the other tour.

    Returns whether that was possible: not where the tour has lost one of the steps since.
    """
    n, count = len(cut.tour), len(cycle)
    cut.counts[0] = 0
    if count > 2 * MOST_CUTS:
        return False
    for k in range(0, count, 2):
        place, beyond = cut.position[cycle[k]], cut.position[cycle[k + 1]]
        if wrap(place + 1, n) == beyond:
            add_cut(cut, place)
        elif wrap(beyond + 1, n) == place:
            add_cut(cut, beyond)
        else:
            return False
    for k in range(1, count, 2):
        after = wrap(k + 1, count)
        link(cut, end_at(cut, k // 2, cycle[k]), end_at(cut, after // 2, cycle[after]))
    return True


@inlined
def end_at(cut: CutTour, number: int, city: int) -> int:
    """Return the end of a cut at which a city is."""
    return 2 * number if cut.tour[cut.places[number]] == city else 2 * number + 1


@compiled
def join_circuits(
    cut: CutTour, scalarization: Scalarization, gain: float, threshold: float
) -> float:
    """Join all circuits to one, lay the tour out, and return what is left of a gain.

    Where less than the threshold would be left, or a circuit is too large, the tour stays as it
    was, and nothing is gained.
    """
    trace_circuits(cut)
    while cut.counts[1] > 1:
        smallest = 0
        for circuit in range(1, cut.counts[1]):
            if cut.sizes[circuit] < cut.sizes[smallest]:
                smallest = circuit
        if cut.sizes[smallest] > LARGEST_CIRCUIT or cut.counts[0] + 2 > MOST_CUTS:
            return 0.0
        joint = cheapest_joint(cut, scalarization, smallest, gain - threshold)
        if joint[2] == 0:
            return 0.0
        gain -= joint[0]
        exchange_steps(cut, joint)
        trace_circuits(cut)
    lay_out(cut)
    return gain


@compiled
def cheapest_joint(cut: CutTour, scalarization: Scalarization, circuit: int, most: float) -> Joint:
    """Return the exchange of two steps that joins a circuit to any other at the least cost.

    Both are steps within segments; the cost is less than the most.
    """
    n = len(cut.tour)
    joint = most, wide(0), wide(0), wide(0), wide(0)
    for segment in range(cut.counts[0]):
        if cut.circuits[segment] != circuit:
            continue
        for k in range(1, size_of(cut, segment)):
            place = wide(wrap(cut.places[segment] + k, n))
            joint = joint_at(cut, scalarization, (place, wide(1)), joint)
            joint = joint_at(cut, scalarization, (wide(wrap(place + 1, n)), wide(-1)), joint)
    return joint


@inlined
def joint_at(
    cut: CutTour, scalarization: Scalarization, step: tuple[int, int], joint: Joint
) -> Joint:
    """Look for cheaper joints that add a step from a city to a candidate of it.

    The step from that city that they remove is given by its position and a direction.
    """
    n, tour = len(cut.tour), cut.tour
    place, direction = step
    city, beyond = tour[place], tour[wrap(place + direction, n)]
    removed = weighted_cost(scalarization, city, beyond)
    circuit = cut.circuits[segment_at(cut, place)]
    for k in range(scalarization.candidates.shape[1]):
        added = scalarization.candidate_costs[city, k] - removed
        if added >= joint[0]:
            break
        other = scalarization.candidates[city, k]
        other_place = wide(cut.position[other])
        segment = segment_at(cut, other_place)
        if cut.circuits[segment] == circuit:
            continue
        for side in (1, -1):
            if is_cut(cut, segment, other_place, side):
                continue
            behind = tour[wrap(other_place + side, n)]
            cost = added - weighted_cost(scalarization, other, behind)
            cost += weighted_cost(scalarization, beyond, behind)
            if cost < joint[0]:
                joint = cost, place, direction, other_place, wide(side)
    return joint


@inlined
def is_cut(cut: CutTour, segment: int, place: int, direction: int) -> bool:
    """Return whether the step from a city of a segment in a direction leaves the segment."""
    if direction == 1:
        return cut.places[neighbouring_cut(cut, segment, 1)] == place
    return wrap(cut.places[segment] + 1, len(cut.tour)) == place


@compiled
def exchange_steps(cut: CutTour, joint: Joint) -> None:
    """Cut both steps of a joint, and link the cities where they begin, and those where they end."""
    n = len(cut.tour)
    _, place, direction, other_place, side = joint
    one = 2 * add_cut(cut, place if direction == 1 else wrap(place - 1, n))
    other = 2 * add_cut(cut, other_place if side == 1 else wrap(other_place - 1, n))
    if direction == side:
        link(cut, one, other)
        link(cut, one + 1, other + 1)
    else:
        link(cut, one, other + 1)
        link(cut, one + 1, other)
