"""The goals that a front is swept with, each chosen by what is known when its turn comes.

Of a sum against a maximum they are limits on the longest route (the epsilon-constraint method); of
two sums they are weights, the normals of the hull's edges (Aneja and Nair, 1979), which reach
supported points alone. Rounds repeat with twice as many iterations each.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count, pairwise
from math import inf

import numpy as np
import pyvrp

from service.fleet.archive import Point, SolutionArchive
from service.fleet.translation import UNBOUNDED, Goal, Translation

FEW_STOPS = 12  # of so few the sweep looks for every point
_FIRST_ITERATIONS = 100
_FREE_SHARE = 0.12  # of all iterations: the least sum without a limit, from which all others start
_MOST_DOUBLINGS = 10
_ROUGH_LIMITS, _ROUGH_ITERATIONS = 6, 50  # of the first round
_LIMITS = 24  # of each further round
_LEAST_ITERATIONS, _MOST_ITERATIONS = 50, 3000  # of a limit in one round
_STEEPEST = 1000  # weight of one objective, with 1 of the other
_IDLE_ROUNDS = 3  # without a new solution, after which the sweep of few stops has converged


@dataclass(frozen=True)
class Step:
    """A search to run: its goal, the solution that it starts from, and its iterations."""

    goal: Goal
    start: pyvrp.Solution | None
    iterations: int


class Sweep:
    """The searches for a front, each to be run into the archive before the next is asked for.

    Args:
        translation: Of the fleet.
        archive: Where the solutions of all searches are.
        random: Chooses limits.
        left: Estimates how many iterations there is time for.
    """

    def __init__(
        self,
        translation: Translation,
        archive: SolutionArchive,
        random: np.random.Generator,
        left: Callable[[], float],
    ) -> None:
        self._translation = translation
        self._archive = archive
        self._random = random
        self._left = left
        self._limited = translation.roles.limited is not None
        self._few = len(translation.fleet.rules.clients) <= FEW_STOPS

    def steps(self) -> Iterator[Step]:
        """Yield the searches.

        They end where few stops are left without anything to find: that is likely, and no proof.
        """
        yield from self._first_steps()
        idle = 0
        for number in count():
            before = self._archive.version
            yield from self._round(number)
            idle = 0 if self._archive.version > before else idle + 1
            if self._few and idle >= _IDLE_ROUNDS:
                return

    def _first_steps(self) -> Iterator[Step]:
        """Yield searches for the least sum alone, until there is a solution, and one from it."""
        free = Goal(weights=self._translation.sum_weights if self._limited else (1, 1))
        iterations = _FIRST_ITERATIONS
        yield Step(free, None, iterations)
        while not len(self._archive):
            iterations *= 2
            yield Step(free, None, iterations)
        if self._limited and not self._few:
            share = int(_FREE_SHARE * self._left())
            first = self._translation.roles.limited != 0
            yield Step(free, self._archive.solutions[0 if first else -1], share)

    def _round(self, number: int) -> Iterator[Step]:
        iterations = _FIRST_ITERATIONS * 2 ** min(number, _MOST_DOUBLINGS)
        if not self._limited:
            return _weight_round(self._archive, iterations, self._translation)
        if self._few:
            return _LimitRound(self._translation, self._archive, iterations).every_limit()
        if number == 0:
            rough = _LimitRound(self._translation, self._archive, _ROUGH_ITERATIONS)
            return rough.wide_limits(_ROUGH_LIMITS, lambda: 0.5, lowest=True)
        share = int(self._left() / _LIMITS)
        iterations = max(_LEAST_ITERATIONS, min(_MOST_ITERATIONS, share))
        fine = _LimitRound(self._translation, self._archive, iterations)
        return fine.wide_limits(_LIMITS, lambda: self._random.uniform(0.3, 0.7))


class _LimitRound:
    """A round of limits on the longest route."""

    def __init__(self, translation: Translation, archive: SolutionArchive, iterations: int) -> None:
        self._translation = translation
        self._archive = archive
        self._iterations = iterations
        maximum = translation.roles.limited
        assert maximum is not None
        self._maximum = maximum

    def every_limit(self) -> Iterator[Step]:
        """Yield a search just below the longest route of each solution."""
        done: set[int] = set()
        while True:
            limits = {self._limit(point[self._maximum]) - 1 for point in self._archive.points}
            left = limits - done
            if not left:
                return
            limit = max(left)
            done.add(limit)
            yield self._step(limit)

    def wide_limits(
        self, most: int, share: Callable[[], float], lowest: bool = False
    ) -> Iterator[Step]:
        """Yield searches at so many limits, each at a share of the widest gap between others.

        With `lowest`, the first is at about the lowest that can be.
        """
        longest = [point[self._maximum] for point in self._archive.points]
        intervals = [(self._least_limit(), self._limit(max(longest)))]
        if lowest:
            yield self._step(intervals[0][0])
        for _ in range(most):
            intervals.sort(key=self._area)
            low, high = intervals.pop()
            limit = low + int(share() * (high - low))
            yield self._step(limit)
            intervals += [(low, limit), (limit, high)]

    def _area(self, interval: tuple[int, int]) -> float:
        """Return the area between two limits in which nothing is known."""
        low, high = interval
        return (high - low) * (self._sum_within(low) - self._sum_within(high))

    def _sum_within(self, limit: int) -> float:
        """Return the least sum within a limit; a high one where no solution is."""
        points = self._archive.points
        sums = [point[1 - self._maximum] for point in points]
        within = [
            point[1 - self._maximum]
            for point in points
            if self._limit(point[self._maximum]) <= limit
        ]
        return min(within, default=2 * max(sums) - min(sums))

    def _step(self, limit: int) -> Step:
        goal = Goal(weights=self._translation.sum_weights, limit=max(0, limit))
        return Step(goal, self._nearest(limit), self._iterations)

    def _nearest(self, limit: int) -> pyvrp.Solution:
        """Return the solution with the least sum within a limit, or else the least maximum."""
        pairs = list(zip(self._archive.points, self._archive.solutions, strict=True))
        maximum = self._maximum
        within = [pair for pair in pairs if self._limit(pair[0][maximum]) <= limit]
        if within:
            return min(within, key=lambda pair: pair[0][1 - maximum])[1]
        return min(pairs, key=lambda pair: pair[0][maximum])[1]

    def _limit(self, length: float) -> int:
        return round(length * self._translation.limit_scale)

    def _least_limit(self) -> int:
        """Return about the least limit that lets each stop be visited alone."""
        fleet = self._translation.fleet
        rules, costs = fleet.rules, fleet.costs[self._maximum]
        alone = np.full(rules.n, inf)
        for vehicle in rules.vehicles:
            there = 0.0 if vehicle.start is None else costs[vehicle.start]
            back = 0.0 if vehicle.end is None else costs[:, vehicle.end]
            alone = np.minimum(alone, there + back)
        required = [s for s in rules.clients if rules.visits[s].prize is None]
        return min(UNBOUNDED, self._limit(float(alone[required].max(initial=0.0))))


def _weight_round(
    archive: SolutionArchive, iterations: int, translation: Translation
) -> Iterator[Step]:
    """Yield searches under the weights of both ends of the front, and of all edges of its hull."""
    for weights in ((_STEEPEST, 1), (1, _STEEPEST)):
        yield _weighted(archive, weights, translation, iterations)
    done: set[tuple[Point, Point]] = set()
    while True:
        edges = [edge for edge in pairwise(_hull(archive.points)) if edge not in done]
        if not edges:
            return
        edge = max(edges, key=_triangle)
        done.add(edge)
        (x1, y1), (x2, y2) = edge
        yield _weighted(archive, (y1 - y2, x2 - x1), translation, iterations)


def _weighted(
    archive: SolutionArchive,
    weights: tuple[float, float],
    translation: Translation,
    iterations: int,
) -> Step:
    """Return a search under weights of both objectives, from the solution that is best there."""
    points = np.array(archive.points)
    start = archive.solutions[int((points @ np.array(weights)).argmin())]
    roles = translation.roles
    of_distance = weights[roles.distance] / translation.distance_scale
    of_duration = weights[1 - roles.distance] / translation.duration_scale
    unit = max(of_distance, of_duration) / _STEEPEST
    whole = (max(1, round(of_distance / unit)), max(1, round(of_duration / unit)))
    return Step(Goal(weights=whole), start, iterations)


def _triangle(edge: tuple[Point, Point]) -> float:
    """Return the area of the box between two neighbours."""
    (x1, y1), (x2, y2) = edge
    return (x2 - x1) * (y1 - y2)


def _hull(points: list[Point]) -> list[Point]:
    """Return the points of a front that lie on its lower left hull, from left to right."""
    hull: list[Point] = []
    for point in points:
        while len(hull) > 1 and _above(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    return hull


def _above(a: Point, b: Point, c: Point) -> bool:
    """Return whether b is on or above the line from a to c."""
    return (b[0] - a[0]) * (c[1] - a[1]) <= (c[0] - a[0]) * (b[1] - a[1])
