"""The searches for a front of plans, in order. Each depends on the results of those before.

A sum against a maximum is searched under limits on the longest route (epsilon-constraint). Two sums
are searched under weights, which are the normals of the edges of the front's hull (Aneja and Nair,
1979). Weights reach supported points only.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from itertools import count, pairwise

import numpy as np
import pyvrp

from service.fleet.archive import Point, SolutionArchive
from service.fleet.fleet import least_paths
from service.fleet.goal import Goal
from service.fleet.scales import STEEPEST, UNBOUNDED
from service.fleet.solver import Step
from service.fleet.translation import Translation

FEW_STOPS = 12  # up to this number of stops, the sweep looks for every point
FIRST_ITERATIONS = 100
LEAST_ITERATIONS = 50  # for a limit in one round
_FREE_SHARE = 0.25  # share of all iterations for the least sum without a limit, the first search
_MOST_DOUBLINGS = 10
_ROUGH_LIMITS, _ROUGH_ITERATIONS = 7, 50  # in the first round
_LIMITS = 24  # in each further round
_MOST_ITERATIONS = 3000  # for a limit in one round
_IDLE_ROUNDS = 3  # rounds without a new solution, after which a sweep of few stops has converged
_ROUNDED = 3  # units by which a route to one stop is rounded up: two legs and a service
_UNKNOWN = 0.1  # share of the greatest sum that an unknown sum exceeds it by, at least


class Searches(ABC):
    """The searches for a front. Each must be run into the archive before the next is requested.

    Args:
        translation: The translation of the fleet.
        archive: The solutions of all searches; it may hold some already.
        random: Chooses weights and limits.
        left: Estimates the number of iterations for which there is time.
    """

    def __init__(
        self,
        translation: Translation,
        archive: SolutionArchive,
        random: np.random.Generator,
        left: Callable[[], float],
    ) -> None:
        self._translation = translation
        self._rules = translation.fleet.rules
        self._archive = archive
        self._random = random
        self._left = left

    @abstractmethod
    def steps(self) -> Iterator[Step]:
        """Yield the searches."""

    def _until_found(self, goal: Goal, start: pyvrp.Solution | None) -> Iterator[Step]:
        """Yield a search, and longer ones until there is a solution."""
        iterations = FIRST_ITERATIONS
        yield Step(goal, start, iterations)
        while not len(self._archive):
            iterations *= 2
            yield Step(goal, None, iterations)

    def _grown(self, round_number: int) -> int:
        """Return the iterations of a search in a round: each round has twice those before."""
        return FIRST_ITERATIONS * 2 ** min(round_number, _MOST_DOUBLINGS)

    def _iterations(self, round_number: int, searches: int) -> int:
        """Return the iterations of each of the searches of a round for which there is time."""
        share = self._left() / searches
        return max(LEAST_ITERATIONS, int(min(self._grown(round_number), share)))

    def _cheapest(self) -> pyvrp.Solution | None:
        """Return the solution of the least first length, or None."""
        return self._archive.solutions[0] if len(self._archive) else None


class SumSweep(Searches):
    """The searches for a sum against a maximum, another sum, or the prizes of what is left out."""

    def __init__(
        self,
        translation: Translation,
        archive: SolutionArchive,
        random: np.random.Generator,
        left: Callable[[], float],
    ) -> None:
        super().__init__(translation, archive, random, left)
        rules = self._rules
        self._two_sums = rules.maximum is None
        self._maximum = 0 if rules.maximum is None else rules.maximum
        self._limit_scale = translation.scales[self._maximum]
        self._weighs_prizes = "unassigned" in rules.over
        self._few = len(rules.clients) <= FEW_STOPS

    def steps(self) -> Iterator[Step]:
        """Yield the searches.

        For few stops they end once nothing new is found. Then the front is likely, but not surely,
        exact.
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
        """Yield searches for the least sum alone until there is a solution, and one from there.

        The first search shows how long iterations take.
        """
        both = self._two_sums and not self._weighs_prizes
        weights = (1, 1) if both else self._translation.sum_weights
        free = Goal(weights=weights, prizes=int(self._weighs_prizes))
        yield from self._until_found(free, self._least_sum())
        if not self._two_sums and not self._few:
            yield Step(free, self._least_sum(), int(_FREE_SHARE * self._left()))

    def _least_sum(self) -> pyvrp.Solution | None:
        """Return the solution of the least sum, or of the least first of two sums, or None."""
        if not len(self._archive):
            return None
        return self._archive.solutions[0 if self._two_sums or self._maximum == 1 else -1]

    def _round(self, number: int) -> Iterator[Step]:
        """Yield the searches of a round; for few stops or two sums they get longer every round."""
        iterations = self._grown(number)
        if self._two_sums:
            return self._hull_weights(iterations)
        if self._few:
            return self._every_limit(iterations)
        if number == 0:
            return self._wide_limits(_ROUGH_LIMITS, _ROUGH_ITERATIONS, lambda: 0.5)
        share = int(min(self._left() / _LIMITS, _MOST_ITERATIONS))
        iterations = max(LEAST_ITERATIONS, share)
        return self._wide_limits(_LIMITS, iterations, lambda: self._random.uniform(0.3, 0.7))

    def _every_limit(self, iterations: int) -> Iterator[Step]:
        """Yield a search just below the longest route of each solution."""
        done: set[int] = set()
        while left := {self._limit(each) - 1 for each in self._lengths(self._maximum)} - done:
            limit = max(left)
            done.add(limit)
            yield self._limited(limit, iterations)

    def _wide_limits(
        self, most: int, iterations: int, share: Callable[[], float]
    ) -> Iterator[Step]:
        """Yield `most` searches: first at the least possible limit, then at others.

        Each further limit is at a share of an interval between two neighbours: the interval in
        which the front may gain the most hypervolume.
        """
        least = least_limit(self._translation)
        greatest = self._limit(max(self._lengths(self._maximum)))
        intervals = [(least, max(least, greatest))]
        yield self._limited(least, iterations)
        for _ in range(most - 1):
            low, high = max(intervals, key=self._area)
            intervals.remove((low, high))
            limit = low + int(share() * (high - low))
            yield self._limited(limit, iterations)
            intervals += [(low, limit), (limit, high)]

    def _area(self, interval: tuple[int, int]) -> float:
        """Return the most hypervolume that solutions within an interval can gain."""
        low, high = interval
        return (high - low) * (self._sum_within(low) - self._sum_within(high))

    def _sum_within(self, limit: int) -> float:
        """Return the least sum within a limit; a high estimate if there is no solution."""
        sums = self._lengths(1 - self._maximum)
        index = self._best_within(limit)
        if index is not None:
            return sums[index]
        most = max(sums)
        return most + max(most - min(sums), _UNKNOWN * most)

    def _limited(self, limit: int, iterations: int) -> Step:
        """Return a search under a limit, from the best solution known within it."""
        index = self._best_within(limit)
        if index is None:  # start from the solution of the least maximum
            index = 0 if self._maximum == 0 else -1
        goal = Goal(weights=self._translation.sum_weights, limit=max(0, limit))
        return Step(goal, self._archive.solutions[index], iterations)

    def _best_within(self, limit: int) -> int | None:
        return self._archive.best_within(self._maximum, (limit + 0.5) / self._limit_scale)

    def _lengths(self, objective: int) -> list[float]:
        return [guide[objective] for guide in self._archive.guides]

    def _limit(self, length: float) -> int:
        return round(length * self._limit_scale)

    def _hull_weights(self, iterations: int) -> Iterator[Step]:
        """Yield searches with the weights of both ends of the front, and of all edges of its hull.

        No weight can outweigh huge numbers of the other objective. So with huge numbers, each end
        is first searched with weight 0 for the other objective.
        """
        alone = [(1, 0), (0, 1)] if self._translation.squeezed.changed else []
        for weights in [*alone, (STEEPEST, 1), (1, STEEPEST)]:
            yield self._weighted(weights, iterations)
        done: set[tuple[Point, Point]] = set()
        while edges := [edge for edge in pairwise(_hull(self._points())) if edge not in done]:
            edge = max(edges, key=_box)
            done.add(edge)
            (x1, y1), (x2, y2) = edge
            yield self._weighted((y1 - y2, x2 - x1), iterations)

    def _weighted(self, weights: tuple[float, float], iterations: int) -> Step:
        """Return a search with these weights, from the solution that is best under them."""
        index = int((np.array(self._points()) @ np.array(weights)).argmin())
        first, second = (whole_weight(each / max(weights)) for each in weights)
        prizes = 0
        if self._weighs_prizes:
            prizes, second = second, 0
        whole = (first, second) if self._translation.distance == 0 else (second, first)
        goal = Goal(weights=whole, prizes=prizes)
        return Step(goal, self._archive.solutions[index], iterations)

    def _points(self) -> list[Point]:
        """Return the lengths of all solutions in PyVRP's units: their products fit a double."""
        first, second = self._translation.scales
        if self._weighs_prizes:
            second = self._translation.prize_scale
        return [(x * first, y * second) for x, y in self._archive.guides]


def least_limit(translation: Translation) -> int:
    """Return an estimate of the least limit on routes under which every stop can be visited.

    It is in PyVRP's units of the costs on which the search limits routes.
    """
    rules = translation.fleet.rules
    assert rules.swept is not None
    costs = translation.squeezed.legs[rules.swept]
    alone = np.full(rules.n, np.inf)
    for vehicle in rules.vehicles:
        there = 0.0 if vehicle.start is None else least_paths(costs, [vehicle.start])
        back = 0.0 if vehicle.end is None else least_paths(costs.T, [vehicle.end])
        alone = np.minimum(alone, there + back)
    if rules.clock == rules.swept:
        alone += [visit.service for visit in rules.visits]
    required = [stop for stop in rules.clients if rules.visits[stop].prize is None]
    least = float(alone[required].max(initial=0.0)) * translation.scales[rules.swept]
    return min(UNBOUNDED, round(least) + _ROUNDED)


def whole_weight(weight: float) -> int:
    """Return a weight as a whole number, where the largest is 1; 0 only if it is 0."""
    return max(1, round(STEEPEST * weight)) if weight else 0


def _box(edge: tuple[Point, Point]) -> float:
    """Return the area of the box between two neighbours on the hull."""
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
