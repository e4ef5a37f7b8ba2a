"""Choose the searches for a front under three objectives, or with one that PyVRP cannot minimise.

Each search minimises a weighted sum of costs and prizes. It has limits on the lengths of routes,
vehicles, overtime and lateness if these are objectives. Weights and limits are random, so that each
region of the front is visited again and again. After each search come small moves of stops, which
are measured under all objectives exactly.
"""

from collections import Counter
from collections.abc import Iterator
from itertools import count

import numpy as np
import pyvrp

from service.fleet.fleet import Array
from service.fleet.goal import Goal
from service.fleet.moves import Moves
from service.fleet.scales import UNBOUNDED
from service.fleet.solver import Step
from service.fleet.sweep import Searches, least_limit, whole_weight

_SEARCHES = 16  # in a round; their iterations are chosen so that there is time for all
_UNLIMITED = 0.25  # share of the searches that leave out a limit; drawn for each limit
_STRICTEST = 0.25  # share of the searches that allow no overtime, or no lateness
_HALVINGS = 7  # other limits on these are the greatest value, halved up to this number of times
_ANY_START = 0.25  # share of the searches that start from a random solution
_MOVES = 2  # for each iteration of PyVRP, which takes several times as long as a move
_BEYOND = 1e3  # weight of what a start exceeds limits by, against its lengths


class MixedSweep(Searches):
    """Chooses the searches for a front under any two or three objectives."""

    def steps(self) -> Iterator[Step]:
        """Yield searches without limits until there is a solution, and then random ones forever."""
        prizes = int("unassigned" in self._rules.over)
        free = Goal(weights=self._translation.sum_weights, prizes=prizes)
        yield from self._until_found(free, self._cheapest())
        for number in count():
            iterations = self._iterations(number, _SEARCHES)
            for _ in range(_SEARCHES):
                weights = self._random.exponential(size=len(self._rules.over)) / self._widths()
                yield self._search(weights, iterations)

    def _widths(self) -> Array:
        """Return the width of the front in each objective, shape (m,).

        Where it is 0, return the unit of the fleet instead.
        """
        widths = np.ptp(np.array(self._archive.points), axis=0)
        return np.where(widths > 0, widths, self._translation.fleet.scale)

    def _search(self, weights: Array, iterations: int) -> Step:
        """Return a search with these weights of the objectives, shape (m,), and random limits."""
        distance, duration, prizes = self._whole_weights(weights)
        goal = Goal(
            weights=(distance, duration),
            prizes=prizes,
            limit=self._limit(),
            vehicles=self._vehicles(),
            overtime=self._time_limit("overtime"),
            lateness=self._time_limit("lateness"),
        )
        moves = Moves(weights, _MOVES * iterations)
        return Step(goal, self._start(goal, weights), iterations, moves)

    def _whole_weights(self, weights: Array) -> tuple[int, int, int]:
        """Return the weights of distance, duration and prizes in PyVRP's units.

        If only one of these is minimised, its weight is 1: costs are scaled so that they have no
        room for a greater one.
        """
        rules, translation = self._rules, self._translation
        if not rules.weighs:
            return *translation.sum_weights, 0
        pairs = list(zip(rules.over, rules.layers, strict=True))
        found = np.zeros(3)
        for (over, layer), weight in zip(pairs, weights, strict=True):
            if over == "sum":
                found[int(layer != translation.distance)] = weight / translation.scales[layer]
            elif over == "unassigned":
                found[2] = weight / translation.prize_scale
        distance, duration, prizes = (whole_weight(each / found.max()) for each in found)
        return distance, duration, prizes

    def _any_solution(self) -> pyvrp.Solution:
        return self._archive.solutions[int(self._random.integers(len(self._archive)))]

    def _limit(self) -> int:
        """Return a random limit on the length of each route, in PyVRP's units.

        It is between the least that leaves a plan possible and the longest route of a solution.
        """
        if self._rules.swept is None or self._random.random() < _UNLIMITED:
            return UNBOUNDED
        timed = self._rules.swept == self._translation.duration
        length = pyvrp.Route.duration if timed else pyvrp.Route.distance
        longest = max(map(length, self._any_solution().routes()), default=0)
        least = min(least_limit(self._translation), longest)
        return least + int(self._random.random() * (longest - least))

    def _vehicles(self) -> tuple[int, ...] | None:
        """Return the most vehicles of each type: those that a solution uses, or one fewer.

        None without such a limit.
        """
        if "vehicles" not in self._rules.over or self._random.random() < _UNLIMITED:
            return None
        used = Counter(route.vehicle_type() for route in self._any_solution().routes())
        if len(used) and self._random.random() < 1 / 2:
            used[self._random.choice(sorted(used))] -= 1
        return tuple(used[index] for index in range(len(self._rules.vehicles)))

    def _time_limit(self, measure: str) -> float:
        """Return a random limit on the overtime of each route, or on the lateness of each visit.

        Args:
            measure: "overtime" or "lateness". If it is not an objective, the limit is infinite.
        """
        if measure not in self._rules.over:
            return np.inf
        kind = self._random.random()
        if kind < _UNLIMITED:
            return np.inf
        if kind < _UNLIMITED + _STRICTEST:
            return 0.0
        objective = self._rules.over.index(measure)
        greatest = max(point[objective] for point in self._archive.points)
        return float(greatest * 0.5 ** self._random.uniform(0, _HALVINGS))

    def _start(self, goal: Goal, weights: Array) -> pyvrp.Solution:
        """Return the best solution under these weights and limits, or sometimes a random one."""
        if self._random.random() < _ANY_START:
            return self._any_solution()
        points, limits = np.array(self._archive.points), self._limits(goal)
        with np.errstate(over="ignore", invalid="ignore"):
            beyond = np.nan_to_num((points - limits).clip(min=0.0))
            values = (points + _BEYOND * beyond) @ weights
        return self._archive.solutions[int(values.argmin())]

    def _limits(self, goal: Goal) -> Array:
        """Return the limits of a goal in the units of each objective, shape (m,)."""
        limits = np.full(len(self._rules.over), np.inf)
        for index, (over, layer) in enumerate(
            zip(self._rules.over, self._rules.layers, strict=True)
        ):
            if over == "max" and goal.limit < UNBOUNDED:
                limits[index] = goal.limit / self._translation.scales[layer]
            elif over == "vehicles" and goal.vehicles is not None:
                limits[index] = sum(goal.vehicles)
            elif over in ("overtime", "lateness"):
                limits[index] = getattr(goal, over)
        return limits
