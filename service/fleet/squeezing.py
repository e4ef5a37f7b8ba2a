"""Squeeze huge costs, prizes and fixed costs of a fleet, so that PyVRP's whole numbers hold them.

A huge number says what to avoid or what to do before all else. It does so at any size above what
an ordinary plan costs, so only the gaps between such numbers shrink; their order stays. The search
follows squeezed lengths, and plans are compared by their true ones.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet, Rules
from service.instance import OUTLYING

_LEAST_LEGS = 10  # that an ordinary plan costs, at least
_HIGHEST = 1e4  # squeezed leg, in ordinary ones: more would leave these too few units
_MOST_STEPS = 1000  # different huge numbers whose differences are looked at
_FORBIDDEN = 4.0  # times the highest squeezed leg


@dataclass(frozen=True, eq=False)
class Squeezed:
    """The numbers of a fleet in the order of the true ones, and none of them huge.

    Args:
        legs: The costs, shape (2, n, n); finite where a leg is forbidden, and higher than others.
        largest: The largest leg that plans are made of, in each objective, shape (2,).
        highest: The largest leg that is not forbidden, in each objective, shape (2,); in the first
            the largest prize or fixed cost if that is more.
        prizes: Of each stop, shape (n,); 0 where it has none.
        fixed: The costs of using a vehicle of each type, shape (v,).
        changed: Whether any number was squeezed.
    """

    legs: Array
    largest: Array
    highest: Array
    prizes: Array
    fixed: Array
    changed: bool

    @classmethod
    def of(cls, fleet: Fleet, most_legs: float) -> "Squeezed":
        """Return the squeezed numbers of a fleet.

        Args:
            fleet: The fleet.
            most_legs: What a squeezed leg may cost, in ordinary ones.
        """
        rules = fleet.rules
        prizes = np.array([visit.prize or 0.0 for visit in rules.visits])
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])
        legs, (largest, highest) = np.empty_like(fleet.costs), np.empty((2, len(fleet.costs)))
        changed = False
        for objective, costs in enumerate(fleet.costs):
            ordinary = _ordinary(costs)
            waiting = waiting_of(rules) if objective == rules.clock else 0.0
            extra = np.concatenate((prizes, fixed)) if objective == 0 else np.empty(0)
            numbers = np.concatenate((costs[np.isfinite(costs)], extra))
            of_plan = max(rules.n, _LEAST_LEGS) * ordinary + waiting
            top = max(of_plan, min(_HIGHEST, most_legs) * ordinary)
            scale = _Scale.of(numbers, of_plan, top, 2 * rules.n)
            squeezed = scale(costs)
            forbidden = np.isinf(costs)
            highest[objective] = squeezed.max(where=~forbidden, initial=0.0)
            no_way = _FORBIDDEN * max(of_plan, float(highest[objective]))
            legs[objective] = np.where(forbidden, no_way, squeezed)
            needed = float(scale(fleet.needed_legs[objective]))
            largest[objective] = ordinary if needed <= ordinary else needed + ordinary
            changed = changed or len(scale.huge) > 0
            if objective == 0:
                prizes, fixed = scale(prizes), scale(fixed)
        highest[0] = max(highest[0], prizes.max(), fixed.max())
        return cls(legs, largest, highest, prizes, fixed, changed)


@dataclass(frozen=True, eq=False)
class _Scale:
    """A monotone function that keeps ordinary numbers, and shrinks the gaps between huge ones."""

    huge: Array  # ascending
    squeezed: Array

    @classmethod
    def of(cls, numbers: Array, ordinary: float, top: float, ratio: float) -> "_Scale":
        """Return the scale of numbers, for what an ordinary plan costs.

        The least huge number becomes as much, and the greatest the top at most. The ratio is what
        two neighbouring ones have, at most: a plan with one of the higher then costs more than one
        with any number of the lower.
        """
        huge = np.unique(numbers[numbers > ordinary])
        squeezed = _stepwise(huge[:_MOST_STEPS], ordinary, ratio)
        if len(huge) <= _MOST_STEPS and squeezed.max(initial=0.0) <= top:
            return cls(huge, squeezed)
        ratios = huge / np.concatenate((huge[:1], huge[:-1]))
        steps = np.log(np.minimum(ratios, ratio)).cumsum()
        return cls(huge, ordinary * np.exp(steps * min(1.0, math.log(top / ordinary) / steps[-1])))

    def __call__(self, numbers: Array) -> Array:
        """Return squeezed numbers; infinite ones stay so."""
        if not len(self.huge):
            return np.asarray(numbers)
        places = np.searchsorted(self.huge, numbers).clip(max=len(self.huge) - 1)
        is_huge = (numbers >= self.huge[0]) & np.isfinite(numbers)
        squeezed: Array = np.where(is_huge, self.squeezed[places], numbers)
        return squeezed


def _ordinary(costs: Array) -> float:
    """Return the largest cost of up to a hundred times what the next stop typically costs.

    Not of a typical leg: of two clusters half of all legs may be bridges.
    """
    nearest = np.where(costs > 0, costs, inf).min(axis=1)
    nearest = nearest[np.isfinite(nearest)]
    if not len(nearest):
        return 1.0
    limit = OUTLYING * float(np.median(nearest))
    return float(costs.max(where=costs <= limit, initial=0.0))


def _stepwise(huge: Array, ordinary: float, ratio: float) -> Array:
    """Return squeezed numbers whose small differences are true, and others those of plans."""
    squeezed = [ordinary] * min(1, len(huge))
    for lower, number in pairwise(huge.tolist()):
        last = squeezed[-1]
        step = max(ordinary, last * (min(number / lower, ratio) - 1))
        squeezed.append(last + min(number - lower, step))
    return np.array(squeezed)


def waiting_of(rules: Rules) -> float:
    """Return the time from the first bound of a window or shift to the last begin of one."""
    spans = [*(visit.window for visit in rules.visits), *(each.shift for each in rules.vehicles)]
    bounds = [time for span in spans for time in span if 0 < time < inf]
    return max(0.0, max(begin for begin, _ in spans) - min(bounds, default=0.0))
