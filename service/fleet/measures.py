"""The measures of a plan that people compare plans by, whether they are objectives or not."""

from math import inf

from service.fleet.evaluation import cost_length, load_distance, lost_prizes, overtime
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan
from service.fleet.schedule import Schedule, legs, schedule


def measures(fleet: Fleet, plan: Plan) -> dict[str, float]:
    """Return those measures of a plan that the data of its fleet allow, by name.

    - `vehicles`: the number of routes
    - `driving`, `service`, `waiting`: how long all vehicles do each, by the clock
    - `lateness`: the sum of the times by which visits begin after they are due
    - `overtime`: the sum of the times by which routes end after their shifts
    - `longest`, `shortest`, `imbalance`: the longest and the shortest route, and their difference,
      by the clock; without a clock in the objective that is a maximum, or in the first one if
      `imbalance` is an objective
    - `unassigned`: the prizes of the stops that are left out
    - `load_distance`: the sum over all legs of the first costs times the load, in its first
      dimension
    """
    rules = fleet.rules
    found: dict[str, float] = {"vehicles": len(plan.routes)}
    if rules.clock is not None:
        found |= _times(fleet, plan, [schedule(fleet, route) for route in plan.routes])
    if rules.limited is not None:
        lengths = [cost_length(fleet, route, rules.limited) for route in plan.routes]
        longest, shortest = max(lengths, default=0.0), min(lengths, default=0.0)
        found |= {"longest": longest, "shortest": shortest, "imbalance": longest - shortest}
    if any(visit.prize is not None for visit in rules.visits):
        found["unassigned"] = lost_prizes(rules, plan)
    if rules.dimensions:
        found["load_distance"] = sum(load_distance(fleet, route) for route in plan.routes)
    return found


def _times(fleet: Fleet, plan: Plan, schedules: list[Schedule]) -> dict[str, float]:
    rules = fleet.rules
    assert rules.clock is not None
    found = {
        "driving": sum(sum(legs(fleet, route, rules.clock)) for route in plan.routes),
        "service": sum(rules.visits[stop].service for stop in plan.visited()),
        "waiting": sum(times.waiting for times in schedules),
    }
    if any(visit.due < inf for visit in rules.visits):
        found["lateness"] = sum(times.lateness for times in schedules)
    if any(vehicle.max_overtime for vehicle in rules.vehicles):
        columns = zip(plan.routes, schedules, strict=True)
        found["overtime"] = sum(overtime(rules, route, times) for route, times in columns)
    return found
