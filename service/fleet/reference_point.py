"""The default reference point of a fleet: lengths above those of sensible plans."""

from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet, urgency_of
from service.fleet.measures.punctuality import deviations_of
from service.fleet.measures.table import MEASURES, OF_TIME
from service.fleet.rules import Rules

_TIMED = {name for name, each in MEASURES.items() if each.unit in OF_TIME}
_TIMED -= {"overtime", "weighted_arrival"}  # the most of either is known from other data


def default_reference_point(fleet: Fleet) -> Array:
    """Return lengths above those of sensible plans under m objectives, shape (m,).

    They are the number of stops times the scale, plus what else can add to a length. In the first
    objective these are all prizes and fixed costs. In objectives of the clock, and in measures that
    are times, they are all services, and the time from the first shift or window to the end of the
    last, in which a vehicle may wait: once, or for each vehicle if times are summed. Of weighted
    arrivals each may be as late. Of percentiles all legs are as long as on such a day. The first
    one is at the highest prices, and visits take as long as by the slowest vehicles.
    """
    rules = fleet.rules
    point = rules.n * fleet.scale
    prizes = sum(visit.prize or 0.0 for visit in rules.visits)
    point[0] += 0.0 if "unassigned" in rules.over else prizes
    point[0] += sum(vehicle.fixed * min(vehicle.count, rules.n) for vehicle in rules.vehicles)
    vehicles = min(sum(vehicle.count for vehicle in rules.vehicles), rules.n)
    slowest = max(vehicle.service_factor for vehicle in rules.vehicles)
    services = slowest * sum(visit.longest_service for visit in rules.visits)
    for objective, percent in enumerate(rules.percents):
        if percent is not None:
            point[objective] *= _longer(fleet, percent)
    for objective, (over, layer) in enumerate(zip(rules.over, rules.layers, strict=True)):
        costs = over in ("sum", "max") and layer == rules.clock
        price = float(costs or (over in _TIMED and rules.clock is not None))
        if objective == 0:
            price *= max(vehicle.per_distance for vehicle in rules.vehicles)
            price += max(vehicle.per_time for vehicle in rules.vehicles)
        if price:
            point[objective] += price * services
            once = over in ("max", "imbalance")
            point[objective] += price * _waiting(rules) * (1 if once else vehicles)
        elif over == "weighted_arrival":
            point[objective] += (services + _waiting(rules)) * urgency_of(rules)
    return point


def _longer(fleet: Fleet, percent: int) -> float:
    """Return how many times as long as its mean a leg is on all but few of a hundred days.

    Of several days it is that of the day on which all legs together are longest.
    """
    if fleet.sampled is None:
        return 1 + deviations_of(percent) * (fleet.rules.spread or 0.0)
    daily = fleet.sampled.sum(axis=(1, 2), where=np.isfinite(fleet.sampled))
    return float(daily.max() / daily.mean()) if daily.any() else 1.0


def _waiting(rules: Rules) -> float:
    """Return the longest time that a vehicle may wait between two bounds of times."""
    bounds = [time for span in rules.spans for time in span if time < inf]
    return max(bounds, default=0.0) - min(bounds, default=0.0)
