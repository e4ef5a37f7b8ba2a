"""Squeeze and scale the numbers of a fleet to the whole numbers with which PyVRP computes."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf

import numpy as np

from service.errors import Refusal
from service.fleet.fleet import LAYERS, Array, Fleet
from service.fleet.loads import loads_of
from service.fleet.rules import Rules
from service.fleet.vehicles import Span
from service.instance import OUTLYING

_LARGEST = 2.0**61  # the largest penalty of all routes together: PyVRP's integers have 64 bits
UNBOUNDED = 2**44  # more than every route
_COARSEST = 1000  # the least units of the longest leg
_FINEST = 1e6  # the most units of the longest leg without limits: more would not help
_FINE = 1e4  # the least units of an ordinary leg beside squeezed legs
_ROUNDING = 1e-12  # relative error of a float
STEEPEST = 1000  # weight of one of two sums if the other has weight 1
_HARDEST = 10  # the penalty for one unit over a limit or capacity, in longest legs
_LEAST_LEGS = 10  # the least legs that an ordinary plan costs
_HIGHEST = 1e4  # the most ordinary legs that a squeezed leg costs: more would leave these few units
_MOST_STEPS = 1000  # the most huge numbers whose differences are kept
_FORBIDDEN = 4.0  # cost of a forbidden leg, in highest squeezed legs
_TINY = 2.0**-900  # the power of ten that scales a shorter longest leg would be infinite


def round_up(scaled: Array | float) -> Array:
    """Return scaled numbers rounded up, unless they are whole up to rounding errors."""
    return np.ceil(np.multiply(scaled, 1 - _ROUNDING))


def round_down(scaled: float) -> float:
    """Return a scaled number rounded down, in the same way."""
    return float(np.floor(scaled * (1 + _ROUNDING)))


@dataclass(frozen=True)
class Horizon:
    """Two times: no vehicle needs to leave before the first or return after the second."""

    begin: float = 0.0
    end: float = 0.0

    @classmethod
    def of(cls, rules: Rules, leg: float) -> "Horizon":
        """Return the horizon of a fleet whose legs are at most this long.

        Without a clock it is empty.
        """
        if rules.clock is None:
            return cls()
        route = rules.n * leg + _services(rules)
        first, last = _first_and_last(rules)
        begin = max(0.0, first - route, min(vehicle.shift[0] for vehicle in rules.vehicles))
        return cls(begin, max(begin, last) + 2 * route)


@dataclass(frozen=True, eq=False)
class Units:
    """A fleet in units in which no objective has only tiny costs.

    Args:
        fleet: The fleet in these units.
        shifts: The powers of two, shape (2,), by which both costs were multiplied: exactly.
    """

    fleet: Fleet
    shifts: Array

    @classmethod
    def of(cls, fleet: Fleet) -> "Units":
        """Return the units of a fleet. They are its own units if costs are not tiny.

        Raises:
            Refusal: In these units a prize or a time would overflow.
        """
        largest, rules = fleet.largest_legs, fleet.rules
        tiny = (largest > 0) & (largest < _TINY)
        shifts = np.where(tiny, 1 - np.frexp(largest)[1], 0)
        if not tiny.any():
            return cls(fleet, shifts)
        extra = int(shifts[0])
        time = 0 if rules.limited is None else int(shifts[rules.limited])
        visits = tuple(
            replace(
                visit,
                service=_scaled(visit.service, time),
                windows=tuple(_scaled_span(window, time) for window in visit.windows),
                due=_scaled_bound(visit.due, time),
                release=_scaled(visit.release, time),
                prize=None if visit.prize is None else _scaled(visit.prize, extra),
            )
            for visit in rules.visits
        )
        vehicles = tuple(
            replace(
                vehicle,
                shift=_scaled_span(vehicle.shift, time),
                longest=_scaled_bound(vehicle.longest, time),
                fixed=_scaled(vehicle.fixed, extra),
                max_overtime=_scaled(vehicle.max_overtime, time),
                leaves_by=_scaled_bound(vehicle.leaves_by, time),
                breaks=tuple(
                    (_scaled(opens, time), _scaled(closes, time), _scaled(length, time))
                    for opens, closes, length in vehicle.breaks
                ),
            )
            for vehicle in rules.vehicles
        )
        costs = np.ldexp(fleet.costs, shifts[:, np.newaxis, np.newaxis])
        scaled = replace(rules, visits=visits, vehicles=vehicles)
        return cls(Fleet(rules=scaled, costs=costs), shifts)

    def points(self, points: Array) -> Array:
        """Return points, shape (..., m), in these units; infinite where these are too small."""
        rules = self.fleet.rules
        numbers = {"vehicles": None, "unassigned": 0, "load_distance": 0}
        timed = dict.fromkeys(("overtime", "lateness", "imbalance"), rules.limited)
        layers = [
            {**numbers, **timed}.get(over, layer)
            for over, layer in zip(rules.over, rules.layers, strict=True)
        ]
        shifts = [0 if layer is None else self.shifts[layer] for layer in layers]
        with np.errstate(over="ignore"):
            scaled: Array = np.ldexp(points, shifts)
        return scaled


def _scaled_span(span: Span, shift: int) -> Span:
    return _scaled(span[0], shift), _scaled_bound(span[1], shift)


def _scaled(value: float, shift: int) -> float:
    scaled = _scaled_bound(value, shift)
    if scaled == inf:
        reason = f"costs, prizes and times are too far apart: costs are tiny, and one is {value:g}"
        raise Refusal("invalid-instance", reason=reason)
    return scaled


def _scaled_bound(value: float, shift: int) -> float:
    """Return an upper bound multiplied by a power of two; infinite if the result is too large."""
    with np.errstate(over="ignore"):
        return float(np.ldexp(value, shift))


@dataclass(frozen=True, eq=False)
class Squeezed:
    """The numbers of a fleet, none of them huge, in the same order as the true numbers.

    A huge number means: avoid this, or do this before everything else. Any number above the cost of
    an ordinary plan has this effect. So the gaps between such numbers may shrink, but their order
    stays. The search uses squeezed lengths; plans are compared by their true lengths.

    Args:
        legs: The costs, shape (2, n, n). Forbidden legs have finite costs, higher than all others.
        largest: The largest leg of ordinary plans, of both costs, shape (2,).
        highest: The largest allowed leg, of both costs, shape (2,); of the first costs, the largest
            prize or fixed cost if that is more.
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
    def of(cls, fleet: Fleet) -> "Squeezed":
        """Return the numbers of a fleet."""
        rules = fleet.rules
        prizes = np.array([visit.prize or 0.0 for visit in rules.visits])
        fixed = np.array([vehicle.fixed for vehicle in rules.vehicles])
        legs, (largest, highest) = np.empty_like(fleet.costs), np.empty((2, LAYERS))
        changed = False
        for layer, costs in enumerate(fleet.costs):
            ordinary = _ordinary(costs)
            waiting = _waiting(rules) if layer == rules.clock else 0.0
            extra = np.concatenate((prizes, fixed)) if layer == 0 else np.empty(0)
            numbers = np.concatenate((costs[np.isfinite(costs)], extra))
            of_plan = max(rules.n, _LEAST_LEGS) * ordinary + waiting
            top = max(of_plan, min(_HIGHEST, _most_legs(rules)) * ordinary)
            scale = _Scale.of(numbers, of_plan, top, 2 * rules.n)
            squeezed = scale(costs)
            forbidden = np.isinf(costs)
            highest[layer] = squeezed.max(where=~forbidden, initial=0.0)
            no_way = _FORBIDDEN * max(of_plan, float(highest[layer]))
            legs[layer] = np.where(forbidden, no_way, squeezed)
            needed = float(scale(fleet.needed_legs[layer]))
            largest[layer] = ordinary if needed <= ordinary else needed + ordinary
            changed = changed or len(scale.huge) > 0
            if layer == 0:
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
    other. Legs that are too short to be scaled count as the shortest that can be.
    """
    nearest = np.where(costs > 0, costs, inf).min(axis=1)
    nearest = nearest[np.isfinite(nearest)]
    if not len(nearest):
        return 1.0
    limit = OUTLYING * float(np.median(nearest))
    return max(_TINY, float(costs.max(where=costs <= limit, initial=0.0)))


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
    first, last = _first_and_last(rules)
    return max(0.0, last - first)


def _first_and_last(rules: Rules) -> tuple[float, float]:
    """Return the first bound above 0 of any window or shift, and the last begin; 0 without."""
    bounds = [time for span in rules.spans for time in span if 0 < time < inf]
    return min(bounds, default=0.0), max((begin for begin, _ in rules.spans), default=0.0)


def _most_legs(rules: Rules) -> float:
    """Return how many ordinary legs a squeezed leg may cost, so that these have enough units."""
    room = _LARGEST / (8 * rules.n * _heaviest(rules) * _FINE**2)
    return math.sqrt(room / 2) if rules.limits_routes else room / _HARDEST


@dataclass(frozen=True)
class Penalties:
    """PyVRP's greatest penalties for one unit over a capacity, and for one over a limit."""

    load: float
    limit: float


def scales_of(fleet: Fleet, squeezed: Squeezed, horizon: Horizon) -> tuple[list[float], Penalties]:
    """Return the powers of ten by which costs are multiplied, and the largest penalties.

    A unit over a capacity must cost more than any allowed leg; so must a unit over a limit if
    limits are swept. The penalty of the largest possible excess must not overflow.

    Raises:
        Refusal: Times and costs are too far apart.
    """
    totals = [_largest_total(fleet, squeezed, layer, horizon) for layer in range(LAYERS)]
    largest = squeezed.largest.tolist()
    most = max(1.0, *(total / leg for total, leg in zip(totals, largest, strict=True)))
    heaviest = _heaviest(fleet.rules)
    highest = max(_HARDEST, 2 * float((squeezed.highest / squeezed.largest).max()))
    hardest = highest if fleet.rules.limits_routes else _HARDEST
    finest = min(_FINEST, UNBOUNDED / (2 * most))
    if fleet.rules.has_bounds or fleet.rules.limits_routes:
        finest = math.sqrt(_LARGEST / (hardest * heaviest)) / math.sqrt(most)
    if finest < _COARSEST:
        reason = "times must be at most {:.1e} costs of a leg apart, got {:.1e}"
        allowed = _LARGEST / (hardest * heaviest * _COARSEST**2)
        raise Refusal("invalid-instance", reason=reason.format(allowed, most))
    digits = [math.floor(math.log10(finest) - math.log10(leg)) for leg in largest]
    scales = [float(f"1e{each}") for each in digits]
    leg = max(scale * leg for scale, leg in zip(scales, largest, strict=True))
    largest_load = int(loads_of(fleet.rules).demand.sum(axis=0).max(initial=1))
    most_load = _LARGEST / (heaviest * largest_load)
    return scales, Penalties(load=min(highest * leg, most_load), limit=hardest * leg)


def _heaviest(rules: Rules) -> int:
    """Return the largest weight of a goal. Weights multiply penalties as they multiply costs."""
    return STEEPEST if rules.weighs else 1


def _largest_total(fleet: Fleet, squeezed: Squeezed, layer: int, horizon: Horizon) -> float:
    """Return a bound on the total length of all routes of a plan, with their possible lateness.

    One leg leads to each visit, and the last leg of a route leads away from one. At each visit a
    route can be late by at most the horizon.
    """
    legs = squeezed.legs[layer]
    total = float(legs.max(axis=0).sum() + legs.max(axis=1).sum())
    if layer == fleet.rules.clock:
        total += _services(fleet.rules) + fleet.rules.n * (horizon.end - horizon.begin)
    return total


def _services(rules: Rules) -> float:
    return sum(visit.service for visit in rules.visits)
