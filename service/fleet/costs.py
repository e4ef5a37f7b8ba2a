"""The costs of the legs of a fleet, checked: a leg that is forbidden is so in both costs."""

from dataclasses import replace
from math import inf

import numpy as np
from numpy.typing import NDArray

from service.day.costs import CostsOfDay

Array = NDArray[np.float64]
Day = tuple[CostsOfDay, CostsOfDay]  # both costs over the day


def checked(costs: Array) -> Array:
    """Return costs with a diagonal of 0, and with legs that are forbidden in both."""
    checked = np.where(np.eye(costs.shape[-1], dtype=np.bool_), 0.0, costs)
    if not (checked >= 0).all():
        raise ValueError("costs must be numbers and not negative")
    checked[:, np.isinf(checked).any(axis=0)] = inf
    checked.flags.writeable = False
    return checked


def on_days(times: Array, n: int) -> Array:
    """Return the times of the legs on each of d days, shape (d, n, n), with a diagonal of 0."""
    if times.ndim != 3 or times.shape[1:] != (n, n):
        raise ValueError(f"the times of days must have shape (d, {n}, {n}), got {times.shape}")
    return np.where(np.eye(n, dtype=np.bool_), 0.0, times)


def allowed(day: Day, forbidden: NDArray[np.bool_]) -> Day:
    """Return costs without the cost of a leg from a stop to itself, and some legs forbidden."""
    still = np.eye(len(forbidden), dtype=np.bool_)

    def of_one(costs: CostsOfDay) -> CostsOfDay:
        matrices = np.where(still, 0.0, np.where(forbidden, inf, costs.matrices))
        if not (matrices >= 0).all():
            raise ValueError("costs must be numbers and not negative")
        pairs = None if costs.pairs is None else costs.pairs.without(still | forbidden)
        return replace(costs, matrices=matrices, pairs=pairs)

    first, second = day
    return of_one(first), of_one(second)
