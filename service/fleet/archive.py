"""The archive of a fleet's search: the nondominated solutions of PyVRP among all that it visits."""

from bisect import bisect_left, bisect_right
from math import inf
from operator import neg

import pyvrp

from service.fleet.evaluation import violations
from service.fleet.translation import Translation

Point = tuple[float, float]


class SolutionArchive:
    """Solutions that keep every rule, by ascending first length, and strictly descending second.

    A solution may be longer than the limit under which it was found: that is no rule.
    """

    def __init__(self, translation: Translation) -> None:
        rules = translation.fleet.rules
        self._translation = translation
        self._roles = translation.roles
        unlimited = all(vehicle.longest == inf for vehicle in rules.vehicles)
        limited = translation.roles.limited
        by_distance = limited == translation.roles.distance
        self._any_distance = limited is not None and by_distance and unlimited
        by_duration = limited is not None and not by_distance
        self._any_time = by_duration and unlimited and not rules.has_spans
        self._firsts: list[float] = []
        self._seconds: list[float] = []
        self.solutions: list[pyvrp.Solution] = []
        self.version = 0  # the number of solutions that were added

    def __len__(self) -> int:
        return len(self.solutions)

    @property
    def points(self) -> list[Point]:
        """The lengths of the solutions, as PyVRP rounds them."""
        return list(zip(self._firsts, self._seconds, strict=True))

    def length(self, index: int, objective: int) -> float:
        """Return a length of a solution, as PyVRP rounds it."""
        return (self._firsts, self._seconds)[objective][index]

    def least(self, objective: int) -> float:
        """Return the least length in an objective."""
        return self._firsts[0] if objective == 0 else self._seconds[-1]

    def most(self, objective: int) -> float:
        """Return the greatest length in an objective."""
        return self._firsts[-1] if objective == 0 else self._seconds[0]

    def best_within(self, objective: int, length: float) -> int | None:
        """Return the solution that is best in the other objective, of those not longer in one."""
        if objective == 0:
            return bisect_right(self._firsts, length) - 1 if length >= self._firsts[0] else None
        index = bisect_left(self._seconds, -length, key=neg)
        return index if index < len(self) else None

    def offer(self, solution: pyvrp.Solution, weights: tuple[int, int]) -> None:
        """Add a solution unless it breaks a rule, or another is as good.

        Args:
            solution: The solution.
            weights: Of the goal under which it was found, by which its prizes are multiplied.
        """
        if not self._keeps_rules(solution):
            return
        first, second = self._point(solution, weights)
        place = bisect_right(self._firsts, first)
        if place and self._seconds[place - 1] <= second:
            return
        if self._translation.is_rounded and violations(
            self._translation.fleet, self._translation.plan(solution)
        ):
            return
        begin = bisect_left(self._firsts, first)
        end = begin
        while end < len(self) and self._seconds[end] >= second:
            end += 1
        self._firsts[begin:end] = [first]
        self._seconds[begin:end] = [second]
        self.solutions[begin:end] = [solution]
        self.version += 1

    def _keeps_rules(self, solution: pyvrp.Solution) -> bool:
        return (
            solution.is_complete()
            and not solution.has_excess_load()
            and (self._any_distance or not solution.has_excess_distance())
            and (self._any_time or not solution.has_time_warp())
        )

    def _point(self, solution: pyvrp.Solution, weights: tuple[int, int]) -> Point:
        """Return both lengths of a solution."""
        first, second = (self._length(solution, objective) for objective in (0, 1))
        weight = weights[0 if self._roles.distance == 0 else 1]
        scale = self._translation.scale(0)
        extras = solution.fixed_vehicle_cost() + solution.uncollected_prizes()
        return first + extras / (weight * scale) if extras else first, second

    def _length(self, solution: pyvrp.Solution, objective: int) -> float:
        is_duration = self._roles.duration == objective
        scale = self._translation.scale(objective)
        if self._roles.limited != objective:
            return (solution.duration() if is_duration else solution.distance()) / scale
        length = pyvrp.Route.duration if is_duration else pyvrp.Route.distance
        return max(map(length, solution.routes()), default=0) / scale
