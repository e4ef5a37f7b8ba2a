"""The order of the searches for a front. Each search depends on the results of those before."""

from collections.abc import Callable, Iterator
from itertools import count

import numpy as np
import pyvrp

from service.fleet.archive import SolutionArchive
from service.fleet.limit_steps import LimitSteps
from service.fleet.solver import Step
from service.fleet.translation import Goal, Translation
from service.fleet.weight_steps import weight_steps

FEW_STOPS = 12  # up to this number of stops, the sweep looks for every point
_FIRST_ITERATIONS = 100
_FREE_SHARE = 0.25  # share of all iterations for the least sum without a limit, the first search
_MOST_DOUBLINGS = 10
_ROUGH_LIMITS, _ROUGH_ITERATIONS = 7, 50  # in the first round
_LIMITS = 24  # in each further round
_LEAST_ITERATIONS, _MOST_ITERATIONS = 50, 3000  # for a limit in one round
_IDLE_ROUNDS = 3  # rounds without a new solution, after which a sweep of few stops has converged


class Sweep:
    """The searches for a front. Each must be run into the archive before the next is requested.

    Args:
        translation: The translation of the fleet.
        archive: The solutions of all searches; it may hold some already.
        random: Chooses limits.
        left: Estimates the number of iterations for which there is time.
    """

    def __init__(
        self,
        translation: Translation,
        archive: SolutionArchive,
        random: np.random.Generator,
        left: Callable[[], float],
    ) -> None:
        self._translation = translation
        self._archive = archive
        self._random = random
        self._left = left
        self._limited = translation.roles.limited is not None
        self._few = len(translation.fleet.rules.clients) <= FEW_STOPS

    def steps(self) -> Iterator[Step]:
        """Yield the searches.

        For few stops they end once nothing new is found. Then the front is likely, but not surely,
        exact.
        """
        yield from self._first_steps()
        idle = 0
        for number in count():
            before = self._archive.version
            yield from self._round(number)
            idle = 0 if self._archive.version > before else idle + 1
            if self._few and idle >= _IDLE_ROUNDS:
                return

    def _first_steps(self) -> Iterator[Step]:
        """Yield searches for the least sum alone until there is a solution, and one from there.

        The first search shows how long iterations take.
        """
        free = Goal(weights=self._translation.sum_weights if self._limited else (1, 1))
        iterations = _FIRST_ITERATIONS
        yield Step(free, self._least_sum(), iterations)
        while not len(self._archive):
            iterations *= 2
            yield Step(free, None, iterations)
        if self._limited and not self._few:
            yield Step(free, self._least_sum(), int(_FREE_SHARE * self._left()))

    def _least_sum(self) -> pyvrp.Solution | None:
        """Return the solution of the least sum, or of the least first of two sums, or None."""
        if not len(self._archive):
            return None
        return self._archive.solutions[-1 if self._translation.roles.limited == 0 else 0]

    def _round(self, number: int) -> Iterator[Step]:
        """Yield the searches of a round; for few stops or two sums they get longer every round."""
        iterations = _FIRST_ITERATIONS * 2 ** min(number, _MOST_DOUBLINGS)
        if not self._limited:
            return weight_steps(self._translation, self._archive, iterations)
        if self._few:
            return LimitSteps(self._translation, self._archive, iterations).every_limit()
        if number == 0:
            rough = LimitSteps(self._translation, self._archive, _ROUGH_ITERATIONS)
            return rough.wide_limits(_ROUGH_LIMITS, lambda: 0.5)
        share = int(min(self._left() / _LIMITS, _MOST_ITERATIONS))
        fine = LimitSteps(self._translation, self._archive, max(_LEAST_ITERATIONS, share))
        return fine.wide_limits(_LIMITS, lambda: self._random.uniform(0.3, 0.7))
