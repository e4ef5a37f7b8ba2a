"""The whole numbers that PyVRP computes with: how finely costs and times are scaled to them."""

import math
from dataclasses import dataclass
from math import inf

import numpy as np

from service.errors import Refusal
from service.fleet.fleet import Array, Fleet
from service.instance import OBJECTIVES

_LARGEST = 2.0**61  # that a penalty for all routes together may be: PyVRP's integers have 64 bits
_COARSEST = 1000  # units of the longest leg, at least
_ROUNDING = 1e-12  # relative, of what a float has too much or too little
_HARDEST = 10  # costs of the longest leg, for one unit over a limit or a capacity


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
    return float(fleet.costs[objective].max(axis=1).sum()) + services


def scales_of(fleet: Fleet, horizon: Horizon) -> tuple[list[float], float]:
    """Return the powers of ten by which costs are multiplied, and the largest penalty.

    A unit over a limit must cost more than a leg, and all that could be over must not overflow.

    Raises:
        Refusal: Times, prizes and costs are too far apart.
    """
    largest = [float(costs.max(initial=0.0)) or 1.0 for costs in fleet.costs]
    totals = [_largest_total(fleet, objective, horizon) for objective in range(OBJECTIVES)]
    most = max(1.0, *(total / leg for total, leg in zip(totals, largest, strict=True)))
    finest = math.sqrt(_LARGEST / (_HARDEST * fleet.rules.n)) / math.sqrt(most)
    if finest < _COARSEST:
        reason = "costs, prizes and times must not be farther apart than {:.1e}, and are {:.1e}"
        allowed = _LARGEST / (_HARDEST * fleet.rules.n * _COARSEST**2)
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
