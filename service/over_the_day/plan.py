"""plan_over_the_day(...): from a day to its front.

First a front is planned under mean costs. Its tours are driven through the day, then improved
there, each under a weighted sum of exact lengths. Up to eight stops all tours are tried.
"""

import math
import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from service.errors import Cancelled
from service.front import Front, PlanOptions, Progress, ReportOf, Termination, reporting
from service.instance import Instance
from service.over_the_day.day import Day
from service.over_the_day.search import DaySearch
from service.replanning.earlier_tours import EarlierTours
from service.replanning.kept_legs import kept_shares
from service.search.best_subset import best_subset, selection_limit, selection_seconds
from service.search.front_points import FrontPoints
from service.search.hypervolume import hypervolume
from service.search.open_routes import rotated

Array = NDArray[np.float64]
Tours = NDArray[np.integer]
# Plans a front, with `stop` and `report` as plan(...) has them.
PlanUnderMeans = Callable[[PlanOptions, Callable[[], bool], ReportOf[Front]], Front]
# Of the time limit; the search over the day gains more the more seconds there are for each stop.
_LEAST_SHARE, _MOST_SHARE, _LESS_BY_SECOND = 0.5, 0.85, 40.0
_LEAST_OF_MEANS = 300  # tours under mean costs that are driven through the day, if there are
_SHARE_OF_DRIVING = 0.05  # of the time limit: for driving the tours found under mean costs
_DRIVEN_AT_ONCE = 20  # tours
_MEASURED = 5  # tours whose best departures are timed
_REPORT_EVERY = 0.1  # seconds


def plan_over_the_day(
    plan_under_means: PlanUnderMeans,
    day: Day,
    options: PlanOptions,
    earlier: EarlierTours | None = None,
    stop: Callable[[], bool] = lambda: False,
    report: ReportOf[Front] = lambda *_: None,
) -> Front:
    """Return the best front found within the time limit, with exact lengths and departures.

    Each tour leaves when it takes the fewest seconds, as early as that may be. Where tours have to
    keep a share of the driven tour, those found under mean costs are not improved.

    Args:
        plan_under_means: Plans the front of the day's instance, which has mean costs.
        day: The day.
        options: The options of the front and the search.
        earlier: What is left of the tours of the front that is replanned, if one is.
        stop: As in plan(...).
        report: As in plan(...).

    Raises:
        Cancelled, NoTour, Refusal: As in plan(...) and replan(...).
    """
    return _Planning(day, options, earlier, stop, report).run(plan_under_means)


class _Planning:
    """The planning of one front."""

    def __init__(
        self,
        day: Day,
        options: PlanOptions,
        earlier: EarlierTours | None,
        stop: Callable[[], bool],
        report: ReportOf[Front],
    ) -> None:
        self._began = time.monotonic()
        self._deadline = self._began + options.time_limit
        self._earlier = earlier
        # A tour found over the day may keep less of the driven one.
        self._improves = options.time_limit > 0 and (earlier is None or earlier.min_kept == 0)
        self._day, self._instance, self._options = day, day.instance, options
        self._stop, self._report = stop, report
        self._search = DaySearch(day, options.seed, options.start)
        point = options.reference_point
        self._reference_point = _reference_point_of(day) if point is None else point
        self._finishing = 0.0  # seconds that the best departure of one tour takes

    def run(self, plan_under_means: PlanUnderMeans) -> Front:
        """Return the front."""
        means = self._under_means(plan_under_means)
        began = time.monotonic()
        self._add(means.tours)
        if self._options.initial_tours is not None:
            self._search.add(_from_start(self._instance, self._options))
        terminated = means.terminated
        if self._improves:
            self._measure_finishing()
            terminated = self._improve(means)
        improved = time.monotonic()
        front = self._front(means, self._options.size, terminated, self._deadline)
        if not len(front.tours):
            raise Cancelled
        timings = {
            "over_the_day": 1000 * (improved - began),
            "departures": 1000 * (time.monotonic() - improved),
        }
        return replace(front, timings={**means.timings, **timings})

    def _under_means(self, plan_under_means: PlanUnderMeans) -> Front:
        """Return a front under mean costs."""
        options = replace(self._options, reference_point=None)
        if self._improves:
            limit = _share_of_means(options.time_limit / self._instance.n) * options.time_limit
            size = max(options.size, _LEAST_OF_MEANS)
            options = replace(options, time_limit=limit, size=size)
        return plan_under_means(options, self._stop, reporting(self._report, self._driven))

    def _add(self, tours: Tours) -> None:
        """Drive tours through the day, a few at a time, until a part of the time has gone."""
        ends = time.monotonic() + _SHARE_OF_DRIVING * self._options.time_limit
        parts = max(1, len(tours) // _DRIVEN_AT_ONCE)
        for part in range(parts):  # each of them spread over the front
            self._search.add(self._both_ways(tours[part::parts]))
            if self._options.time_limit > 0 and time.monotonic() > ends:
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
        return self._front(means, self._options.size)

    def _front(
        self,
        means: Front,
        size: int,
        terminated: Termination | None = None,
        deadline: float = -math.inf,
    ) -> Front:
        """Return the best front so far; until the deadline, best departures are looked for."""
        points, tours = self._search.found()
        front = FrontPoints(points, self._reference_point)
        seconds = selection_limit(self._options.time_limit)
        chosen = best_subset(front, min(size, self._options.size), seconds)
        # With their best departures, some may dominate others.
        driven = self._search.driven(tours[chosen], deadline).best()
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
        self._search.driven(tours[:1], math.inf)  # loads the compiled code
        began = time.monotonic()
        self._search.driven(tours, math.inf)
        self._finishing = (time.monotonic() - began) / max(1, len(tours))

    def _reserve(self) -> float:
        """Return the seconds that it takes to select the front."""
        size, points = self._options.size, self._search.size
        seconds = selection_limit(self._options.time_limit)
        selecting = selection_seconds(size, points, self._instance.objectives, seconds)
        return selecting + self._finishing * min(size, points)

    def _improve(self, means: Front) -> Termination:
        """Search until the deadline, and report on the way."""
        reported = time.monotonic()
        for _ in self._search.run():
            now = time.monotonic()
            if self._stop():
                return "cancelled"
            if now + self._reserve() >= self._deadline:
                return "time_limit"
            if now - reported >= _REPORT_EVERY and self._deadline - now > _REPORT_EVERY:
                self._tell(means, now)
                reported = time.monotonic()
        return "converged"

    def _tell(self, means: Front, now: float) -> None:
        points, _ = self._search.found()
        found = FrontPoints(points, self._reference_point).quick_hypervolume
        progress = Progress(now - self._began, found, len(points))
        self._report(progress, lambda size: self._front(means, size))


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
