"""The archive of a fleet's search: all nondominated solutions that PyVRP has visited."""

from bisect import bisect_left, bisect_right
from math import inf

import pyvrp

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.translation import Translation

Point = tuple[float, float]
_ROUNDING = 1e-14  # relative error of a sum of doubles: equal plans differ by as much
_ROUNDED = 4  # units by which each visit is rounded: two legs, a service and a window


class SolutionArchive:
    """Solutions that keep every rule, by ascending first and strictly descending second length.

    A solution may be longer than the limit under which it was found: the limit is not a rule.
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
        visits = len(rules.clients) + 1
        self._slack = [_ROUNDED * visits / translation.scale(objective) for objective in (0, 1)]
        self._firsts: list[float] = []
        self._seconds: list[float] = []
        self.guides: list[Point] = []  # PyVRP's lengths: rounded up, and squeezed
        self._compared: set[Point] = set()  # guides of solutions whose true lengths are known
        self.solutions: list[pyvrp.Solution] = []
        self.version = 0  # the number of solutions added so far

    def __len__(self) -> int:
        return len(self.solutions)

    @property
    def points(self) -> list[Point]:
        """The lengths of the solutions."""
        return list(zip(self._firsts, self._seconds, strict=True))

    def best_within(self, objective: int, length: float) -> int | None:
        """Return the index of the best solution in the other objective, within a length in one.

        Lengths are those of PyVRP. None if no solution is within it.
        """
        within = [index for index, guide in enumerate(self.guides) if guide[objective] <= length]
        return min(within, key=lambda index: self.guides[index][1 - objective], default=None)

    def offer(self, solution: pyvrp.Solution, weights: tuple[int, int]) -> None:
        """Add a solution, unless it breaks a rule or another one is at least as good.

        Args:
            solution: The solution.
            weights: The weights of the goal under which it was found. They multiply its prizes.
        """
        if not self._keeps_rules(solution):
            return
        guide = self._point(solution, weights)
        # PyVRP's lengths are at most the true lengths, up to rounding.
        if self._is_dominated((guide[0] - self._slack[0], guide[1] - self._slack[1])):
            return
        if guide in self._compared and not self._translation.squeezed.changed:
            return
        self._compared.add(guide)
        fleet, plan = self._translation.fleet, self._translation.plan(solution)
        if not weights[0 if self._roles.distance == 0 else 1]:  # then prizes have no weight either
            guide = guide[0] + self._translation.extras(plan), guide[1]
        first, second = plan_lengths(fleet, plan)
        if self._is_dominated((first, second)):
            return
        if self._translation.is_rounded and violations(fleet, plan):
            return
        begin = bisect_left(self._firsts, first)
        end = begin
        while end < len(self) and self._seconds[end] * (1 + _ROUNDING) >= second:
            end += 1
        self._firsts[begin:end] = [first]
        self._seconds[begin:end] = [second]
        self.guides[begin:end] = [guide]
        self.solutions[begin:end] = [solution]
        self.version += 1

    def _is_dominated(self, point: Point) -> bool:
        """Return whether a solution is at least as good as a point in both lengths."""
        place = bisect_right(self._firsts, point[0] * (1 + _ROUNDING))
        return place > 0 and self._seconds[place - 1] <= point[1] * (1 + _ROUNDING)

    def _keeps_rules(self, solution: pyvrp.Solution) -> bool:
        return (
            solution.is_complete()
            and not solution.has_excess_load()
            and (self._any_distance or not solution.has_excess_distance())
            and (self._any_time or not solution.has_time_warp())
        )

    def _point(self, solution: pyvrp.Solution, weights: tuple[int, int]) -> Point:
        """Return both lengths of a solution as PyVRP has them."""
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
