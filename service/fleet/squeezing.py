"""Squeeze huge costs, prizes and fixed costs of a fleet, so that PyVRP's whole numbers hold them.

A huge number says what to avoid or what to do before all else. It does so at any size above what
an ordinary plan costs, so only the gaps between such numbers shrink; their order stays. The search
follows squeezed lengths, and plans are compared by their true ones.
"""

from dataclasses import dataclass
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet, Rules

_LEAST_LEGS = 10  # that an ordinary plan costs, at least
_HIGHEST = 1e4  # squeezed leg, in ordinary ones: more would leave these too few units
_FORBIDDEN = 4.0  # times the highest squeezed leg


@dataclass(frozen=True, eq=False)
class Squeezed:
    """The numbers of a fleet in the order of the true ones, and none of them huge.

    Args:
        legs: The costs, shape (2, n, n); finite where a leg is forbidden, and higher than others.
        largest: The largest leg that plans are made of, in each objective, shape (2,).
        prizes: Of each stop, shape (n,); 0 where it has none.
        fixed: The costs of using a vehicle of each type, shape (v,).
        changed: Whether any leg that is not forbidden was squeezed.
    """

    legs: Array
    largest: Array
    prizes: Array
    fixed: Array
    changed: bool

    @classmethod
    def of(cls, fleet: Fleet, most_total: float) -> "Squeezed":
        """Return the squeezed numbers of a fleet.

        Args:
            fleet: The fleet.
            most_total: What the costs of all legs of a plan may be together, in the largest leg.
        """
        rules = fleet.rules
        prizes = np.array([visit.prize or 0.0 for visit in rules.visits])
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])
        legs, largest = np.empty_like(fleet.costs), np.empty(len(fleet.costs))
        changed = False
        for objective, costs in enumerate(fleet.costs):
            ordinary = float(fleet.ordinary_legs[objective]) or 1.0
            waiting = waiting_of(rules) if objective == rules.clock else 0.0
            extra = np.concatenate((prizes, fixed)) if objective == 0 else np.empty(0)
            numbers = np.concatenate((costs[np.isfinite(costs)], extra))
            of_plan = max(rules.n, _LEAST_LEGS) * ordinary + waiting
            scale = _Scale.of(numbers, of_plan, 2 * rules.n)
            most = min(_HIGHEST, most_total / (2 * rules.n * _FORBIDDEN))
            top = max(of_plan, most * ordinary)
            squeezed = np.minimum(scale(costs), top)
            forbidden = np.isinf(costs)
            changed = changed or bool((squeezed < costs)[~forbidden].any())
            highest = squeezed.max(where=~forbidden, initial=of_plan)
            legs[objective] = np.where(forbidden, _FORBIDDEN * highest, squeezed)
            needed = min(float(scale(fleet.needed_legs[objective])), top)
            largest[objective] = ordinary if needed <= ordinary else needed + ordinary
            if objective == 0:
                prizes, fixed = scale(prizes), scale(fixed)
        return cls(legs, largest, prizes, fixed, changed)


@dataclass(frozen=True, eq=False)
class _Scale:
    """A monotone function that keeps ordinary numbers, and shrinks the gaps between huge ones."""

    huge: Array  # ascending
    squeezed: Array

    @classmethod
    def of(cls, numbers: Array, ordinary: float, ratio: float) -> "_Scale":
        """Return the scale of numbers, for what an ordinary plan costs.

        The least huge number becomes as much. The ratio is what two neighbouring ones may have, at
        most: a plan with one of the higher then costs more than one with any number of the lower.
        """
        huge = np.unique(numbers[numbers > ordinary])
        ratios = huge / np.concatenate((huge[:1], huge[:-1]))
        with np.errstate(over="ignore"):
            return cls(huge, ordinary * np.minimum(ratios, ratio).cumprod())

    def __call__(self, numbers: Array) -> Array:
        """Return squeezed numbers; infinite ones stay so."""
        if not len(self.huge):
            return np.asarray(numbers)
        places = np.searchsorted(self.huge, numbers).clip(max=len(self.huge) - 1)
        is_huge = (numbers >= self.huge[0]) & np.isfinite(numbers)
        squeezed: Array = np.where(is_huge, self.squeezed[places], numbers)
        return squeezed


def waiting_of(rules: Rules) -> float:
    """Return the time from the first bound of a window or shift to the last begin of one."""
    spans = [*(visit.window for visit in rules.visits), *(each.shift for each in rules.vehicles)]
    bounds = [time for span in spans for time in span if 0 < time < inf]
    return max(0.0, max(begin for begin, _ in spans) - min(bounds, default=0.0))
