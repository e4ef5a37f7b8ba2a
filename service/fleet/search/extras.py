"""The arrays of a fleet that few need: bounds, neighbours, promises, spreads, waiting visits."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.fleet.measures.overlap import Nearness, nearness
from service.fleet.measures.punctuality import day_at, deviations_of
from service.fleet.rules import Rules

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Nodes = NDArray[np.int32]
Flags = NDArray[np.bool_]
NO_PROMISE = -2
_NEAR = 100  # stops that are near a stop, at most


class Extras(NamedTuple):
    """The neighbours of n stops, the promises and the spread, where an objective needs them."""

    times_beside: Array  # (n, k, 2), of legs from the neighbours of each stop, and to them
    least_times: Array  # (n, 2), of any leg to each stop, and from it
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
    days: int  # on which the times of legs are known; 0 if they are not
    sampled: Array  # (n, n, d), these times, and
    speeds: Array  # (v,) what they are divided by for each type of vehicles
    day_at: Indices  # (m,), the place of the day in order that each percentile is of
    most_day: int  # of the objective that is a maximum
    latest: Array  # (n, w), after which a visit is late that keeps a window: see Problem.windows
    deviations: Array  # (m,), above the mean up to a percentile; -1 where there is none
    most_deviations: float  # of the objective that is a maximum


class Waits(NamedTuple):
    """The pairs of n stops whose second visit waits for the first, whoever drives.

    The windows of these stops in `Problem` are what the plan that is changed leaves of their own:
    from `since` to `until`.
    """

    given: bool  # whether there are any
    stops: Nodes  # (p,), all stops of these pairs
    firsts: Nodes  # (n, x), for which the visit of each stop waits; -1 after the last
    first_gaps: Array  # (n, x), how long it waits after each
    thens: Nodes  # (n, y), those that wait for it; -1 after the last
    then_gaps: Array  # (n, y)
    windows: Array  # (n, w, 2), the windows of the stops themselves
    since: Array  # (n,), from when on each visit may begin
    until: Array  # (n,), and until when, so that no other begins later than it does
    settled: Array  # (n,), scratch space: the same before
    stale: Flags  # (r,), scratch space: the routes to measure again


def waits_of(rules: Rules, windows: Array, routes: int) -> Waits:
    """Return the pairs of stops whose visits wait, if there are any.

    Args:
        rules: The rules.
        windows: The windows of n stops, shape (n, w, 2).
        routes: The most routes of a plan.
    """
    waiting = rules.groups.waiting
    n = rules.n if waiting else 1
    firsts: list[dict[int, float]] = [{} for _ in range(n)]
    thens: list[dict[int, float]] = [{} for _ in range(n)]
    for (first, then), gap in waiting.items():
        firsts[then][first] = thens[first][then] = gap
    return Waits(
        given=bool(waiting),
        stops=np.array(sorted({stop for pair in waiting for stop in pair}), np.int32),
        firsts=_filled(firsts, lambda each: [*each], -1).astype(np.int32),
        first_gaps=_filled(firsts, lambda each: [*each.values()], 0.0),
        thens=_filled(thens, lambda each: [*each], -1).astype(np.int32),
        then_gaps=_filled(thens, lambda each: [*each.values()], 0.0),
        windows=windows.copy() if waiting else np.empty((n, 1, 2)),
        since=np.zeros(n),
        until=np.full(n, np.inf),
        settled=np.full(n, np.inf),
        stale=np.zeros(routes if waiting else 1, np.bool_),
    )


def _filled(
    rows: Sequence[dict[int, float]], values: Callable[[dict[int, float]], list[float]], rest: float
) -> Array:
    """Return a row of numbers for each of these, filled up to one length."""
    filled = np.full((len(rows), max(1, *map(len, rows))), rest)
    for row, each in zip(filled, rows, strict=True):
        row[: len(each)] = values(each)
    return filled


def extras_of(fleet: Fleet, forbidden: float, neighbours: Nodes) -> Extras:
    """Return the arrays of a fleet. O(n^2).

    Args:
        fleet: A fleet.
        forbidden: What a forbidden leg costs.
        neighbours: The k neighbours of each stop beside which it is tried, shape (n, k).
    """
    rules = fleet.rules
    beside, least = _least_times(fleet, neighbours)
    overlaps = "overlap" in rules.over
    near = nearness(fleet) if overlaps else Nearness(np.empty((1, 0), np.int32), np.empty((1, 0)))
    n, k = near.stops.shape
    one, other = np.repeat(np.arange(n), k), near.stops.ravel()
    both = np.concatenate((one * n + other, other * n + one))
    pairs, places = np.unique(both, return_inverse=True)
    pair_weights = np.zeros(len(pairs))
    np.add.at(pair_weights, places, np.tile(near.weights.ravel(), 2))
    sampled = _sampled(fleet, forbidden)
    days = sampled.shape[-1]
    longest = "max" in rules.over
    deviations = np.array([_deviations(rules, each) for each in range(len(rules.over))])
    types = (visit.promised_to for visit in rules.visits)
    return Extras(
        times_beside=np.minimum(beside, forbidden),
        least_times=np.minimum(least, forbidden),
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
        days=days,
        sampled=sampled,
        speeds=np.array([vehicle.speed_factor for vehicle in rules.vehicles]),
        day_at=np.array([day_at(rules.percent(m) or 0, days) for m in range(len(rules.over))]),
        most_day=day_at(rules.percent(rules.over.index("max")) or 0, days) if longest else 0,
        latest=_latest(rules),
        deviations=deviations,
        most_deviations=max(0.0, deviations[rules.over.index("max")]) if longest else 0.0,
    )


def _least_times(fleet: Fleet, neighbours: Nodes) -> tuple[Array, Array]:
    """Return bounds on the times of legs: see Extras. They are 0 where times are not all known."""
    rules = fleet.rules
    beside, least = np.zeros((*neighbours.shape, 2)), np.zeros((rules.n, 2))
    paces = {(each.speed_factor, each.profile) for each in rules.vehicles}
    if rules.clock is None or fleet.day is not None or rules.reloads or paces != {(1, 0)}:
        return beside, least
    near, stops = neighbours.astype(np.int64), np.arange(rules.n)[:, np.newaxis]
    if fleet.lines:
        beside[:] = fleet.lines[rules.clock].legs(near, stops)[:, :, np.newaxis]
    else:
        costs = fleet.costs[rules.clock]
        beside[:, :, 0], beside[:, :, 1] = costs[near, stops], costs[stops, near]
    to, away = fleet.nearest(rules.clock)
    # A leg from anywhere, or to anywhere, takes no time.
    least[:, 0] = 0 if any(each.start is None for each in rules.vehicles) else to
    least[:, 1] = 0 if any(each.end is None for each in rules.vehicles) else away
    return beside, least


def neighbours_of(fleet: Fleet, clients: Nodes) -> Nodes:
    """Return the nearest stops to visit of each stop, shape (n, k), in both costs together."""
    k = min(_NEAR, len(clients) - 1)
    near = np.zeros((fleet.rules.n, k), np.int32)
    for stop in clients.tolist():
        away = fleet.away(stop)[clients]
        away[clients == stop] = np.inf
        first = np.argpartition(away, k - 1)[:k] if k else np.empty(0, int)
        near[stop] = clients[first[np.argsort(away[first], kind="stable")]]
    return near


def _sampled(fleet: Fleet, forbidden: float) -> Array:
    """Return the times of legs on d days, shape (n, n, d), if an objective depends on them."""
    if fleet.sampled is None or not fleet.rules.of_days:
        return np.empty((0, 0, 0))
    finite = np.where(np.isinf(fleet.sampled), forbidden, fleet.sampled)
    return np.ascontiguousarray(np.moveaxis(finite, 0, -1))


def _deviations(rules: Rules, objective: int) -> float:
    percent = rules.percent(objective)
    return -1.0 if percent is None else deviations_of(percent)


def _latest(rules: Rules) -> Array:
    """Return after which time a visit in each window is late, shape (n, w)."""
    most = max(len(visit.windows) for visit in rules.visits)
    rows = [[min(closes, visit.due) for _, closes in visit.windows] for visit in rules.visits]
    return np.array([row + row[-1:] * (most - len(row)) for row in rows])
