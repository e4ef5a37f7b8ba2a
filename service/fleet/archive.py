"""The archive of a fleet's search: all nondominated solutions that PyVRP has visited."""

from bisect import bisect_left, bisect_right
from math import inf
from operator import itemgetter

import pyvrp

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.translation import Translation, Weights
from service.objectives import OBJECTIVES

Point = tuple[float, float]
_FIRST = itemgetter(0)
_ROUNDING = 1e-14  # relative error of a sum of doubles: equal plans differ by as much
_ROUNDED = 4  # units by which each visit is rounded: two legs, a service and a window


class SolutionArchive:
    """Solutions that keep every rule, by ascending first and strictly descending second length.

    A solution may be longer than the limit under which it was found: the limit is not a rule.

    Attributes:
        points: The lengths of the solutions.
        guides: PyVRP's lengths of the solutions: rounded up, and squeezed.
        solutions: The solutions.
        version: The number of solutions added so far.
    """

    def __init__(self, translation: Translation) -> None:
        rules = translation.fleet.rules
        self._translation = translation
        swept = rules.maximum is not None and all(each.longest == inf for each in rules.vehicles)
        self._any_distance = swept and rules.maximum == translation.distance
        self._any_time = swept and rules.maximum != translation.distance and not rules.spans
        visits = len(rules.clients) + 1
        self._slack = [_ROUNDED * visits / scale for scale in translation.scales]
        self.points: list[Point] = []
        self.guides: list[Point] = []
        self._compared: set[Point] = set()  # guides of solutions whose true lengths are known
        self.solutions: list[pyvrp.Solution] = []
        self.version = 0

    def __len__(self) -> int:
        return len(self.solutions)

    def best_within(self, objective: int, length: float) -> int | None:
        """Return the index of the best solution in the other objective, within a length in one.

        Lengths are those of PyVRP. None if no solution is within it.
        """
        within = [index for index, guide in enumerate(self.guides) if guide[objective] <= length]
        return min(within, key=lambda index: self.guides[index][1 - objective], default=None)

    def offer(self, solution: pyvrp.Solution, weights: Weights) -> None:
        """Add a solution, unless it breaks a rule or another one is at least as good.

        `weights` are those of the goal under which it was found. They multiply its prizes.
        """
        if not self._keeps_rules(solution):
            return
        translation, weight = self._translation, weights[self._translation.distance]
        guide = self._guide(solution, weight)
        # PyVRP's lengths are at most the true lengths, up to rounding.
        if self._is_dominated((guide[0] - self._slack[0], guide[1] - self._slack[1])):
            return
        if guide in self._compared and not translation.squeezed.changed:
            return
        self._compared.add(guide)
        plan = translation.plan(solution)
        if not weight:  # then prizes have no weight either
            guide = guide[0] + translation.extras(plan), guide[1]
        point = plan_lengths(translation.fleet, plan)
        if self._is_dominated(point):
            return
        if translation.is_rounded and violations(translation.fleet, plan):
            return
        begin = end = bisect_left(self.points, point[0], key=_FIRST)
        while end < len(self) and self.points[end][1] * (1 + _ROUNDING) >= point[1]:
            end += 1
        self.points[begin:end] = [point]
        self.guides[begin:end] = [guide]
        self.solutions[begin:end] = [solution]
        self.version += 1

    def _is_dominated(self, point: Point) -> bool:
        """Return whether a solution is at least as good as a point in both lengths."""
        place = bisect_right(self.points, point[0] * (1 + _ROUNDING), key=_FIRST)
        return place > 0 and self.points[place - 1][1] <= point[1] * (1 + _ROUNDING)

    def _keeps_rules(self, solution: pyvrp.Solution) -> bool:
        return (
            solution.is_complete()
            and not solution.has_excess_load()
            and (self._any_distance or not solution.has_excess_distance())
            and (self._any_time or not solution.has_time_warp())
        )

    def _guide(self, solution: pyvrp.Solution, weight: int) -> Point:
        """Return both lengths of a solution as PyVRP has them; `weight` multiplies its prizes."""
        first, second = (self._length(solution, objective) for objective in range(OBJECTIVES))
        extras = solution.fixed_vehicle_cost() + solution.uncollected_prizes()
        scale = self._translation.scales[0]
        return first + extras / (weight * scale) if extras else first, second

    def _length(self, solution: pyvrp.Solution, objective: int) -> float:
        is_duration = objective == self._translation.duration
        scale = self._translation.scales[objective]
        if objective != self._translation.fleet.rules.maximum:
            return (solution.duration() if is_duration else solution.distance()) / scale
        length = pyvrp.Route.duration if is_duration else pyvrp.Route.distance
        return max(map(length, solution.routes()), default=0) / scale
