"""Overlap: how much the routes of a plan run through each other, as a dispatcher sees it.

Stops next to each other should ride together. Each stop has six neighbours, which is how many
places are next to a place in a plane, and each neighbour counts the more the nearer it is. The
overlap is the share of all neighbours that do not ride with their stop.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Array, Fleet
from service.fleet.plans import Route

_NEIGHBOURS = 6
_UNIT = 2.0**-44  # of weights: sums of them are exact, in any order
_REMEMBERED = 8  # latest fleets
Nodes = NDArray[np.int32]


class Nearness(NamedTuple):
    """The neighbours of each of n stops: of stops to visit those, of others no weights.

    Attributes:
        stops: The stops to visit that are nearest by the first costs, shape (n, k).
        weights: How near they are, shape (n, k). The sum of all is 1, but for a rounding.
    """

    stops: Nodes
    weights: Array


@lru_cache(_REMEMBERED)
def nearness(fleet: Fleet) -> Nearness:
    """Return the neighbours of the stops of a fleet. O(n^2).

    A neighbour at a distance d counts 1 / (1 + (d / m)^2), where m is the mean of these distances,
    divided by the sum of what all count.
    """
    rules = fleet.rules
    clients = np.array([stop for stop in rules.clients if rules.originals[stop] == stop])
    k = min(_NEIGHBOURS, len(clients) - 1)
    stops, away = np.zeros((rules.n, k), np.int32), np.full((rules.n, k), np.inf)
    for place, stop in enumerate(clients.tolist()) if k else ():
        # Of stops at one place each has others as neighbours: those that follow it.
        others = np.roll(clients, -place)[1:]
        legs = np.minimum(fleet.legs_from(0, stop), fleet.legs_to(0, stop))[others]
        farthest = np.partition(legs, k - 1)[k - 1]
        nearer, equal = np.flatnonzero(legs < farthest), np.flatnonzero(legs == farthest)
        chosen = np.concatenate((nearer, equal))[:k]
        stops[stop], away[stop] = others[chosen], legs[chosen]
    near = np.isfinite(away)
    mean = away[near].mean() if near.any() else 0.0
    weights = 1 / (1 + (away / (mean or 1.0)) ** 2)
    shares = weights / (weights.sum() or 1.0)
    return Nearness(stops, np.rint(shares / _UNIT) * _UNIT)


def overlap(fleet: Fleet, route: Route) -> float:
    """Return how much the neighbours of the stops of a route count that do not ride with them."""
    stops, weights = nearness(fleet)
    visited = np.array([fleet.rules.originals[stop] for stop in route.stops], np.int64)
    apart = ~np.isin(stops[visited], visited)
    return float(weights[visited].sum(where=apart))
