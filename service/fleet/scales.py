"""The whole numbers that PyVRP computes with: how finely costs and times are scaled to them."""

import math
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from service.errors import Refusal
from service.fleet.fleet import Array, Fleet, VehicleType, Visit
from service.instance import OBJECTIVES

_LARGEST = 2.0**61  # that a penalty for all routes together may be: PyVRP's integers have 64 bits
_COARSEST = 1000  # units of the longest leg, at least
_ROUNDING = 1e-12  # relative, of what a float has too much or too little
STEEPEST = 1000  # weight of one of two sums, with 1 of the other
_HARDEST = 10  # costs of the longest leg, for one unit over a limit or a capacity
_TINY = 2.0**-900  # of the longest leg: the power of ten that scales a much shorter one is infinite


def round_up(scaled: Array | float) -> Array:
    """Return scaled numbers rounded up, but for what is whole up to errors of rounding."""
    return np.ceil(np.multiply(scaled, 1 - _ROUNDING))


def round_down(scaled: float) -> float:
    """Return a scaled number rounded down, in the same way."""
    return float(np.floor(scaled * (1 + _ROUNDING)))


@dataclass(frozen=True)
class Horizon:
    """The times between which all routes can be: no vehicle need leave before, or be back later."""

    begin: float = 0.0
    end: float = 0.0

    @classmethod
    def of(cls, fleet: Fleet) -> "Horizon":
        """Return the horizon of a fleet; of one without a clock no time at all."""
        rules = fleet.rules
        if rules.clock is None:
            return cls()
        route = _longest_route(fleet, rules.clock)
        spans = [visit.window for visit in rules.visits]
        shifts = [vehicle.shift for vehicle in rules.vehicles]
        bounds = [time for span in (*spans, *shifts) for time in span if 0 < time < inf]
        first = min(bounds, default=0.0) - route
        begin = max(0.0, first, min(begin for begin, _ in shifts))
        latest = max(begin for begin, _ in (*spans, *shifts))
        return cls(begin, max(begin, latest) + 2 * route)


def _longest_route(fleet: Fleet, objective: int) -> float:
    """Return a bound on the length of a route without waiting."""
    timed = objective == fleet.rules.clock
    services = sum(visit.service for visit in fleet.rules.visits) if timed else 0.0
    return float(fleet.bounded_costs[objective].max(axis=1).sum()) + services


@dataclass(frozen=True, eq=False)
class Units:
    """A fleet in units in which no objective has tiny costs alone.

    Args:
        fleet: The fleet in these units.
        shifts: The powers of two, shape (2,), by which each objective was multiplied: exactly.
    """

    fleet: Fleet
    shifts: Array

    @classmethod
    def of(cls, fleet: Fleet) -> "Units":
        """Return the units of a fleet, which are its own where costs are not tiny.

        Raises:
            Refusal: In such units a prize or a time would overflow.
        """
        largest = fleet.largest_legs
        tiny = (largest > 0) & (largest < _TINY)
        shifts = np.where(tiny, 1 - np.frexp(largest)[1], 0)
        if not tiny.any():
            return cls(fleet, shifts)
        rules = fleet.rules
        timed = rules.maximum if rules.clock is None else rules.clock
        extra, time = int(shifts[0]), 0 if timed is None else int(shifts[timed])
        scaled = replace(
            rules,
            visits=tuple(_scaled_visit(visit, extra, time) for visit in rules.visits),
            vehicles=tuple(_scaled_vehicle(vehicle, extra, time) for vehicle in rules.vehicles),
        )
        costs = np.ldexp(fleet.costs, shifts[:, np.newaxis, np.newaxis])
        return cls(Fleet(rules=scaled, costs=costs), shifts)

    def points(self, points: Array) -> Array:
        """Return points, shape (..., 2), in these units; infinite where these are too small."""
        with np.errstate(over="ignore"):
            scaled: Array = np.ldexp(points, self.shifts)
        return scaled


def _scaled_visit(visit: Visit, extra: int, time: int) -> Visit:
    """Return a visit whose prize and times are multiplied by powers of two."""
    opens, closes = visit.window
    return replace(
        visit,
        service=_scaled(visit.service, time),
        window=(_scaled(opens, time), _scaled_bound(closes, time)),
        prize=None if visit.prize is None else _scaled(visit.prize, extra),
    )


def _scaled_vehicle(vehicle: VehicleType, extra: int, time: int) -> VehicleType:
    """Return a type of vehicles in the same way."""
    opens, closes = vehicle.shift
    return replace(
        vehicle,
        shift=(_scaled(opens, time), _scaled_bound(closes, time)),
        longest=_scaled_bound(vehicle.longest, time),
        fixed=_scaled(vehicle.fixed, extra),
    )


def _scaled(value: float, shift: int) -> float:
    scaled = _scaled_bound(value, shift)
    if scaled == inf:
        reason = f"costs, prizes and times must not be so far apart as tiny costs and {value:g}"
        raise Refusal("invalid-instance", reason=reason)
    return scaled


def _scaled_bound(value: float, shift: int) -> float:
    """Return an upper bound multiplied by a power of two: none where no double is so large."""
    with np.errstate(over="ignore"):
        return float(np.ldexp(value, shift))


def scales_of(fleet: Fleet, horizon: Horizon) -> tuple[list[float], float]:
    """Return the powers of ten by which costs are multiplied, and the largest penalty.

    A unit over a limit must cost more than a leg, and all that could be over must not overflow.

    Raises:
        Refusal: Times, prizes and costs are too far apart.
    """
    largest = [float(leg) or 1.0 for leg in fleet.largest_legs]
    totals = [_largest_total(fleet, objective, horizon) for objective in range(OBJECTIVES)]
    most = max(1.0, *(total / leg for total, leg in zip(totals, largest, strict=True)))
    # Penalties are multiplied by weights, as costs are.
    heaviest = STEEPEST if fleet.rules.maximum is None else 1
    finest = math.sqrt(_LARGEST / (_HARDEST * heaviest * fleet.rules.n)) / math.sqrt(most)
    if finest < _COARSEST:
        reason = "costs, prizes and times must not be farther apart than {:.1e}, and are {:.1e}"
        allowed = _LARGEST / (_HARDEST * heaviest * fleet.rules.n * _COARSEST**2)
        raise Refusal("invalid-instance", reason=reason.format(allowed, most))
    digits = [math.floor(math.log10(finest) - math.log10(leg)) for leg in largest]
    scales = [float(f"1e{each}") for each in digits]
    return scales, _HARDEST * max(s * leg for s, leg in zip(scales, largest, strict=True))


def _largest_total(fleet: Fleet, objective: int, horizon: Horizon) -> float:
    """Return a bound on lengths of routes, on times, and on what is added to the objective."""
    rules = fleet.rules
    total = _longest_route(fleet, objective)
    if objective == 0:
        total += sum(visit.prize or 0.0 for visit in rules.visits)
        total += max(vehicle.fixed for vehicle in rules.vehicles)
    if objective == rules.clock:
        total += horizon.end - horizon.begin
    return total
