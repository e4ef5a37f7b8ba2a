"""Punctuality: how surely a plan is on time, where the times of legs spread from day to day.

Legs are independent of each other, and a vehicle leaves as planned. When a visit begins is taken to
be normal, with the mean and the variance that legs and waiting leave (Clark, 1961, has those of the
later of two times). Breaks and what a leg takes at its time of day are as planned.
"""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from math import inf, sqrt
from statistics import NormalDist
from typing import NamedTuple

from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.schedule import REMEMBERED, legs, schedule
from service.fleet.times import Schedule

_NINE_IN_TEN = 90
_STANDARD = NormalDist()


class Normal(NamedTuple):
    """A time that differs from day to day."""

    mean: float
    variance: float

    def after(self, time: float, variance: float) -> "Normal":
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


class _Driven(NamedTuple):
    """A route, as it is driven from day to day."""

    on_time: tuple[float, ...]  # for each visit with a latest time, the share of days it is kept
    duration: Normal


def punctuality(fleet: Fleet, plan: Plan) -> dict[str, float]:
    """Return the measures of a plan whose times spread, by name; nothing if they do not.

    - `on_time`: the mean share of days on which a visit begins in its window and before it is due,
      over the visits that have either; not there if none has
    - `duration`, `duration_p90`: how long all routes take together on average, and what they do not
      exceed on nine days of ten
    """
    if fleet.rules.spread is None:
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


def duration_of(fleet: Fleet, route: Route) -> Normal:
    """Return how long a route takes."""
    return _driven(fleet, route).duration


def longest_duration(fleet: Fleet, routes: Sequence[Route], percent: int) -> float:
    """Return what routes do not exceed, all together, on so many days of a hundred."""
    durations = [duration_of(fleet, route) for route in routes]
    variance = sum(each.variance for each in durations)
    return sum(each.mean for each in durations) + deviations_of(percent) * sqrt(variance)


def deviations_of(percent: int) -> float:
    """Return how many deviations above its mean a time is that so many days do not exceed."""
    return _STANDARD.inv_cdf(percent / 100)


@lru_cache(REMEMBERED)
def _driven(fleet: Fleet, route: Route) -> _Driven:
    """Return how a route is driven from day to day."""
    rules = fleet.rules
    assert rules.clock is not None
    assert rules.spread is not None
    times, shares = schedule(fleet, route), list[float]()
    variances = [(rules.spread * leg) ** 2 for leg in legs(fleet, route, rules.clock)]
    departure = times.arrivals[0]
    now, left = Normal(departure, 0.0), departure
    arrivals = zip(times.arrivals, [0.0, *variances], times.begins, strict=True)
    spans = _spans(fleet, route, times)
    for (arrival, variance, begin), (opens, latest) in zip(arrivals, spans, strict=True):
        now, left = now.after(arrival - left, variance), begin
        if latest < inf:
            shares.append(now.share_until(latest))
        now = now.from_on(opens)
    now = now.after(times.end - left - departure, 0.0)
    return _Driven(tuple(shares), now)


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
