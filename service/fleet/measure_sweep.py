"""The searches for a front of costs against a measure of plans: vehicles, overtime or lateness.

Each search minimises the costs under a limit (epsilon-constraint): on the number of vehicles of
each type, on the overtime of each route, or on how late each visit begins. The limits on routes and
visits only guide: overtime and lateness of a plan are sums.
"""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from itertools import count

import pyvrp

from service.fleet.goal import Goal
from service.fleet.solver import Step
from service.fleet.sweep import Searches

_SEARCHES = 16  # in a round, for which there should be time
_LIMITS = 7  # on overtime or lateness, in each round
_CLOSER = 0.5  # each limit is this share of the one before


class MeasureSweep(Searches):
    """The searches for a front whose second objective is one of these measures."""

    @property
    def _free(self) -> Goal:
        """The goal without a limit."""
        return Goal(weights=self._translation.sum_weights)

    def steps(self) -> Iterator[Step]:
        """Yield searches for the least costs until there is a solution, and then under limits."""
        yield from self._until_found(self._free, self._cheapest())
        for number in count():
            iterations = self._iterations(number, _SEARCHES)
            yield Step(self._free, self._cheapest(), iterations)
            if "vehicles" in self._rules.over:
                yield from self._under_numbers(number, iterations)
            else:
                yield from self._under_times(iterations)

    def _under_numbers(self, round_number: int, iterations: int) -> Iterator[Step]:
        """Yield searches with the vehicles of each solution, and with one fewer than the fewest."""
        for solution in list(self._archive.solutions):
            yield self._with_vehicles(solution, self._used(solution), iterations)
        fewest = self._archive.solutions[-1]
        used = self._used(fewest)
        types = [index for index, number in enumerate(used) if number]
        if types:
            left_out = types[round_number % len(types)]
            fewer = tuple(number - (index == left_out) for index, number in enumerate(used))
            yield self._with_vehicles(fewest, fewer, iterations)

    def _used(self, solution: pyvrp.Solution) -> tuple[int, ...]:
        """Return the number of vehicles of each type that a solution uses."""
        used = Counter(route.vehicle_type() for route in solution.routes())
        return tuple(used[index] for index in range(len(self._rules.vehicles)))

    def _with_vehicles(
        self, start: pyvrp.Solution, vehicles: tuple[int, ...], iterations: int
    ) -> Step:
        return Step(replace(self._free, vehicles=vehicles), start, iterations)

    def _under_times(self, iterations: int) -> Iterator[Step]:
        """Yield searches under limits on overtime or lateness, from none to that of the cheapest.

        Each starts from the solution of the nearest smaller measure.
        """
        greatest = self._archive.points[0][1]
        limits = [0.0, *(greatest * _CLOSER**power for power in range(1, _LIMITS))]
        for limit in limits:
            limit *= self._random.uniform(_CLOSER, 1.0)
            goal = self._limited(limit)
            measures = [point[1] for point in self._archive.points]
            within = [index for index, each in enumerate(measures) if each <= limit]
            yield Step(goal, self._archive.solutions[min(within, default=-1)], iterations)

    def _limited(self, limit: float) -> Goal:
        if "overtime" in self._rules.over:
            return replace(self._free, overtime=limit)
        return replace(self._free, lateness=limit)
