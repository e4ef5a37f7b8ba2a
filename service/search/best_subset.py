"""Best subsets: of the points of a front, those with the largest joint hypervolume."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.jit import allocating, inlined
from service.objectives import OBJECTIVES
from service.search.front_points import FrontPoints
from service.search.several.exchanges import CLOSE, exchange, make_places
from service.search.several.greedy_choice import (
    MOST_COMPARED,
    Choice,
    choose_next,
    make_choice,
)
from service.search.thinning import divided, evenly
from service.watch import Watch

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Stop = Callable[[], bool]

SHORTLY = 0.02  # seconds for the choice of a front that is reported on the way
_LEAST_SECONDS, _LEAST_SHARE, _SHARE = 0.05, 0.2, 0.045  # of the time limit, for the choice
# Seconds on a core of an EPYC, rather too many. Two objectives: for a point and a choice.
_A_PAIR = 1.5e-8
# Several objectives: for each point, and for a look at one, both times a power of the choices.
_A_POINT, _A_LOOK = {3: (1.2e-7, 0.66), 4: (1.4e-7, 0.70)}, {3: (2.5e-8, 0.75), 4: (7e-8, 0.68)}
_DIVIDING = 4e-7  # for each point: to divide the points into cells, and to find those close by
_MOST_DIVIDING = 0.4  # of the seconds: where there are more points, some are left out evenly
_SEEKING = 1e-9  # for each point: to find those that are close to one
_FIRST = 0.5  # of the seconds, for choosing one after another; of all where exchanges take longer
_ALMOST = 0.95  # of the seconds are over when the last point is exchanged
_PASSES = 10  # times that each chosen point is exchanged, at most
_PATIENCE = 4.0  # times as long as it may take, the choice goes on
_LESS = 0.3  # of the seconds, with which it begins again where the machine is too slow
_COLLECTING = 1e-6  # for each point found: to sort the archive, and to copy the points


def selection_limit(time_limit: float) -> float:
    """Return the seconds that choosing tours may take within a time limit of planning.

    4.5 % of the limit; 50 ms where that is less, but at most a fifth of the limit. Without a
    search, where the limit is 0, it is 50 ms.
    """
    if time_limit == 0:
        return _LEAST_SECONDS
    return max(_SHARE * time_limit, min(_LEAST_SECONDS, _LEAST_SHARE * time_limit))


def selection_seconds(size: int, points: int, objectives: int, seconds: float) -> float:
    """Return an estimate, rather too high, of what best_subset() takes, and collecting the points.

    Args:
        size: How many points are chosen.
        points: The number of points found.
        objectives: The number of objectives.
        seconds: The most that the choice may take.
    """
    choosing = 0.0 if points <= size else min(seconds, _needed(size, points, objectives))
    return choosing + _COLLECTING * points


def best_subset(
    front: FrontPoints, size: int, seconds: float = math.inf, stop: Stop = lambda: False
) -> Indices:
    """Return the ascending indices of the `size` points with the largest joint hypervolume.

    Of two objectives exact (Bringmann, Friedrich and Klitzke, 2014). Of more, points are chosen one
    after another, each time that which adds most: the hypervolume is at least 63 % of the largest
    (Nemhauser, Wolsey and Fisher, 1978). Then each is exchanged for a point close to it where that
    adds more. Where there are too many points for the seconds given, they are first thinned evenly.

    If there are at most `size` points, all are returned. If fewer than `size` lie below the
    reference point, the rest are others, evenly spread along the first length. O(k log k + k size)
    of two objectives.

    Args:
        front: The points.
        size: How many points to choose, at least 1.
        seconds: About how long the choice may take. What is chosen depends on it, and of several
            objectives on the clock.
        stop: Called for each point chosen; once it returns True, points that are evenly spread
            over the front are returned instead.

    Raises:
        ValueError: The size is not positive.

    >>> points = np.array([[2.0, 7.0], [4.0, 6.0], [5.0, 5.0], [7.0, 4.0]])
    >>> best_subset(FrontPoints(points, np.array([10.0, 10.0])), 2)
    array([0, 2])
    """
    if size < 1:
        raise ValueError(f"size must be at least 1, got {size}")
    if len(front) <= size:
        return np.arange(len(front))
    useful = front.inside
    if len(useful) > size:
        return np.sort(useful[_chosen(front.shares[useful], size, Watch(seconds, stop))])
    spare = np.setdiff1d(np.arange(len(front)), useful)
    return np.sort(np.concatenate((useful, evenly(spare, size - len(useful)))))


def _chosen(shares: Array, size: int, watch: Watch[Any]) -> Indices:
    """Return the indices of `size` points, all below 1, of more."""
    seconds = watch.seconds
    if shares.shape[1] > OBJECTIVES:
        most = int(min(len(shares), max(size, _MOST_DIVIDING * seconds / _DIVIDING)))
        looked_at = evenly(np.arange(len(shares)), most)
        return looked_at[_greedy(shares[looked_at], size, watch)]
    if len(shares) * _for_each(size, OBJECTIVES) <= seconds:
        return _best_of_front(shares, size, watch.stopped)
    affordable = max(size, int(seconds / _for_each(size, OBJECTIVES)))
    firsts = np.sort(divided(shares, affordable).firsts)
    if len(firsts) <= size:
        return _with_others(firsts, shares, size)
    return firsts[_best_of_front(np.ascontiguousarray(shares[firsts]), size, watch.stopped)]


def _needed(size: int, points: int, objectives: int) -> float:
    """Return the seconds that it takes to choose from all points, with one exchange of each."""
    choosing = points * _for_each(size, objectives)
    if objectives == OBJECTIVES:
        return choosing
    return choosing + _DIVIDING * points + size * _an_exchange(size, points, objectives)


def _for_each(size: int, objectives: int) -> float:
    """Return the seconds that choosing `size` points takes for each point of the front."""
    if objectives == OBJECTIVES:
        return _A_PAIR * size
    factor, power = _A_POINT[objectives]
    return float(factor * size**power)


def _a_look(size: int, objectives: int) -> float:
    """Return the seconds that it takes to find what a point adds to `size` others."""
    factor, power = _A_LOOK[objectives]
    return float(factor * size**power)


def _an_exchange(size: int, points: int, objectives: int) -> float:
    """Return the seconds that it takes to exchange one of `size` chosen points."""
    return CLOSE * _a_look(size, objectives) + _SEEKING * points


def _greedy(shares: Array, size: int, watch: Watch[Any]) -> Indices:
    """Return the indices of `size` of more points: chosen one after another, then exchanged.

    Where there is not enough time to choose all of them, the rest is evenly spread.
    """
    (points, objectives), seconds = shares.shape, watch.seconds
    most, wanted = _affordable(size, points, objectives, seconds - _DIVIDING * points)
    cells = divided(shares, most)
    choice = make_choice(shares, cells, size)
    while choice.counts[0] < wanted and not watch.stopped():
        if most > size and watch.spent > _PATIENCE * seconds:
            return _greedy(shares, size, watch.lasting(_LESS * seconds))
        choose_next(choice)
    if choice.counts[0] == size:
        if seconds < math.inf:
            seconds = min(_ALMOST * seconds, _needed(size, points, objectives))
        _exchange(choice, watch.until(seconds))
    return _with_others(choice.chosen[: choice.counts[0]], shares, size, cells.firsts)


def _exchange(choice: Choice, watch: Watch[Any]) -> None:
    """Exchange chosen points for others, until none changes or the time is over."""
    places, changed = make_places(choice.shares), True
    for _ in range(_PASSES):
        if not changed:
            break
        changed = False
        for point in choice.chosen.copy():
            if watch.ended():
                return
            changed |= exchange(choice, places, point)


def _comparing(points: float, size: int, objectives: int) -> float:
    """Return the seconds that it takes to find which point of a cell adds most to `size` others."""
    return min(points, MOST_COMPARED) * _a_look(size, objectives)


def _affordable(size: int, points: int, objectives: int, seconds: float) -> tuple[int, int]:
    """Return from how many cells points can be chosen by what they add, and how many of `size`.

    There are at least `size` cells. Exchanges get their share of the seconds where they end in it.
    """
    for_each = _for_each(size, objectives)
    if points * for_each <= seconds:
        return points, size
    exchanges = size * _an_exchange(size, points, objectives) < (1 - _FIRST) * seconds
    first = _FIRST * seconds if exchanges else seconds
    cells = int((first - size * _comparing(points / size, size, objectives)) / for_each)
    if cells > size:
        return cells, size
    wanted = size
    while wanted > 1:
        comparing = wanted * _comparing(points / size, wanted, objectives)
        if size * _for_each(wanted, objectives) + comparing <= seconds:
            break
        wanted -= 1 + wanted // 10
    return size, wanted


def _with_others(
    chosen: Indices, shares: Array, size: int, first: Indices | None = None
) -> Indices:
    """Return the chosen points and others: of those named first, then of all, evenly spread."""
    for others in (() if first is None else (first,)) + (np.arange(len(shares)),):
        if len(chosen) == size:
            break
        left = np.setdiff1d(others, chosen)
        chosen = np.concatenate((chosen, evenly(left, min(len(left), size - len(chosen)))))
    return chosen


def _best_of_front(shares: Array, size: int, stop: Callable[[], bool]) -> Indices:
    """Return the indices of the best `size` points of a front that has more.

    The points are scaled so that the reference point is (1, 1), and all lie below it. With x
    ascending and y descending, the best j points that end with point i have hypervolume
    h(j, i) = max over l < i of h(j - 1, l) + (1 - x[i]) (y[l] - y[i]): for each l a line in
    1 - x[i]. Slopes and arguments both descend, so one pass along the upper envelope of the lines
    serves all i (Bringmann, Friedrich and Klitzke, 2014).
    """
    m = len(shares)
    before = np.empty((size, m), np.int32)
    value = (1 - shares[:, 0]) * (1 - shares[:, 1])
    hull = np.empty(m, np.int32)
    for j in range(1, size):
        if stop():
            return np.linspace(0, m - 1, size).astype(np.intp)
        value = _one_point_more(shares, value, before[j], hull, j)
    last = int(np.argmax(value[size - 1 :])) + size - 1
    chosen = np.empty(size, np.intp)
    for j in range(size - 1, -1, -1):
        chosen[j] = last
        last = before[j, last]
    return chosen


@allocating
def _one_point_more(
    shares: Array, value: Array, before: NDArray[np.int32], hull: NDArray[np.int32], j: int
) -> Array:
    """Return h(j + 1, i) for all i from h(j, l), and fill in the l that it was reached from."""
    extended = np.full(len(shares), -np.inf)
    head, tail = 0, 0
    for i in range(j, len(shares)):
        while tail - head > 1 and _hidden(shares, value, hull[tail - 2], hull[tail - 1], i - 1):
            tail -= 1
        hull[tail] = i - 1
        tail += 1
        x = 1 - shares[i, 0]
        while tail - head > 1 and _at(shares, value, hull[head + 1], x) >= _at(
            shares, value, hull[head], x
        ):
            head += 1
        before[i] = hull[head]
        extended[i] = _at(shares, value, hull[head], x) - x * shares[i, 1]
    return extended


@inlined
def _at(shares: Array, value: Array, line: int, x: float) -> float:
    """Return the height at x of the line of point `line`."""
    return value[line] + x * shares[line, 1]


@inlined
def _hidden(shares: Array, value: Array, a: int, b: int, c: int) -> bool:
    """Return whether line b, between a and c by slope, is nowhere above both of them."""
    ab = (value[b] - value[a]) * (shares[b, 1] - shares[c, 1])
    bc = (value[c] - value[b]) * (shares[a, 1] - shares[b, 1])
    return bc >= ab
