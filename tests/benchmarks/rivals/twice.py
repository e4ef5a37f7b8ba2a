"""Both ends of distance against vehicles, of a solver that knows one cost at a time."""

from collections.abc import Callable

import numpy as np

from service.fleet.fleet import Fleet
from service.fleet.plans import Plan

_LEGS_OF_VEHICLE = 20  # the longest legs that a vehicle costs where there should be few
Solve = Callable[[Fleet, float, float], Plan | None]  # with a cost of a vehicle, in seconds


def cheapest_twice(solve: Solve, fleet: Fleet, seconds: float) -> list[Plan]:
    """Return the plans that are found where vehicles cost nothing, and where they cost much."""
    much = _LEGS_OF_VEHICLE * float(np.max(fleet.matrices()[0]))
    plans = (solve(fleet, cost, seconds) for cost in (0.0, much))
    return [plan for plan in plans if plan is not None]
