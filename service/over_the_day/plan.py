"""plan_over_the_day(...): from a day to its front.

First a front is planned under mean costs. Its tours are driven through the day, then improved
there, each under a weighted sum of exact lengths. Up to eight stops all tours are tried.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from service.errors import Cancelled
from service.front import Front, PlanOptions, Termination
from service.instance import Instance
from service.over_the_day.day import Day
from service.over_the_day.search import DaySearch
from service.replanning.earlier_tours import EarlierTours
from service.replanning.kept_legs import kept_shares
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.open_routes import rotated
from service.watch import Watch

Array = NDArray[np.float64]
Tours = NDArray[np.integer]
PlanUnderMeans = Callable[[PlanOptions, Watch[Front]], Front]
# Of the time limit; the search over the day gains more the more seconds there are for each stop.
_LEAST_SHARE, _MOST_SHARE, _LESS_BY_SECOND = 0.5, 0.85, 40.0
_LEAST_OF_MEANS = 300  # tours under mean costs that are driven through the day, if there are
_SHARE_OF_DRIVING = 0.05  # of the time limit: for driving the tours found under mean costs
_DRIVEN_AT_ONCE = 20  # tours
_MEASURED = 5  # tours whose best departures are timed


def plan_over_the_day(
    plan_under_means: PlanUnderMeans,
    day: Day,
    options: PlanOptions,
    earlier: EarlierTours | None = None,
    watch: Watch[Front] | None = None,
) -> Front:
    """Return the best front found within the time limit, with exact lengths and departures.

    Each tour leaves when it takes the fewest seconds, as early as that may be. Where tours have to
    keep a share of the driven tour, those found under mean costs are not improved.

    Args:
        plan_under_means: Plans the front of the day's instance, which has mean costs.
        options: The options of the front and the search.
        earlier: What is left of the tours of the front that is replanned, if one is.
        watch: The watch over the work, as in plan(...).

    Raises:
        Cancelled, NoTour, Refusal: As in plan(...) and replan(...).
    """
    return _Planning(day, options, earlier, watch or Watch()).run(plan_under_means)


class _Planning:
    """The planning of one front."""

    def __init__(
        self,
        day: Day,
        options: PlanOptions,
        earlier: EarlierTours | None,
        watch: Watch[Front],
    ) -> None:
        self._watch = watch.lasting(options.time_limit)
        self._earlier = earlier
        # A tour found over the day may keep less of the driven one.
        self._improves = options.time_limit > 0 and (earlier is None or earlier.min_kept == 0)
        self._day, self._instance, self._options = day, day.instance, options
        self._search = DaySearch(day, options.seed, options.start)
        point = options.reference_point
        self._reference_point = _reference_point_of(day) if point is None else point
        self._finishing = 0.0  # seconds that the best departure of one tour takes

    def run(self, plan_under_means: PlanUnderMeans) -> Front:
        """Return the front."""
        means = self._under_means(plan_under_means)
        began = self._watch.spent
        self._add(means.tours)
        if self._options.initial_tours is not None:
            self._search.add(_from_start(self._instance, self._options))
        terminated = means.terminated
        if self._improves:
            self._measure_finishing()
            terminated = self._improve(means)
        improved = self._watch.spent
        front = self._front(means, self._options.size, self._watch, terminated)
        if not len(front.tours):
            raise Cancelled
        timings = {
            "over_the_day": 1000 * (improved - began),
            "departures": 1000 * (self._watch.spent - improved),
        }
        return replace(front, timings={**means.timings, **timings})

    def _under_means(self, plan_under_means: PlanUnderMeans) -> Front:
        """Return a front under mean costs."""
        options = replace(self._options, reference_point=None)
        if self._improves:
            limit = _share_of_means(options.time_limit / self._instance.n) * options.time_limit
            size = max(options.size, _LEAST_OF_MEANS)
            options = replace(options, time_limit=limit, size=size)
        return plan_under_means(options, self._watch.converting(self._driven))

    def _add(self, tours: Tours) -> None:
        """Drive tours through the day, a few at a time, until a part of the time has gone."""
        limit = self._options.time_limit
        driving = self._watch.lasting(_SHARE_OF_DRIVING * limit)
        parts = max(1, len(tours) // _DRIVEN_AT_ONCE)
        for part in range(parts):  # each of them spread over the front
            self._search.add(self._both_ways(tours[part::parts]))
            if limit > 0 and driving.over():
                return

    def _both_ways(self, tours: Tours) -> Tours:
        """Return tours, and their reverses where these are allowed: over the day they differ."""
        if self._earlier is not None and self._earlier.min_kept > 0:
            return tours
        if self._instance.closed:
            return np.concatenate((tours, np.roll(tours[:, ::-1], 1, axis=1)))
        if not self._instance.fixed_ends:
            return np.concatenate((tours, tours[:, ::-1]))
        return tours

    def _driven(self, means: Front) -> Front:
        """Return a front that was found under mean costs so far, driven through the day."""
        self._search.add(self._both_ways(means.tours))
        return self._so_far(means, self._options.size)

    def _so_far(self, means: Front, size: int) -> Front:
        """Return the best front so far, without a search for best departures."""
        return self._front(means, size, self._watch.until(0.0), terminated=None)

    def _front(
        self,
        means: Front,
        size: int,
        watch: Watch[Front],
        terminated: Termination | None,
    ) -> Front:
        """Return the best front so far; best departures are looked for while there is time."""
        points, tours = self._search.found()
        front = FrontPoints(points, self._reference_point)
        seconds = selection_limit(self._options.time_limit)
        chosen = best_subset(front, min(size, self._options.size), seconds)
        # With their best departures, some may dominate others.
        driven = self._search.driven(tours[chosen], watch).best()
        kept = None
        if self._earlier is not None:
            kept = kept_shares(self._instance, driven.tours, self._earlier.driven)
        return replace(
            means,
            tours=driven.tours,
            points=driven.points,
            departures=driven.departures,
            reached=driven.reached,
            clock=self._day.clock,
            kept=kept,
            found=len(points) - len(chosen) + len(driven.tours),
            reference_point=self._reference_point,
            hypervolume=hypervolume(driven.points, self._reference_point),
            terminated=terminated,
            gained=None,
        )

    def _measure_finishing(self) -> None:
        """Note how long it takes to find the best departure of a tour."""
        tours = self._search.found()[1][:_MEASURED]
        self._search.driven(tours[:1], Watch())  # loads the compiled code
        timed = Watch[Front]()
        self._search.driven(tours, timed)
        self._finishing = timed.spent / max(1, len(tours))

    def _reserve(self) -> float:
        """Return the seconds that it takes to select the front."""
        size, points = self._options.size, self._search.size
        seconds = selection_limit(self._options.time_limit)
        selecting = selection_seconds(size, points, self._instance.objectives, seconds)
        return selecting + self._finishing * min(size, points)

    def _improve(self, means: Front) -> Termination:
        """Search until the time is over, and report on the way."""
        for _ in self._search.run():
            if self._watch.stopped():
                return "cancelled"
            if self._watch.over(self._reserve()):
                return "time_limit"
            self._watch.report_if_due(self._found, partial(self._so_far, means))
        return "converged"

    def _found(self) -> tuple[float, int]:
        """Return the hypervolume and the number of points found so far."""
        points, _ = self._search.found()
        return FrontPoints(points, self._reference_point).quick_hypervolume, len(points)


def _share_of_means(seconds_for_each: float) -> float:
    """Return the share of the time that planning on mean costs gets, by the seconds for a stop."""
    share = 1 - _LESS_BY_SECOND * seconds_for_each
    return min(_MOST_SHARE, max(_LEAST_SHARE, share))


def _from_start(instance: Instance, options: PlanOptions) -> Tours:
    """Return the caller's tours; closed ones begin at the start."""
    assert options.initial_tours is not None
    tours: Tours = options.initial_tours
    return rotated(tours, (tours == options.start).argmax(axis=1)) if instance.closed else tours


def _reference_point_of(day: Day) -> Array:
    """Return the default reference point: that of the mean costs, and the service of all stops."""
    point = day.instance.reference_point.copy()
    point[day.clock] += day.service.sum()
    return point
