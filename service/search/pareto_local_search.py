"""Filling the front between the points that weighted sums reach.

A Pareto local search (Paquete, Chiarandini and Stuetzle, 2004) that looks round one tour of the
front at a time. Neighbours are drawn, by iterated descent under the weight at which the front
slopes just there, rather than enumerated; each is judged under both objectives.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined
from service.search.archive import Archive
from service.search.candidates import Scalarization
from service.search.costs import Costs
from service.search.local_search import draw, iterated_local_search
from service.search.working_tour import Route, take

Array = NDArray[np.float64]

CONTESTANTS = 8
STEPS = 10
REACH = 5  # points to either side over which the slope of the front is taken


class WeightedCandidates(NamedTuple):
    """Weights spread over all trade-offs, and the candidate lists under each."""

    weights: Array  # (k, 2), rows adding to 1, by ascending first weight
    near: NDArray[np.int32]  # (k, n, nearest)
    near_costs: Array  # (k, n, nearest)


class SearchState(NamedTuple):
    """What a search stands on."""

    costs: Costs
    fan: WeightedCandidates
    archive: Archive
    route: Route
    random: NDArray[np.int64]  # (1,), the state of the generator


@inlined
def span(archive: Archive, k: int, reach: int) -> tuple[float, float]:
    """Width and height of the stretch of front round a point."""
    before, after = max(k - reach, 0), min(k + reach, archive.counts[0] - 1)
    return (
        archive.points[after, 0] - archive.points[before, 0],
        archive.points[before, 1] - archive.points[after, 1],
    )


@compiled
def choose(archive: Archive, random: NDArray[np.int64]) -> int:
    """Of a few points drawn at random, the one with most to win beside it.

    That is the hypervolume left between its neighbours, the less the more often it was sought.
    """
    found, most = 0, -1.0
    for _ in range(CONTESTANTS):
        k = draw(random, archive.counts[0])
        width, height = span(archive, k, 1)
        value = width * height / (1 + archive.tries[archive.slots[k]])
        if value > most:
            found, most = k, value
    return found


@compiled
def scalar_at(state: SearchState, k: int) -> Scalarization:
    """The weighted sum under which the front is level round a point."""
    width, height = span(state.archive, k, REACH)
    w0 = height / (width + height) if width + height > 0 else 0.5
    fan = state.fan
    k = min(int(np.searchsorted(fan.weights[:, 0], w0)), len(fan.weights) - 1)
    weight = fan.weights[k]
    return Scalarization(state.costs, fan.near[k], fan.near_costs[k], weight[0], weight[1])


@compiled
def fill(state: SearchState, rounds: int) -> None:
    """Sets out so many times from a point with room beside it."""
    archive, route = state.archive, state.route
    for _ in range(rounds):
        k = choose(archive, state.random)
        slot = archive.slots[k]
        archive.tries[slot] += 1
        scalar = scalar_at(state, k)
        take(route, archive.tours[slot], archive.points[k, 0], archive.points[k, 1])
        iterated_local_search(route, scalar, archive, state.random, STEPS, True)
