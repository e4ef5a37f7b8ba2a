"""Punctuality: how surely a plan is on time, where the times of legs spread from day to day.

A vehicle leaves as planned. Either legs are independent of each other, and when a visit begins is
taken to be normal, with the mean and the variance that legs and waiting leave (Clark, 1961, has
those of the later of two times). Or the times of several days are given, and each route is driven
on each day. Breaks and what a leg takes at its time of day are as planned.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import pairwise
from math import ceil, inf, sqrt
from statistics import NormalDist
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rounding import is_over
from service.fleet.schedule import REMEMBERED, legs, schedule
from service.fleet.times import Schedule

Array = NDArray[np.float64]
_NINE_IN_TEN = 90
_STANDARD = NormalDist()


class Normal(NamedTuple):
    """A time that differs from day to day."""

    mean: float
    variance: float

    def after(self, time: float, variance: float = 0.0) -> "Normal":
        """Return the time after a leg, and whatever else takes the same time every day."""
        return Normal(self.mean + time, self.variance + variance)

    def from_on(self, opens: float) -> "Normal":
        """Return the later one of this time and the time at which a stop opens."""
        if not self.variance or opens == -inf:
            return Normal(max(self.mean, opens), self.variance)
        deviation, ahead = sqrt(self.variance), self.mean - opens
        share = _STANDARD.cdf(ahead / deviation)
        density = deviation * _STANDARD.pdf(ahead / deviation)
        mean = ahead * share + density
        square = (ahead**2 + self.variance) * share + ahead * density
        return Normal(opens + mean, max(0.0, square - mean**2))

    def share_until(self, latest: float) -> float:
        """Return on what share of days it is no later than a time."""
        if not self.variance:
            return float(self.mean <= latest)
        return _STANDARD.cdf((latest - self.mean) / sqrt(self.variance))


class Sampled(NamedTuple):
    """A time that is known on each of d days, shape (d,)."""

    times: Array

    @property
    def mean(self) -> float:
        """The mean of all days."""
        return float(self.times.mean())

    def after(self, time: float, apart: Array | float = 0.0) -> "Sampled":
        """Return the time after a leg, which differs from its mean by so much on each day."""
        return Sampled(self.times + time + apart)

    def from_on(self, opens: float) -> "Sampled":
        """Return the later one of this time and the time at which a stop opens."""
        return Sampled(np.maximum(self.times, opens))

    def share_until(self, latest: float) -> float:
        """Return on what share of days it is no later than a time."""
        late = sum(is_over(time, latest) for time in self.times.tolist())
        return 1.0 - late / len(self.times)


class _Driven(NamedTuple):
    """A route, as it is driven from day to day."""

    on_time: tuple[float, ...]  # for each visit with a latest time, the share of days it is kept
    duration: Normal | Sampled


def punctuality(fleet: Fleet, plan: Plan) -> dict[str, float]:
    """Return the measures of a plan whose times spread, by name; nothing if they do not.

    - `on_time`: the mean share of days on which a visit begins in its window and before it is due,
      over the visits that have either; not there if none has
    - `duration`, `duration_p90`: how long all routes take together on average, and what they do not
      exceed on nine days of ten
    """
    if not fleet.rules.spreads:
        return {}
    shares = [share for route in plan.routes for share in _driven(fleet, route).on_time]
    kept = {"on_time": sum(shares) / len(shares)} if shares else {}
    return {
        **kept,
        "duration": sum(duration_of(fleet, route).mean for route in plan.routes),
        "duration_p90": longest_duration(fleet, plan.routes, _NINE_IN_TEN),
    }


def late_visits(fleet: Fleet, route: Route) -> float:
    """Return how many visits of a route are late on an average day."""
    return sum(1.0 - share for share in _driven(fleet, route).on_time)


def duration_of(fleet: Fleet, route: Route) -> Normal | Sampled:
    """Return how long a route takes."""
    return _driven(fleet, route).duration


def longest_duration(fleet: Fleet, routes: Sequence[Route], percent: int) -> float:
    """Return what routes do not exceed, all together, on so many days of a hundred."""
    durations = [duration_of(fleet, route) for route in routes]
    daily = [each.times for each in durations if isinstance(each, Sampled)]
    if daily:
        return float(np.sort(np.sum(daily, axis=0))[day_at(percent, len(daily[0]))])
    variance = sum(each.variance for each in durations if isinstance(each, Normal))
    return sum(each.mean for each in durations) + deviations_of(percent) * sqrt(variance)


def day_at(percent: int, days: int) -> int:
    """Return the place among so many days, in order, of the last of so many of a hundred.

    >>> day_at(90, 50)
    44
    """
    return max(1, ceil(percent * days / 100)) - 1


def deviations_of(percent: int) -> float:
    """Return how many deviations above its mean a time is that so many days do not exceed."""
    return _STANDARD.inv_cdf(percent / 100)


@lru_cache(REMEMBERED)
def _driven(fleet: Fleet, route: Route) -> _Driven:
    """Return how a route is driven from day to day."""
    times, shares = schedule(fleet, route), list[float]()
    departure = times.arrivals[0]
    now, spreads = _begun(fleet, route, departure)
    left = departure
    arrivals = zip(times.arrivals, [0.0, *spreads], times.begins, strict=True)
    spans = _spans(fleet, route, times)
    for (arrival, spread, begin), (opens, latest) in zip(arrivals, spans, strict=True):
        now, left = now.after(arrival - left, spread), begin
        if latest < inf:
            shares.append(now.share_until(latest))
        now = now.from_on(opens)
    return _Driven(tuple(shares), now.after(times.end - left - departure))


def _begun(fleet: Fleet, route: Route, departure: float) -> tuple[Any, Sequence[Any]]:
    """Return when a route begins, and by what each of its legs spreads, as `after` takes it."""
    rules = fleet.rules
    assert rules.clock is not None
    means = legs(fleet, route, rules.clock)
    if fleet.sampled is None:
        assert rules.spread is not None
        return Normal(departure, 0.0), [(rules.spread * leg) ** 2 for leg in means]
    speed, path = rules.speed(route.vehicle, rules.clock), path_of(rules, route)
    pairs = zip(pairwise(path), means, strict=True)
    apart = [fleet.sampled[:, a, b] / speed - mean for (a, b), mean in pairs]
    return Sampled(np.full(len(fleet.sampled), departure)), apart


def _spans(fleet: Fleet, route: Route, times: Schedule) -> Iterator[tuple[float, float]]:
    """Yield when each stop of a route opens, and the latest time for its visit."""
    rules = fleet.rules
    for place, stop in enumerate(path_of(rules, route)):
        if stop in rules.depots:
            arrival, begin = times.arrivals[place], times.begins[place]
            yield begin if begin > arrival else -inf, inf
            continue
        visit = rules.visits[stop]
        opens, closes = visit.windows[times.windows[place]]
        yield opens if opens > times.arrivals[0] else -inf, min(closes, visit.due)
