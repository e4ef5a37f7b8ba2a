"""The steps towards a sum against a maximum: limits on the longest route (epsilon-constraint)."""

from collections.abc import Callable, Iterator

import numpy as np

from service.fleet.archive import SolutionArchive
from service.fleet.least_paths import least_paths
from service.fleet.scales import UNBOUNDED
from service.fleet.solver import Step
from service.fleet.translation import Goal, Translation

_ROUNDED = 3  # units by which a route to one stop is rounded up: two legs and a service
_UNKNOWN = 0.1  # share of the greatest sum that an unknown sum exceeds it by, at least


class LimitSteps:
    """Searches under limits. Each starts from the best solution known within its limit.

    Args:
        translation: The translation of a fleet with an objective that is a maximum.
        archive: The solutions of all searches; it must not be empty.
        iterations: The iterations of each search.
    """

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
            limits = {self._limit(guide[self._maximum]) - 1 for guide in self._archive.guides}
            left = limits - done
            if not left:
                return
            limit = max(left)
            done.add(limit)
            yield self._step(limit)

    def wide_limits(self, most: int, share: Callable[[], float]) -> Iterator[Step]:
        """Yield `most` searches: first at the least possible limit, then at others.

        Each further limit is at a share of an interval between two neighbours: the interval in
        which the front may gain the most hypervolume.
        """
        least, greatest = self._least_limit(), self._limit(max(self._lengths(self._maximum)))
        intervals = [(least, max(least, greatest))]
        yield self._step(least)
        for _ in range(most - 1):
            low, high = max(intervals, key=self._area)
            intervals.remove((low, high))
            limit = low + int(share() * (high - low))
            yield self._step(limit)
            intervals += [(low, limit), (limit, high)]

    def _area(self, interval: tuple[int, int]) -> float:
        """Return the most hypervolume that solutions within an interval can gain."""
        low, high = interval
        return (high - low) * (self._sum_within(low) - self._sum_within(high))

    def _sum_within(self, limit: int) -> float:
        """Return the least sum within a limit; a high estimate if there is no solution."""
        archive, summed = self._archive, 1 - self._maximum
        index = archive.best_within(self._maximum, self._length(limit))
        if index is not None:
            return archive.guides[index][summed]
        sums = self._lengths(summed)
        most = max(sums)
        return most + max(most - min(sums), _UNKNOWN * most)

    def _lengths(self, objective: int) -> list[float]:
        return [guide[objective] for guide in self._archive.guides]

    def _step(self, limit: int) -> Step:
        goal = Goal(weights=self._translation.sum_weights, limit=max(0, limit))
        archive = self._archive
        index = archive.best_within(self._maximum, self._length(limit))
        if index is None:  # start from the solution of the least maximum
            index = 0 if self._maximum == 0 else len(archive) - 1
        return Step(goal, archive.solutions[index], self._iterations)

    def _limit(self, length: float) -> int:
        return round(length * self._translation.limit_scale)

    def _length(self, limit: int) -> float:
        """Return the bound on lengths that are within a limit after rounding."""
        return (limit + 0.5) / self._translation.limit_scale

    def _least_limit(self) -> int:
        """Return an estimate of the least limit under which every stop can be visited."""
        fleet = self._translation.fleet
        rules, costs = fleet.rules, self._translation.squeezed.legs[self._maximum]
        alone = np.full(rules.n, np.inf)
        for vehicle in rules.vehicles:
            there = 0.0 if vehicle.start is None else least_paths(costs, [vehicle.start])
            back = 0.0 if vehicle.end is None else least_paths(costs.T, [vehicle.end])
            alone = np.minimum(alone, there + back)
        if rules.clock == self._maximum:
            alone += [visit.service for visit in rules.visits]
        required = [s for s in rules.clients if rules.visits[s].prize is None]
        return min(UNBOUNDED, self._limit(float(alone[required].max(initial=0.0))) + _ROUNDED)
