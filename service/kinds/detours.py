"""Plan a front over a map where a leg can take a longer path for a lower cost.

Each leg has several paths, and each path number has its weights of the objectives. For each path
number a front is planned in which every leg takes its best path under these weights, within an
equal share of the time left. Then the legs of each tour found choose again, by many more weights.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.coverage.leg_paths import LegPaths
from service.front import Front, PlanOptions, SearchResult, Termination
from service.instance import Instance, tour_steps
from service.objectives import OBJECTIVES
from service.replanning.earlier_tours import EarlierTours
from service.replanning.kept_legs import kept_shares, with_most_kept_at
from service.search.best_subset import SHORTLY, best_subset
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.nondominated import nondominated
from service.watch import Progress, Watch

Array = NDArray[np.float64]
Tours = NDArray[np.integer]
PlanOf = Callable[[Instance, PlanOptions, Watch[Front]], Front]
_OF_SEARCH = 200  # tours that each search returns, if it finds as many; their legs choose again
_MOST_FOUND = 2000  # points kept under two objectives; under more, only as many as are reported
_CHOOSING = 0.05  # share of the time limit for choosing paths and tours, before it was measured
_DIGITS = 12  # lengths are equal if their shares of the reference point agree to these decimals
_LEAST_SECONDS = 1e-3  # of a search
# Searches may end for different reasons: of these reasons the first in this order is reported.
_BY_WEIGHT: tuple[Termination | None, ...] = ("cancelled", "time_limit", "converged", None)


class PlanWithDetours:
    """Plans one front.

    Args:
        legs: The paths between the places.
        options: The options of the front and the search.
        earlier: The rest of the tours of an earlier front, if that front is replanned.
        watch: The watch over the work, as in plan(...).
    """

    def __init__(
        self,
        legs: LegPaths,
        options: PlanOptions,
        earlier: EarlierTours | None,
        watch: Watch[Front],
    ) -> None:
        self._watch = watch.lasting(options.time_limit)
        self._legs, self._earlier = legs, earlier
        # By default that of the shortest paths, so that the hypervolumes of fronts with and
        # without detours can be compared.
        point = options.reference_point
        self._reference_point = legs.instance.reference_point if point is None else point
        self._options = replace(options, reference_point=self._reference_point)
        n, objectives = legs.instance.n, legs.instance.objectives
        nothing = np.empty(0, np.int64)
        self._found = _Found(np.empty((0, objectives)), np.empty((0, n), np.int64), nothing)
        self._hypervolume = 0.0
        # The longest seconds that it took so far to choose paths and tours after a search.
        self._choosing = _CHOOSING * options.time_limit / legs.count

    def run(self, planned: PlanOf) -> Front:
        """Return the best front found within the time limit, with the path that each leg takes.

        Args:
            planned: Called to plan the front of each instance of the legs.

        Raises:
            Cancelled, NoTour, Refusal: As in plan(...) and replan(...).
        """
        fronts: list[Front] = []
        ends: set[Termination | None] = set()
        for instance in self._legs.instances():
            seconds = self._seconds(len(fronts))
            if fronts and (self._watch.stopped() or seconds < _LEAST_SECONDS):
                ends.add("cancelled" if self._watch.stopped() else "time_limit")
                break
            options = self._next_options(len(fronts), seconds)
            front = planned(instance, options, self._watch.reporting(self._tell))
            fronts.append(front)
            ends.add(front.terminated)
            self._add(front)
        front = self._front(fronts[0], self._found, self._options.size)
        timings = {
            phase: sum(each.timings[phase] for each in fronts) for phase in fronts[0].timings
        }
        # The rest is the choice of paths and of tours.
        timings["selection"] += 1000 * self._watch.spent - sum(timings.values())
        return replace(
            front,
            constructed=sum(each.constructed for each in fronts),
            terminated=next(end for end in _BY_WEIGHT if end in ends),
            timings=timings,
        )

    def _seconds(self, planned: int) -> float:
        """Return the seconds of the next search, after `planned` searches.

        Those that are left are shared equally by the remaining searches, or by as many of them as
        have time for more than choosing paths.
        """
        if self._options.time_limit == 0:
            return math.inf
        left = self._watch.left
        most = int(left / (2 * self._choosing))
        return left / max(1, min(self._legs.count - planned, most)) - self._choosing

    def _next_options(self, planned: int, seconds: float) -> PlanOptions:
        """Return the options of the next search, of these seconds, after `planned` searches."""
        if self._options.time_limit == 0:
            return replace(self._options, size=max(self._options.size, _OF_SEARCH))
        options = replace(self._options, size=_OF_SEARCH)
        if options.fewer and planned:
            options = replace(options, directions=options.directions[:0])
        tours = np.unique(self._found.tours, axis=0).astype(np.int64)
        if options.initial_tours is not None:
            tours = np.concatenate((options.initial_tours, tours))
        return replace(options, time_limit=max(seconds, _LEAST_SECONDS), initial_tours=tours)

    def _add(self, front: Front) -> None:
        """Add the tours of a front to those found, and report: a short search may not have."""
        began = self._watch.spent
        self._found = self._with(front.tours)
        found = FrontPoints(self._found.points, self._reference_point)
        self._hypervolume = found.quick_hypervolume
        self._say(0.0, 0, lambda size: self._front(front, self._found, size))
        self._choosing = max(self._choosing, self._watch.spent - began)

    def _with(self, tours: Tours) -> "_Found":
        """Return the points found so far together with those of further tours.

        The legs of the further tours choose their paths by each row of choices.
        """
        known = self._found
        lengths = self._legs.tour_lengths(tour_steps(self._legs.instance, tours))
        choices, count, objectives = lengths.shape
        points = np.concatenate((known.points, lengths.reshape(-1, objectives)))
        rows = np.concatenate((known.rows, np.repeat(np.arange(choices), count)))
        own = np.tile(np.arange(count), choices) + len(known.tours)
        tours = np.concatenate((known.tours, tours))
        places = np.concatenate((np.arange(len(known.tours)), own))
        # Lengths of the same paths in another order differ by rounding alone: they are equal here.
        front = nondominated((points / self._reference_point).round(_DIGITS))
        most = max(self._options.size, _MOST_FOUND if objectives == OBJECTIVES else 0)
        if len(front) > most:
            front = front[self._best(points[front], most)]
        return _Found(points[front], tours[places[front]], rows[front])

    def _front(self, front: Front, found: "_Found", size: int) -> Front:
        """Return the best `size` of the tours found; other attributes are those of `front`."""
        legs, earlier = self._legs, self._earlier
        chosen = self._best(found.points, min(size, self._options.size))
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

    def _best(self, points: Array, size: int) -> NDArray[np.intp]:
        """Return the indices of the best `size` points of a front."""
        front = FrontPoints(points, self._reference_point)
        return best_subset(front, size, SHORTLY)

    def _tell(self, progress: Progress, best: Callable[[int], Front]) -> None:
        """Report the tours found so far, those of the search in progress included."""

        def best_front(size: int) -> Front:
            front = best(size)
            return self._front(front, self._with(front.tours), size)

        self._say(progress.hypervolume, progress.points, best_front)

    def _say(self, found: float, points: int, best: Callable[[int], Front]) -> None:
        """Report a hypervolume and a number of points.

        A new search begins with few points. So neither number is below that of all tours found.
        """
        found = max(found, self._hypervolume)
        points = max(points, len(self._found.points))
        self._watch.report(Progress(self._watch.spent, found, points), best)


@dataclass(frozen=True, eq=False)
class _Found:
    """Nondominated points, shape (k, m), each with its tour and its row of choices of paths."""

    points: Array
    tours: Tours
    rows: NDArray[np.int64]
