"""Run PyVRP's iterated local search towards one goal, and report every solution it visits."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pyvrp
import pyvrp.search
from pyvrp.exceptions import PenaltyBoundWarning
from pyvrp.IteratedLocalSearch import (
    IteratedLocalSearch,
    IteratedLocalSearchCallbacks,
    IteratedLocalSearchParams,
)
from pyvrp.PenaltyManager import PenaltyManager, PenaltyParams

from service.fleet.goal import Goal, Weights
from service.fleet.moves import Moves
from service.fleet.scales import Penalties
from service.fleet.translation import Translation
from service.watch import Watch

_FEW = 100  # stops: a search of their whole neighbourhood takes at most about 50 ms
_EXHAUSTIVE = 5e-6  # seconds per pair of stops, more than a 2.5 GHz Xeon needs
Neighbours = dict[pyvrp.Activity, list[pyvrp.Activity]]
Offer = Callable[[pyvrp.Solution, Goal], None]


@dataclass(frozen=True)
class Step:
    """A search to run.

    Args:
        goal: The goal of the search.
        start: The solution to start from, found under any goal; None starts from a random one.
        iterations: The most iterations.
        moves: Moves to try afterwards, which PyVRP cannot measure.
    """

    goal: Goal
    start: pyvrp.Solution | None
    iterations: int
    moves: Moves | None = None


class Solver:
    """Runs searches towards goals, one after another.

    Args:
        translation: The translation of the fleet.
        seed: The seed of all random choices.
        offer: Called with each solution that a search visits, feasible or not, and its goal.
        stop: Called after each iteration; True ends the search.
        watch: Says how much time is left: nothing is started that takes longer.
    """

    def __init__(
        self,
        translation: Translation,
        seed: int,
        offer: Offer,
        stop: Callable[[], bool],
        watch: Watch[Any],
    ) -> None:
        self._translation = translation
        self._random = pyvrp.RandomNumberGenerator(seed=seed)
        self._offer = offer
        self._stop = stop
        self._watch = watch
        self._neighbours: tuple[Weights, Neighbours] | None = None

    def search(self, step: Step) -> int:
        """Run a search, and return the number of its iterations."""
        goal = step.goal
        data = self._translation.data(goal)
        local_search = self._local_search(data, goal)
        manager = _Penalties(data, self._translation.penalties, max(*goal.weights, goal.prizes))
        if step.start is None:
            initial = self._initial(data, local_search, manager)
        else:
            initial = self._translation.moved(step.start, goal)
        self._offer(initial, goal)
        watcher = _Watcher(self._offer, self._stop, goal, step.iterations)
        small = len(self._translation.fleet.rules.clients) <= _FEW
        settings = IteratedLocalSearchParams(callbacks=watcher, exhaustive_on_best=small)
        with warnings.catch_warnings(action="ignore", category=PenaltyBoundWarning):
            # It is expected that no plan reaches some goals.
            search = IteratedLocalSearch(data, manager, local_search, initial, settings)
            search.run(watcher, collect_stats=False)
        return watcher.iterations

    def _local_search(self, data: pyvrp.ProblemData, goal: Goal) -> pyvrp.search.LocalSearch:
        if self._neighbours is None or self._neighbours[0] != goal.weights:
            self._neighbours = goal.weights, pyvrp.search.compute_neighbours(data)
        local_search = pyvrp.search.LocalSearch(data, self._random, self._neighbours[1])
        for operator in pyvrp.search.OPERATORS:
            if operator.supports(data):
                local_search.add_operator(operator(data))
        return local_search

    def _initial(
        self,
        data: pyvrp.ProblemData,
        local_search: pyvrp.search.LocalSearch,
        manager: PenaltyManager,
    ) -> pyvrp.Solution:
        random = pyvrp.Solution.make_random(data, self._random)
        seconds = _EXHAUSTIVE * len(self._translation.fleet.rules.clients) ** 2
        if self._watch.over(seconds):
            return random
        return local_search(random, manager.max_cost_evaluator(), exhaustive=True)


class _Penalties(PenaltyManager):
    """PyVRP's penalties, with a greatest penalty of its own for exceeding a limit.

    The largest weight of the goal multiplies the greatest penalties, as it multiplies costs.
    """

    def __init__(self, data: pyvrp.ProblemData, most: Penalties, weight: int) -> None:
        parameters = PenaltyParams(max_penalty=weight * most.load)
        loads, _, _ = parameters.midpoint_penalties(data)
        self._most_limit = weight * most.limit
        super().__init__((loads, self._most_limit / 2, self._most_limit / 2), parameters)

    def cost_evaluator(self) -> pyvrp.CostEvaluator:
        """Return the evaluator of the current penalties."""
        loads, time, distance = self.penalties()
        most = self._most_limit
        return pyvrp.CostEvaluator(loads, min(time, most), min(distance, most))

    def max_cost_evaluator(self) -> pyvrp.CostEvaluator:
        """Return the evaluator of the greatest penalties."""
        loads = [self._params.max_penalty] * len(self.penalties()[0])
        return pyvrp.CostEvaluator(loads, self._most_limit, self._most_limit)


@dataclass
class _Watcher(IteratedLocalSearchCallbacks):
    """Offers each candidate of a search, and ends it."""

    offer: Offer
    stop: Callable[[], bool]
    goal: Goal
    most: int  # iterations
    iterations: int = 0

    def on_iteration(
        self,
        current: pyvrp.Solution,  # noqa: ARG002  PyVRP names them all
        candidate: pyvrp.Solution,
        best: pyvrp.Solution,  # noqa: ARG002
        cost_evaluator: pyvrp.CostEvaluator,  # noqa: ARG002
    ) -> None:
        """Offer the candidate."""
        self.iterations += 1
        self.offer(candidate, self.goal)

    def on_best(self, best: pyvrp.Solution) -> None:
        """Offer a new best solution, which may be better than the candidate."""
        self.offer(best, self.goal)

    def __call__(self, best_cost: float) -> bool:  # noqa: ARG002
        """Return whether to end the search."""
        return self.iterations >= self.most or self.stop()
