"""The archive of a fleet's search: all nondominated solutions that PyVRP has visited."""

from bisect import bisect_left
from operator import itemgetter

import numpy as np
import pyvrp
from numpy.typing import NDArray

from service.fleet.evaluation import plan_lengths, violations
from service.fleet.fleet import Array
from service.fleet.fleet_search import KEPT
from service.fleet.goal import Goal
from service.fleet.plans import Plan, kept_share
from service.fleet.rules import Measure, Over
from service.fleet.translation import Translation
from service.objectives import OBJECTIVES

Point = tuple[float, ...]
_FIRST = itemgetter(0)
_ROUNDING = 1e-14  # relative error of a sum of doubles: equal plans differ by as much
_ROUNDED = 4  # units by which each visit is rounded: two legs, a service and a window
_CROWDED = 2000  # solutions under three objectives, after which a new one must be apart from them
_APART = 0.01  # in some objective by this share of the front


class SolutionArchive:
    """Nondominated solutions that keep every rule, by ascending first length.

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
        swept = rules.swept is not None and not rules.has_longest
        self._any_distance = swept and translation.duration in (None, 1 - (rules.swept or 0))
        self._any_time = swept and not self._any_distance and not rules.spans
        # A search limits overtime and lateness, but plans may exceed these limits.
        self._any_time |= rules.limits_times
        self._objectives = list(zip(rules.over, rules.layers, strict=True))
        slack = [_ROUNDED * (len(rules.clients) + 1) / scale for scale in translation.scales]
        self._slack = np.array([slack[i] if _of_costs(o) else 0.0 for o, i in self._objectives])
        self._array: Array = np.empty((0, len(rules.over)))  # the points
        self.points: list[Point] = []
        self.guides: list[Point] = []
        self._compared: set[Point] = set()  # guides of solutions whose true lengths are known
        self.solutions: list[pyvrp.Solution] = []
        self.version = 0
        unseen = {"overtime", "lateness", "imbalance", "load_distance"}  # by PyVRP
        self._guides_decide = unseen.isdisjoint(rules.over) and not translation.squeezed.changed

    def __len__(self) -> int:
        return len(self.solutions)

    def best_within(self, objective: int, length: float) -> int | None:
        """Return the index of the best solution in the other of two objectives, within a length.

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
        if self.dominates(guide - self._slack):
            return
        if guide in self._compared and self._guides_decide:
            return
        self._compared.add(guide)
        plan = translation.plan(solution)
        point = plan_lengths(translation.fleet, plan)
        guide = self._completed(guide, plan, point, bool(weight))
        if self.dominates(point):
            return
        if translation.is_rounded and violations(translation.fleet, plan):
            return
        self._drop(np.all(self._array * (1 + _ROUNDING) >= point, axis=1))
        place = bisect_left(self.points, point[0], key=_FIRST)
        self._array = np.insert(self._array, place, point, axis=0)
        self.points.insert(place, point)
        self.guides.insert(place, guide)
        self.solutions.insert(place, solution)
        self.version += 1

    def dominates(self, point: Point | Array) -> bool:
        """Return whether a solution is at least as good as a point in all lengths.

        If there are many solutions under three objectives, those that are nearly so are enough.
        """
        most: Array = np.multiply(point, 1 + _ROUNDING)
        if len(self) > _CROWDED and len(most) > OBJECTIVES:
            most = most + _APART * np.ptp(self._array, axis=0)
        return bool((self._array <= most).all(axis=1).any())

    def _drop(self, dominated: NDArray[np.bool_]) -> None:
        """Drop some solutions."""
        for place in np.flatnonzero(dominated)[::-1].tolist():
            del self.points[place], self.guides[place], self.solutions[place]
        self._array = self._array[~dominated]

    def _completed(self, guide: Point, plan: Plan, point: Point, weighed: bool) -> Point:
        """Return the lengths that `_guide` returned, with what had no weight in them."""
        lengths, translation = list(guide), self._translation
        if not weighed:  # then prizes have no weight either
            lengths[0] += translation.extras(plan)
        for index, (over, _) in enumerate(self._objectives):
            if over == "unassigned":
                lengths[index] = translation.lost(plan)
            elif not _of_costs(over):
                lengths[index] = point[index]
        return tuple(lengths)

    def _keeps_rules(self, solution: pyvrp.Solution) -> bool:
        return (
            solution.is_complete()
            and not solution.has_excess_load()
            and (self._any_distance or not solution.has_excess_distance())
            and (self._any_time or not solution.has_time_warp())
        )

    def _guide(self, solution: pyvrp.Solution, weight: int, goal: Goal) -> Point:
        """Return the lengths of a solution as PyVRP has them, or less.

        `weight` multiplies what is added to the first. Extras that have no weight count as 0, and
        so does what PyVRP does not know.
        """
        lost = self._translation.uncollected(solution, goal)
        extras, scale = solution.fixed_vehicle_cost(), self._translation.scales[0]
        prizes = goal.prizes * self._translation.prize_scale
        lengths = []
        for over, layer in self._objectives:
            if _of_costs(over):
                lengths.append(self._length(solution, over, layer))
            elif over == "vehicles":
                lengths.append(float(solution.num_routes()))
            else:
                lengths.append(lost / prizes if over == "unassigned" and prizes else 0.0)
        if "unassigned" not in self._translation.fleet.rules.over:
            extras += lost
        if extras and weight:
            lengths[0] += extras / (weight * scale)
        return tuple(lengths)

    def _length(self, solution: pyvrp.Solution, over: Over | Measure, layer: int) -> float:
        is_duration = layer == self._translation.duration
        scale = self._translation.scales[layer]
        if over == "sum":
            return (solution.duration() if is_duration else solution.distance()) / scale
        length = pyvrp.Route.duration if is_duration else pyvrp.Route.distance
        return max(map(length, solution.routes()), default=0) / scale


class KeptPlans:
    """Plans that keep most of a plan that is driven, also if shorter ones keep less.

    Args:
        translation: The translation of the fleet.
        driven: The plan.
    """

    def __init__(self, translation: Translation, driven: Plan) -> None:
        self._translation = translation
        self._driven = driven
        self.points: Array = np.empty((0, len(translation.fleet.rules.over)))
        self.plans: list[Plan] = []

    def offer(self, solution: pyvrp.Solution) -> None:
        """Add the plan of a solution if it keeps most, breaks no rule, and is not dominated."""
        if not solution.is_complete() or solution.has_excess_load():
            return
        plan = self._translation.plan(solution)
        if kept_share(self._driven, plan) < KEPT:
            return
        fleet = self._translation.fleet
        point = np.array(plan_lengths(fleet, plan))
        if (self.points <= point).all(axis=1).any() or violations(fleet, plan):
            return
        left = ~np.all(self.points >= point, axis=1)
        self.points = np.vstack((self.points[left], point))
        kept = (each for each, is_left in zip(self.plans, left, strict=True) if is_left)
        self.plans = [*kept, plan]


def _of_costs(over: Over | Measure) -> bool:
    return over in ("sum", "max")
