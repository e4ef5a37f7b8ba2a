"""Squeeze huge costs, prizes and fixed costs of a fleet, so that PyVRP's whole numbers hold them.

A huge number means: avoid this, or do this before everything else. Any number above the cost of an
ordinary plan has this effect. So the gaps between such numbers may shrink, but their order stays.
The search follows squeezed lengths; plans are compared by their true lengths.
"""

import math
from dataclasses import dataclass
from itertools import pairwise
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet, Rules
from service.instance import OUTLYING

_LEAST_LEGS = 10  # the least legs that an ordinary plan costs
_HIGHEST = 1e4  # a squeezed leg, in ordinary legs: more would leave these too few units
_MOST_STEPS = 1000  # the most huge numbers whose differences are kept
_FORBIDDEN = 4.0  # cost of a forbidden leg, in highest squeezed legs


@dataclass(frozen=True, eq=False)
class Squeezed:
    """The numbers of a fleet, none of them huge, in the same order as the true numbers.

    Args:
        legs: The costs, shape (2, n, n). Forbidden legs have finite costs, higher than all others.
        largest: The largest leg of ordinary plans, in each objective, shape (2,).
        highest: The largest allowed leg, in each objective, shape (2,); in the first objective, the
            largest prize or fixed cost if that is more.
        prizes: The prize of each stop, shape (n,); 0 if it has none.
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
            most_legs: The most ordinary legs that a squeezed leg may cost.
        """
        rules = fleet.rules
        prizes = np.array([visit.prize or 0.0 for visit in rules.visits])
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])
        legs, (largest, highest) = np.empty_like(fleet.costs), np.empty((2, len(fleet.costs)))
        changed = False
        for objective, costs in enumerate(fleet.costs):
            ordinary = _ordinary(costs)
            waiting = _waiting(rules) if objective == rules.clock else 0.0
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
        """Return the scale of numbers, given the cost of an ordinary plan.

        The least huge number becomes the cost of an ordinary plan, and the greatest one at most
        `top`. Neighbours keep their ratio, but at most `ratio`. With that a plan with one of the
        higher number costs more than a plan with several of the lower.
        """
        huge = np.unique(numbers[numbers > ordinary])
        squeezed = _stepwise(huge[:_MOST_STEPS], ordinary, ratio)
        if len(huge) <= _MOST_STEPS and squeezed.max(initial=0.0) <= top:
            return cls(huge, squeezed)
        ratios = huge / np.concatenate((huge[:1], huge[:-1]))
        steps = np.log(np.minimum(ratios, ratio)).cumsum()
        return cls(huge, ordinary * np.exp(steps * min(1.0, math.log(top / ordinary) / steps[-1])))

    def __call__(self, numbers: Array) -> Array:
        """Return squeezed numbers; infinite ones stay infinite."""
        if not len(self.huge):
            return np.asarray(numbers)
        places = np.searchsorted(self.huge, numbers).clip(max=len(self.huge) - 1)
        is_huge = (numbers >= self.huge[0]) & np.isfinite(numbers)
        squeezed: Array = np.where(is_huge, self.squeezed[places], numbers)
        return squeezed


def _ordinary(costs: Array) -> float:
    """Return the largest cost that is at most a hundred times the typical cost to the nearest stop.

    A typical leg is not the measure: with two clusters, half of all legs lead from one to the
    other.
    """
    nearest = np.where(costs > 0, costs, inf).min(axis=1)
    nearest = nearest[np.isfinite(nearest)]
    if not len(nearest):
        return 1.0
    limit = OUTLYING * float(np.median(nearest))
    return float(costs.max(where=costs <= limit, initial=0.0))


def _stepwise(huge: Array, ordinary: float, ratio: float) -> Array:
    """Return squeezed numbers: small differences are kept, and large ones become those of plans."""
    squeezed = [ordinary] * min(1, len(huge))
    for lower, number in pairwise(huge.tolist()):
        last = squeezed[-1]
        step = max(ordinary, last * (min(number / lower, ratio) - 1))
        squeezed.append(last + min(number - lower, step))
    return np.array(squeezed)


def _waiting(rules: Rules) -> float:
    """Return the time from the first bound of any window or shift to the last begin."""
    bounds = [time for span in rules.spans for time in span if 0 < time < inf]
    last = max((begin for begin, _ in rules.spans), default=0.0)
    return max(0.0, last - min(bounds, default=0.0))
