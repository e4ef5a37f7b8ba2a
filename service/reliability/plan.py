"""plan_reliably(...): from mean costs and their spread to a front.

What a tour does not exceed on nine days of ten rises with the mean and with the variance of its
length. So each tour that is nondominated by it is so by mean and variance too: the variance becomes
one more objective of the search, and the tours to report are chosen among all that it finds. Of
given days no sum along a tour is exact. There the search looks for what is about the variance, and
up to eight stops all tours are driven.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np
from numpy.typing import NDArray

from service.front import Front, PlanOptions, SearchResult
from service.instance import Instance, tour_steps
from service.reliability.spread import NINE_IN_TEN, Spread, addends, at_percent, lengths_at
from service.search.best_subset import best_subset, selection_limit
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.watch import Watch

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
Plan = Callable[[Instance, PlanOptions, Watch[Front]], Front]
_MOST_DRIVEN = 1000  # tours that are driven on each given day, of those that seem best
_FEW_STOPS = 8  # up to this number all tours are


def plan_reliably(
    plan: Plan,
    instance: Instance,
    spreads: Sequence[Spread | None],
    options: PlanOptions,
    watch: Watch[Front],
) -> Front:
    """Return the best front found, with the means and nine-in-tens of its tours.

    Args:
        plan: Plans a front, as `plan(...)` does.
        instance: The instance, with mean costs as matrices.
        spreads: The spread of each objective; None where its costs are certain.

    Raises:
        Cancelled, NoTour: As in plan(...).
    """
    return _Planning(instance, spreads, options, watch).run(plan)


class _Planning:
    """The planning of one front."""

    def __init__(
        self,
        instance: Instance,
        spreads: Sequence[Spread | None],
        options: PlanOptions,
        watch: Watch[Front],
    ) -> None:
        assert instance.matrices is not None
        self._instance, self._means, self._spreads = instance, instance.matrices, spreads
        self._options, self._watch = options, watch
        point = options.reference_point
        self._reference_point = instance.reference_point if point is None else point
        self._found: int | None = None
        self._by_days = any(each and each.percent and each.days is not None for each in spreads)

    def run(self, plan: Plan) -> Front:
        """Return the front."""
        options = replace(
            self._options,
            directions=self._directions,
            reference_point=None,
            choose_again=self._choose,
        )
        watch = self._watch.converting(self._reported)
        front = plan(self._searched, options, watch)
        found = front.found if self._found is None else self._found
        return replace(self._reported(front), found=found)

    @property
    def _searched(self) -> Instance:
        """The instance under mean costs, and for each percentile variances."""
        pairs = zip(self._spreads, self._means, strict=True)
        more = [addends(each, means) for each, means in pairs if each and each.percent]
        return Instance(
            matrices=np.concatenate((self._means, *(each[np.newaxis] for each in more))),
            closed=self._instance.closed,
            start=self._instance.start,
            end=self._instance.end,
        )

    @property
    def _directions(self) -> Array:
        """The directions for the search: a variance has as much as its mean."""
        given = self._options.directions
        more = [given[:, m] for m, each in enumerate(self._spreads) if each and each.percent]
        longer = np.column_stack((given, *more))
        norms: Array = np.linalg.norm(longer, axis=1, keepdims=True)
        return longer / norms

    def _choose(self, found: SearchResult, _: Indices) -> Indices:
        """Return the indices of the tours to report."""
        seconds = selection_limit(self._options.time_limit)
        points = self._of_sums(found.points)
        indices, front = FrontPoints.among(points, self._reference_point)
        if self._by_days:
            indices = indices[best_subset(front, _MOST_DRIVEN, seconds)]
            points = self._lengths(found.tours_at(indices).astype(np.int64))
            chosen, front = FrontPoints.among(points, self._reference_point)
            indices = indices[chosen]
        self._found = len(front)
        best = best_subset(front, self._options.size, seconds, self._watch.stopped)
        return np.sort(indices[best])

    def _of_sums(self, points: Array) -> Array:
        """Return the lengths of tours, given what the search measures, shape (k, m)."""
        found, more = points[:, : len(self._means)].copy(), len(self._means)
        for objective, spread in enumerate(self._spreads):
            if spread and spread.percent:
                found[:, objective] = at_percent(
                    found[:, objective], points[:, more], spread.percent
                )
                more += 1
        return found

    def _lengths(self, tours: NDArray[np.integer]) -> Array:
        """Return the lengths of tours, shape (k, m)."""
        percents = [None if spread is None else spread.percent for spread in self._spreads]
        return self._at(percents, tours)

    def _at(self, percents: Sequence[int | None], tours: NDArray[np.integer]) -> Array:
        """Return what the lengths do not exceed on so many days of a hundred; None for means."""
        steps = tour_steps(self._instance, tours)
        columns = [
            lengths_at(spread, means, steps, percent)
            if spread and percent
            else means[steps].sum(axis=1)
            for spread, means, percent in zip(self._spreads, self._means, percents, strict=True)
        ]
        return np.stack(columns, axis=1)

    def _reported(self, front: Front) -> Front:
        """Return a front of the search as it is reported: those of its tours that are best."""
        tours = front.tours
        if self._by_days and self._instance.n <= _FEW_STOPS:
            tours = _all_tours(self._instance, self._options.start)
        points = self._lengths(tours)
        indices, best = FrontPoints.among(points, self._reference_point)
        if len(indices) > self._options.size:
            indices = indices[best_subset(best, self._options.size)]
        tours, points = tours[indices], points[indices]
        m = len(self._means)
        return replace(
            front,
            tours=tours,
            points=points,
            scale=self._instance.scale,
            reference_point=self._reference_point,
            hypervolume=hypervolume(points, self._reference_point),
            gained=None,
            means=self._at([None] * m, tours),
            p90=self._at([NINE_IN_TEN] * m, tours),
        )


def _all_tours(instance: Instance, start: int) -> NDArray[np.int64]:
    """Return all tours of a few cities that no forbidden leg breaks, shape (k, n)."""
    assert instance.matrices is not None
    tours = np.array(list(permutations(range(instance.n))))
    first, last = (start, None) if instance.closed else (instance.start, instance.end)
    for place, city in ((0, first), (-1, last)):
        if city is not None:
            tours = tours[tours[:, place] == city]
    allowed = np.isfinite(instance.matrices[0][tour_steps(instance, tours)]).all(axis=1)
    return tours[allowed]
