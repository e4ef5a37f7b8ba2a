"""The spread of costs around their means, and the lengths of tours on most days.

Either legs are independent of each other, so that their variances add up along a tour, whose length
is taken to be normal; or the costs of whole days are given, and each tour is driven on each day.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Steps = NDArray[np.integer]
NINE_IN_TEN = 90


@dataclass(frozen=True, eq=False)
class Spread:
    """How the costs of an objective spread.

    Args:
        factor: The deviation of each leg, as a share of its mean cost; None if it is not that.
        deviations: The deviations, shape (n, n); None if they are not given.
        days: The costs of each day, shape (d, n, n); None if they are not given.
        percent: The length of a tour is what so many days of a hundred do not exceed; None for the
            mean.
    """

    factor: float | None = None
    deviations: Array | None = None
    days: Array | None = None
    percent: int | None = None


def percentiles(spreads: Sequence[Spread | None]) -> int:
    """Return the number of percentiles: for each a search has one objective more."""
    return sum(each is not None and each.percent is not None for each in spreads)


def addends(spread: Spread, means: Array) -> Array:
    """Return costs whose sum along a tour is the variance of its length, shape (n, n).

    Of given days it is about that: each leg then has its own variance, and its covariance with all
    other legs of a tour, which are taken to be the mean of all legs of the day.

    Args:
        means: The mean costs, shape (n, n), infinite for forbidden legs.
    """
    if spread.days is None:
        found = np.square(_deviations(spread, means))
    else:
        n = len(means)
        legs = ~np.eye(n, dtype=np.bool_) & np.isfinite(means)
        apart = np.where(legs, spread.days, 0.0) - np.where(legs, means, 0.0)
        levels = apart.sum(axis=(1, 2)) / max(1, legs.sum())
        shared = (apart * levels[:, np.newaxis, np.newaxis]).mean(axis=0)
        found = np.maximum(0.0, np.square(apart).mean(axis=0) + (n - 1) * shared)
    return np.where(np.isinf(means), np.inf, found)


def lengths_at(spread: Spread, means: Array, steps: tuple[Steps, Steps], percent: int) -> Array:
    """Return what the lengths of tours do not exceed on so many days of a hundred, shape (k,).

    Args:
        means: The mean costs, shape (n, n).
        steps: Where the steps of each tour begin and end, shape (k, s) both.
        percent: From 50 on.
    """
    if spread.days is None:
        variances = np.square(_deviations(spread, means)[steps])
        return at_percent(means[steps].sum(axis=1), variances.sum(axis=1), percent)
    daily = np.sort([day[steps].sum(axis=1) for day in spread.days], axis=0)
    return daily[max(1, ceil(percent * len(daily) / 100)) - 1]


def at_percent(means: Array, variances: Array, percent: int) -> Array:
    """Return what normal lengths do not exceed on so many days of a hundred."""
    return means + NormalDist().inv_cdf(percent / 100) * np.sqrt(variances)


def _deviations(spread: Spread, means: Array) -> Array:
    if spread.deviations is not None:
        return spread.deviations
    return means * (spread.factor or 0.0)
