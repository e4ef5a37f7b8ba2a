"""Plan a front over a map on which paths give up metres for cost.

A front is planned for each weight between the objectives by which all legs choose their paths, with
an equal share of the time that is left. Then the legs of each tour choose again, by many weights.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.coverage.leg_paths import LegPaths
from service.front import Front, PlanOptions, Progress, ReportOf, SearchResult, Termination
from service.instance import Instance, tour_steps
from service.objectives import OBJECTIVES
from service.pareto import nondominated
from service.replanning.earlier_tours import EarlierTours
from service.replanning.kept_legs import kept_shares, with_most_kept_at
from service.search.best_subset import best_subset
from service.search.hypervolume import hypervolume

Array = NDArray[np.float64]
Tours = NDArray[np.integer]
# Plans the front of an instance, with `stop` and `report` as plan(...) has them.
PlanOf = Callable[[Instance, PlanOptions, Callable[[], bool], ReportOf[Front]], Front]
_LEAST_OF_WEIGHT = 200  # tours of each weight whose legs choose again, if there are as many
_MOST_FOUND = 2000  # points of two objectives that are kept; of more, as many as are reported
_LAST = 0.05  # of the time limit: for the choices of legs, and of the tours to report
_DIGITS = 12  # of shares of the reference point that differ count
_LEAST_SECONDS = 1e-3  # for all searches
_BY_WEIGHT: tuple[Termination | None, ...] = ("cancelled", "time_limit", "converged", None)


class PlanWithDetours:
    """The planning of one front.

    Args:
        legs: The paths between the places.
        options: The options of the front and the search.
        earlier: What is left of the tours of the front that is replanned, if one is.
        stop: As in plan(...).
        report: As in plan(...).
    """

    def __init__(
        self,
        legs: LegPaths,
        options: PlanOptions,
        earlier: EarlierTours | None,
        stop: Callable[[], bool],
        report: ReportOf[Front],
    ) -> None:
        self._began = time.monotonic()
        self._legs, self._earlier = legs, earlier
        self._stop, self._report = stop, report
        # By default the box of the shortest paths: fronts with and without detours can be compared.
        point = options.reference_point
        self._reference_point = legs.instance.reference_point if point is None else point
        self._options = replace(options, reference_point=self._reference_point)
        n, objectives = legs.instance.n, legs.instance.objectives
        nothing = np.empty(0, np.int64)
        self._found = _Found(np.empty((0, objectives)), np.empty((0, n), np.int64), nothing)
        self._hypervolume = 0.0

    def run(self, planned: PlanOf) -> Front:
        """Return the best front found within the time limit, with the path that each leg takes.

        Args:
            planned: Plans the front of an instance.

        Raises:
            Cancelled, NoTour, Refusal: As in plan(...) and replan(...).
        """
        fronts: list[Front] = []
        for instance in self._legs.instances():
            if fronts and self._stop():
                break
            options = self._next_options(len(fronts))
            front = planned(instance, options, self._stop, self._tell)
            fronts.append(front)
            self._add(front)
        front = self._front(fronts[0], self._found, self._options.size)
        ends: set[Termination | None] = {each.terminated for each in fronts}
        phases = fronts[0].timings
        return replace(
            front,
            constructed=sum(each.constructed for each in fronts),
            terminated=next(end for end in _BY_WEIGHT if end in ends),
            timings={phase: sum(each.timings[phase] for each in fronts) for phase in phases},
        )

    def _next_options(self, planned: int) -> PlanOptions:
        """Return the options of the next front, after this many."""
        size = max(self._options.size, _LEAST_OF_WEIGHT)
        options = replace(self._options, size=size)
        if options.time_limit == 0:
            return options
        if options.fewer and planned:
            options = replace(options, directions=options.directions[:0])
        left = (1 - _LAST) * options.time_limit - (time.monotonic() - self._began)
        share = max(left, _LEAST_SECONDS) / (self._legs.count - planned)
        tours = np.unique(self._found.tours, axis=0).astype(np.int64)
        if options.initial_tours is not None:
            tours = np.concatenate((options.initial_tours, tours))
        return replace(options, time_limit=share, initial_tours=tours)

    def _add(self, front: Front) -> None:
        """Keep what a front adds, and report it: its search may have been too short for that."""
        self._found = self._with(front.tours)
        self._hypervolume = hypervolume(self._found.points, self._reference_point)
        self._say(0.0, 0, lambda size: self._front(front, self._found, size))

    def _with(self, tours: Tours) -> "_Found":
        """Return what is found so far and what further tours add once their legs have chosen."""
        known = self._found
        lengths = self._legs.tour_lengths(tour_steps(self._legs.instance, tours))
        choices, count, objectives = lengths.shape
        points = np.concatenate((known.points, lengths.reshape(-1, objectives)))
        rows = np.concatenate((known.rows, np.repeat(np.arange(choices), count)))
        own = np.tile(np.arange(count), choices) + len(known.tours)
        tours = np.concatenate((known.tours, tours))
        places = np.concatenate((np.arange(len(known.tours)), own))
        # What the same paths add up to in another order is equal but for rounding.
        front = nondominated((points / self._reference_point).round(_DIGITS))
        most = max(self._options.size, _MOST_FOUND if objectives == OBJECTIVES else 0)
        if len(front) > most:
            front = front[best_subset(points[front], most, self._reference_point)]
        return _Found(points[front], tours[places[front]], rows[front])

    def _front(self, front: Front, found: "_Found", size: int) -> Front:
        """Return the best of what is found, as a front like another."""
        legs, earlier = self._legs, self._earlier
        chosen = best_subset(found.points, min(size, self._options.size), self._reference_point)
        kept = None
        if earlier is not None:
            if earlier.balance is not None and earlier.min_kept == 0:
                result = SearchResult(found.points, found.tours.__getitem__, None)
                chosen = with_most_kept_at(
                    legs.instance, earlier.driven, earlier.balance, result, chosen
                )
            kept = kept_shares(legs.instance, found.tours[chosen], earlier.driven)
        tours, points = found.tours[chosen], found.points[chosen]
        return replace(
            front,
            tours=tours,
            points=points,
            leg_paths=legs.chosen(tour_steps(legs.instance, tours), found.rows[chosen]),
            kept=kept,
            found=len(found.points),
            scale=legs.instance.scale,
            hypervolume=hypervolume(points, self._reference_point),
            gained=None,
        )

    def _tell(self, progress: Progress, best: Callable[[int], Front]) -> None:
        """Report what is found so far, with what the search that runs has found."""

        def best_front(size: int) -> Front:
            front = best(size)
            return self._front(front, self._with(front.tours), size)

        self._say(progress.hypervolume, progress.points, best_front)

    def _say(self, found: float, points: int, best: Callable[[int], Front]) -> None:
        """Report a hypervolume and points: never less than before, though each search is new."""
        found = max(found, self._hypervolume)
        points = max(points, len(self._found.points))
        self._report(Progress(time.monotonic() - self._began, found, points), best)


@dataclass(frozen=True, eq=False)
class _Found:
    """Nondominated points, shape (k, m), with the tour and the row of choices of each."""

    points: Array
    tours: Tours
    rows: NDArray[np.int64]
