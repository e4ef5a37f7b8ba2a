"""Search for the front of a fleet by PyVRP, where the search by ruin and recreate cannot."""

from dataclasses import replace
from math import inf

import numpy as np
import pyvrp

from service.fleet.archive import KeptPlans, SolutionArchive
from service.fleet.evaluation import violations
from service.fleet.first_plans import plain_plans
from service.fleet.fleet import Array, Fleet
from service.fleet.fleet_search import FleetSearch
from service.fleet.fronts import FleetOptions
from service.fleet.goal import FREE, Goal
from service.fleet.measure_sweep import MeasureSweep
from service.fleet.mixed_sweep import MixedSweep
from service.fleet.moves import Mover
from service.fleet.plans import FleetFront, Plan
from service.fleet.rules import Rules
from service.fleet.scales import Units
from service.fleet.solver import Solver
from service.fleet.sweep import Searches, SumSweep
from service.fleet.translation import Translation
from service.front import Termination
from service.watch import Watch

_FIRST = 1.5e-7  # seconds per pair of stops until PyVRP has its first solution


class PyvrpSearch(FleetSearch):
    """A sweep of searches by PyVRP, all into one archive.

    Costs are rounded up to whole numbers, so a plan that just keeps every rule may seem to break
    one. If nothing is found in half of the time, a second search has bounds that are `loose` by the
    rounding, and each of its solutions is checked.
    """

    def __init__(
        self,
        fleet: Fleet,
        options: FleetOptions,
        watch: Watch[FleetFront],
        loose: bool = False,
    ) -> None:
        units = Units.of(fleet)
        super().__init__(fleet, options, watch, units)
        self._translation = Translation(units.fleet, loose)
        give_up = not loose and fleet.rules.has_bounds
        self._most_without = watch.seconds / 2 if give_up else inf
        self._archive = SolutionArchive(self._translation)
        driven = options.driven
        self._kept_plans = None if driven is None else KeptPlans(self._translation, driven)
        self._iterations = 0
        self._optional = any(visit.prize is not None for visit in fleet.rules.visits)

    @property
    def points(self) -> Array:
        """The lengths of all nondominated plans so far, shape (k, m)."""
        return np.array(self._archive.points).reshape(-1, len(self._reference_point))

    def __len__(self) -> int:
        """Return the number of nondominated plans so far."""
        return len(self._archive)

    def plan_at(self, index: int) -> Plan:
        """Return the plan of a point."""
        return self._translation.plan(self._archive.solutions[index])

    def _fewest_left_out(self) -> int:
        if not self._optional:
            return 0
        return min((each.num_missing_clients() for each in self._archive.solutions), default=0)

    def _kept(self) -> tuple[Array, list[Plan]]:
        assert self._kept_plans is not None
        return self._kept_plans.points, self._kept_plans.plans

    @property
    def _is_short(self) -> bool:
        """Whether the time is over before PyVRP has its first solution."""
        return self._watch.left < _FIRST * self._fleet.rules.n**2

    def _begin_plainly(self) -> None:
        """Put a simple plan into an empty archive, if one breaks no rule and time is short."""
        if len(self) or not self._is_short:
            return
        for plan in plain_plans(self._fleet, self._watch.stopped):
            if not violations(self._fleet, plan):
                self.begin_with(plan)
                return

    def begin_with(self, plan: Plan) -> None:
        """Put a plan that keeps every rule into the archive."""
        self._offer(self._translation.solution(plan), FREE)

    def _offer(self, solution: pyvrp.Solution, goal: Goal) -> None:
        self._archive.offer(solution, goal)
        if self._kept_plans is not None:
            self._kept_plans.offer(solution)

    def run(self) -> Termination:
        """Search until nothing is left to do, the time is over, or the watch says to stop."""
        self._begin_plainly()
        options, archive = self._options, self._archive
        solver = Solver(self._translation, options.seed, self._offer, self._ended, self._watch)
        random = np.random.default_rng(options.seed)
        mover: Mover | None = None
        sweep = _sweep_of(self._fleet.rules)
        if archive and self._is_short:
            return "time_limit"
        for step in sweep(self._translation, archive, random, self._left).steps():
            if self._iterations >= options.iterations or self._ended():
                return "cancelled" if self._cancelled else "time_limit"
            iterations = min(step.iterations, options.iterations - self._iterations)
            self._iterations += solver.search(replace(step, iterations=iterations))
            if step.moves is not None:
                mover = mover or Mover(self._translation, archive, random)
                mover.improve(step.moves, self._ended)
        return "converged"

    def _left(self) -> float:
        """Return the number of iterations left, estimated from the time of earlier ones."""
        most = self._options.iterations - self._iterations
        if self._watch.seconds == inf or not self._iterations:
            return most
        return min(most, self._watch.left * self._iterations / self._watch.spent)

    def _gives_up(self, now: float) -> bool:
        return now > self._most_without and not len(self)


def _sweep_of(rules: Rules) -> type[Searches]:
    """Return the searches for the objectives of a fleet."""
    second, *more = rules.over[1:]
    if more or second in ("imbalance", "load_distance"):
        return MixedSweep
    return SumSweep if second in ("sum", "max", "unassigned") else MeasureSweep
