"""The arrays of a fleet that few measures read: what is near, is promised, or spreads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.fleet.measures.overlap import Nearness, nearness
from service.fleet.measures.punctuality import deviations_of
from service.fleet.rules import Rules

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Nodes = NDArray[np.int32]
NO_PROMISE = -2


class Extras(NamedTuple):
    """The neighbours of n stops, the promises and the spread, where an objective needs them."""

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
    spreads: bool  # whether an objective depends on how times spread
    spread: float  # the deviation of a leg, as a share of it
    latest: Array  # (n, w), after which a visit is late that keeps a window: see Problem.windows
    deviations: Array  # (m,), above the mean up to a percentile; -1 where there is none
    most_deviations: float  # of the objective that is a maximum


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
    longest = "max" in rules.over
    deviations = np.array([_deviations(rules, each) for each in range(len(rules.over))])
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
        spreads=rules.of_days,
        spread=rules.spread or 0.0,
        latest=_latest(rules),
        deviations=deviations,
        most_deviations=max(0.0, deviations[rules.over.index("max")]) if longest else 0.0,
    )


def _deviations(rules: Rules, objective: int) -> float:
    percent = rules.percent(objective)
    return -1.0 if percent is None else deviations_of(percent)


def _latest(rules: Rules) -> Array:
    """Return after which time a visit in each window is late, shape (n, w)."""
    most = max(len(visit.windows) for visit in rules.visits)
    rows = [[min(closes, visit.due) for _, closes in visit.windows] for visit in rules.visits]
    return np.array([row + row[-1:] * (most - len(row)) for row in rows])
