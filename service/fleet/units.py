"""Bring the numbers of a fleet into units in which the search can compute with them."""

from dataclasses import dataclass, replace
from math import inf

import numpy as np

from service.errors import InvalidInstance
from service.fleet.fleet import Array, Fleet
from service.fleet.measures.table import MEASURES, OF_TIME
from service.fleet.vehicles import Span

_TINY = 2.0**-900  # a shorter longest leg is multiplied: its square would be 0


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
            InvalidInstance: In these units a prize or a time would overflow.
        """
        largest, rules = fleet.largest_legs, fleet.rules
        tiny = (largest > 0) & (largest < _TINY)
        shifts = np.where(tiny, 1 - np.frexp(largest)[1], 0)
        if not tiny.any():
            return cls(fleet, shifts)
        extra = int(shifts[0])
        time = 0 if rules.limited is None else int(shifts[rules.limited])
        away = int(shifts[1 if rules.clock == 0 else 0])
        visits = tuple(
            replace(
                visit,
                service=_scaled(visit.service, time),
                services=tuple(_scaled(each, time) for each in visit.services),
                windows=tuple(_scaled_span(window, time) for window in visit.windows),
                due=_scaled_bound(visit.due, time),
                wanted=_scaled(visit.wanted, time),
                promised_by=_scaled_bound(visit.promised_by, time),
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
                shortest=_scaled(vehicle.shortest, time),
                max_driving=_scaled_bound(vehicle.max_driving, time),
                max_distance=_scaled_bound(vehicle.max_distance, away),
                fixed=_scaled(vehicle.fixed, extra),
                max_overtime=_scaled(vehicle.max_overtime, time),
                leaves_by=_scaled_bound(vehicle.leaves_by, time),
                per_time=_scaled(vehicle.per_time, extra - time),
                breaks=tuple(
                    (_scaled(opens, time), _scaled(closes, time), _scaled(length, time))
                    for opens, closes, length in vehicle.breaks
                ),
            )
            for vehicle in rules.vehicles
        )
        slack = _scaled(rules.slack, time)
        tolerance = None if rules.tolerance is None else _scaled(rules.tolerance, time)
        gaps = tuple(gap and _scaled(gap, time) for gap in rules.groups.gaps)
        scaled = replace(
            rules,
            visits=visits,
            vehicles=vehicles,
            slack=slack,
            tolerance=tolerance,
            groups=replace(rules.groups, gaps=gaps),
        )
        return cls(fleet.scaled(scaled, shifts), shifts)

    def points(self, points: Array) -> Array:
        """Return points, shape (..., m), in these units; infinite where these are too small."""
        rules = self.fleet.rules
        of_units = {"prizes": 0, "load": 0, **dict.fromkeys(OF_TIME, rules.limited)}
        layers = [
            of_units.get(MEASURES[over].unit) if over in MEASURES else layer
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
        raise InvalidInstance("times-too-far-apart", came=value)
    return scaled


def _scaled_bound(value: float, shift: int) -> float:
    """Return an upper bound multiplied by a power of two; infinite if the result is too large."""
    with np.errstate(over="ignore"):
        return float(np.ldexp(value, shift))
