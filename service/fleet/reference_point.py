"""Compute the reference point of a fleet whose request names none."""

from math import inf

from service.fleet.fleet import Array, Fleet
from service.fleet.rules import Rules


def default_reference_point(fleet: Fleet) -> Array:
    """Return lengths above those of sensible plans, shape (2,).

    They are the number of stops times the scale, plus what else can add to a length. In the
    first objective these are all prizes and fixed costs. In the clock's objective, and in lateness,
    they are all services, and the time from the first shift or window to the end of the last, in
    which a vehicle may wait: once, or for each vehicle if times are summed.
    """
    rules = fleet.rules
    point = rules.n * fleet.scale
    prizes = sum(visit.prize or 0.0 for visit in rules.visits)
    point[0] += 0.0 if rules.measure == "unassigned" else prizes
    point[0] += sum(vehicle.fixed * min(vehicle.count, rules.n) for vehicle in rules.vehicles)
    for objective, over in enumerate(rules.over):
        if over == "lateness" or (over in ("sum", "max") and objective == rules.clock):
            vehicles = min(sum(vehicle.count for vehicle in rules.vehicles), rules.n)
            point[objective] += sum(visit.service for visit in rules.visits)
            point[objective] += _waiting(rules) * (1 if over == "max" else vehicles)
    return point


def _waiting(rules: Rules) -> float:
    """Return the longest time that a vehicle may wait between two bounds of times."""
    bounds = [time for span in rules.spans for time in span if time < inf]
    return max(bounds, default=0.0) - min(bounds, default=0.0)
