"""The archive of a fleet's search: all nondominated solutions that PyVRP has visited."""

from bisect import bisect_left, bisect_right
from math import inf
from operator import itemgetter

import pyvrp

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.goal import Goal
from service.fleet.plans import Plan
from service.fleet.translation import Translation

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
        # Their limits in a search are no rules.
        self._any_time |= rules.measure in ("overtime", "lateness")
        visits = len(rules.clients) + 1
        self._slack = [_ROUNDED * visits / scale for scale in translation.scales]
        if rules.measure is not None:
            self._slack[1] = 0.0
        self.points: list[Point] = []
        self.guides: list[Point] = []
        self._compared: set[Point] = set()  # guides of solutions whose true lengths are known
        self.solutions: list[pyvrp.Solution] = []
        self.version = 0
        timed = rules.measure in ("overtime", "lateness")
        self._guides_decide = not timed and not translation.squeezed.changed

    def __len__(self) -> int:
        return len(self.solutions)

    def best_within(self, objective: int, length: float) -> int | None:
        """Return the index of the best solution in the other objective, within a length in one.

        Lengths are those of PyVRP. None if no solution is within it.
        """
        within = [index for index, guide in enumerate(self.guides) if guide[objective] <= length]
        return min(within, key=lambda index: self.guides[index][1 - objective], default=None)

    def offer(self, solution: pyvrp.Solution, goal: Goal) -> None:
        """Add a solution, unless it breaks a rule or another one is at least as good.

        The weights of the goal, under which it was found, multiply its prizes.
        """
        if not self._keeps_rules(solution):
            return
        translation, weight = self._translation, goal.weights[self._translation.distance]
        if goal.vehicles is not None:
            weight = 0  # vehicles that must not leave have a huge cost
        guide = self._guide(solution, weight, goal)
        # PyVRP's lengths are at most the true lengths, up to rounding.
        if self._is_dominated((guide[0] - self._slack[0], guide[1] - self._slack[1])):
            return
        if guide in self._compared and self._guides_decide:
            return
        self._compared.add(guide)
        plan = translation.plan(solution)
        point = plan_lengths(translation.fleet, plan)
        guide = self._completed(guide, plan, point, bool(weight))
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

    def _completed(self, guide: Point, plan: Plan, point: Point, weighed: bool) -> Point:
        """Return the lengths that `_guide` returned, with what had no weight in them."""
        first, second = guide
        translation, measure = self._translation, self._translation.fleet.rules.measure
        if not weighed:  # then prizes have no weight either
            first += translation.extras(plan)
        if measure == "unassigned":
            second = translation.lost(plan)
        elif measure is not None:
            second = point[1]
        return first, second

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

    def _guide(self, solution: pyvrp.Solution, weight: int, goal: Goal) -> Point:
        """Return both lengths of a solution as PyVRP has them, or less.

        `weight` multiplies what is added to the first. Extras that have no weight count as 0, and
        so do overtime and lateness.
        """
        lost = self._translation.uncollected(solution, goal)
        measure = self._translation.fleet.rules.measure
        first = self._length(solution, 0)
        extras, scale = solution.fixed_vehicle_cost(), self._translation.scales[0]
        match measure:
            case None:
                second = self._length(solution, 1)
            case "vehicles":
                second = float(solution.num_routes())
            case "unassigned":
                weighed = goal.prizes * self._translation.prize_scale
                second = lost / weighed if weighed else 0.0
            case _:
                second = 0.0
        if measure != "unassigned":
            extras += lost
        return first + extras / (weight * scale) if extras and weight else first, second

    def _length(self, solution: pyvrp.Solution, objective: int) -> float:
        is_duration = objective == self._translation.duration
        scale = self._translation.scales[objective]
        if objective != self._translation.fleet.rules.maximum:
            return (solution.duration() if is_duration else solution.distance()) / scale
        length = pyvrp.Route.duration if is_duration else pyvrp.Route.distance
        return max(map(length, solution.routes()), default=0) / scale
