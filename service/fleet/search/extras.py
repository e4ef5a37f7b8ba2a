"""The arrays of a fleet that only overlap and changes read: what is near, and what is promised."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.fleet.overlap import Nearness, nearness

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Nodes = NDArray[np.int32]
NO_PROMISE = -2


class Extras(NamedTuple):
    """The neighbours of each of n stops and the promises, if an objective needs them."""

    overlaps: bool  # whether overlap is an objective
    beside: Nodes  # (n, k), the neighbours of each stop, and how much each counts: see overlap.py
    weights: Array  # (n, k)
    pairs: Nodes  # (l,), stop by stop, its neighbours and those whose neighbour it is
    pair_weights: Array  # (l,), how much both count together
    first_pair: Indices  # (n + 1,), where those of each stop begin
    promises: bool  # whether changes are an objective
    promised_to: Nodes  # (n,), the type that should visit it; -1 if that is gone; NO_PROMISE
    promised_until: Array  # (n,), when its visit begins at the latest
    holds: Array  # (n,), when a visit begins at the latest so that its vehicle leaves later


def extras_of(fleet: Fleet) -> Extras:
    """Return the arrays of a fleet. O(n^2) if overlap is an objective."""
    rules = fleet.rules
    overlaps = "overlap" in rules.over
    near = nearness(fleet) if overlaps else Nearness(np.empty((1, 0), np.int32), np.empty((1, 0)))
    n, k = near.stops.shape
    one, other = np.repeat(np.arange(n), k), near.stops.ravel()
    both = np.concatenate((one * n + other, other * n + one))
    pairs, places = np.unique(both, return_inverse=True)
    pair_weights = np.zeros(len(pairs))
    np.add.at(pair_weights, places, np.tile(near.weights.ravel(), 2))
    types = (visit.promised_to for visit in rules.visits)
    return Extras(
        overlaps=overlaps,
        beside=near.stops,
        weights=near.weights,
        pairs=(pairs % n).astype(np.int32),
        pair_weights=pair_weights,
        first_pair=np.searchsorted(pairs, np.arange(n + 1) * n),
        promises="changes" in rules.over,
        promised_to=np.array([NO_PROMISE if each is None else each for each in types], np.int32),
        promised_until=np.array(rules.promised_until),
        holds=np.array(rules.holds),
    )
