"""How surely a route is on time, and how long it takes from day to day, by the words of the guide.

Its vehicle leaves as planned, and visits begin in the windows that are planned.
"""

from collections.abc import Iterator, Sequence
from math import erfc, exp, inf, pi, sqrt
from statistics import NormalDist
from typing import Any, NamedTuple

from tests.fuzz.fleets_judged.timeline import Json, Timeline, is_later


class Taken(NamedTuple):
    """How often visits are on time, and how long a route takes: by its mean, or on each day."""

    shares: list[float]  # of days on which each visit with a latest time is on time
    mean: float
    variance: float = 0.0
    days: tuple[float, ...] = ()


class Driven(NamedTuple):
    """A route as it is planned."""

    stops: Sequence[Json | None]  # on its path; None is a place where it starts, ends or loads
    times: Timeline
    legs: Sequence[float]


def taken(driven: Driven, spread: float) -> Taken:
    """Return how a route goes whose legs deviate by a share of what they take, normally."""
    times, shares = driven.times, list[float]()
    mean, variance, left = times.departure, 0.0, times.departure
    legs = zip([0.0, *driven.legs], times.arrivals, times.begins, _spans(driven), strict=True)
    for leg, arrival, begin, (opens, latest) in legs:
        mean, variance = mean + arrival - left, variance + (spread * leg) ** 2
        if latest < inf:
            shares.append(_share_until(latest, mean, variance))
        mean, variance = _no_sooner(opens, mean, variance)
        left = begin
    return Taken(shares, mean + times.end - left - times.departure, variance)


def taken_on_days(driven: Driven, days: Sequence[Sequence[float]]) -> Taken:
    """Return how a route goes on each of some days, given what its legs take on each."""
    found, kept = list[float](), list[list[bool]]()
    for legs in days:
        times = driven.times
        now, left, on_time = times.departure, times.departure, list[bool]()
        planned = [0.0, *driven.legs], times.arrivals, times.begins, _spans(driven)
        pairs = zip(*planned, [0.0, *legs], strict=True)
        for leg, arrival, begin, (opens, latest), on_day in pairs:
            now += arrival - left + on_day - leg
            if latest < inf:
                on_time.append(not is_later(now, latest))
            now, left = max(now, opens), begin
        found.append(now + times.end - left - times.departure)
        kept.append(on_time)
    shares = [sum(each) / len(days) for each in zip(*kept, strict=True)]
    return Taken(shares, sum(found) / len(days), days=tuple(found))


def percentile(routes: Sequence[Taken], percent: int) -> float:
    """Return what routes do not exceed, all together, on so many days of a hundred."""
    daily = sorted(map(sum, zip(*(each.days for each in routes if each.days), strict=True)))
    if daily:
        reached = (
            most for number, most in enumerate(daily, 1) if 100 * number >= percent * len(daily)
        )
        return float(next(reached))
    deviation = sqrt(sum(each.variance for each in routes))
    return sum(each.mean for each in routes) + NormalDist().inv_cdf(percent / 100) * deviation


def with_means(item: Any) -> Any:
    """Return costs of several days that have their mean as a `matrix`."""
    if not isinstance(item, dict) or "days" not in item:
        return item
    by_pair = zip(*(each["matrix"] for each in item["days"]), strict=True)
    return {
        **item,
        "matrix": [[_mean(pair) for pair in zip(*rows, strict=True)] for rows in by_pair],
    }


def _mean(costs: tuple[float | None, ...]) -> float | None:
    known = [each for each in costs if each is not None]
    return sum(known) / len(costs) if len(known) == len(costs) else None


def _spans(driven: Driven) -> Iterator[tuple[float, float]]:
    """Yield from when on each visit waits to begin, and until when it begins on time."""
    times = driven.times
    for stop, arrival, begin in zip(driven.stops, times.arrivals, times.begins, strict=True):
        if stop is None:
            yield begin if begin > arrival else -inf, inf
            continue
        one = [stop["window"]] if stop.get("window") else []
        windows = stop.get("windows") or one or [(-inf, inf)]
        opens, closes = next(each for each in windows if not is_later(begin, each[1]))
        due = stop.get("due", inf)
        latest = due[1] if isinstance(due, list) else due
        yield opens if opens > times.departure else -inf, min(closes, latest)


def _share_until(latest: float, mean: float, variance: float) -> float:
    if not variance:
        return float(not is_later(mean, latest))
    return erfc((mean - latest) / sqrt(2 * variance)) / 2


def _no_sooner(opens: float, mean: float, variance: float) -> tuple[float, float]:
    """Return the mean and the variance of the later one of a normal time and a fixed one."""
    if not variance or opens == -inf:
        return max(mean, opens), variance
    deviation = sqrt(variance)
    z = (mean - opens) / deviation
    above, density = erfc(-z / sqrt(2)) / 2, exp(-z * z / 2) / sqrt(2 * pi)
    first = deviation * (z * above + density)  # how much later than the fixed time, on average
    second = variance * ((z * z + 1) * above + z * density)
    return opens + first, max(0.0, second - first**2)
