"""The lengths and other measures of plans, and the rules that they break.

Every plan is checked with this code, which shares nothing with the engine that finds plans.
"""

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from math import inf
from typing import NamedTuple

import numpy as np

from service.fleet.fleet import Array, Fleet
from service.fleet.measures.carried import load_distance, loads_on
from service.fleet.measures.of_times import OF_TIMES, changes
from service.fleet.measures.overlap import overlap
from service.fleet.measures.punctuality import late_visits, longest_duration, punctuality
from service.fleet.measures.table import MEASURES, Measure
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rounding import is_over
from service.fleet.rules import Over, Rule, Rules
from service.fleet.schedule import REMEMBERED, broken_waits, legs, schedule, trips_of, with_waits

_OF_ROUTE: Mapping[str, Callable[[Fleet, Route], float]] = {
    each.__name__: each for each in (changes, overlap, load_distance)
}
# The length of a route in each measure that is no cost.
_LENGTHS: Mapping[str, Callable[[Fleet, Route], float]] = {
    **OF_TIMES,
    **_OF_ROUTE,
    "vehicles": lambda *_: 1.0,
    "unassigned": lambda *_: 0.0,  # what is left out is on no route
    "on_time": late_visits,
}


class Broken(NamedTuple):
    """A rule that a vehicle breaks on its route, and what it does, as "holds 4 of 3"."""

    rule: Rule
    detail: str


@lru_cache(REMEMBERED)
def route_lengths(fleet: Fleet, route: Route) -> tuple[float, ...]:
    """Return the lengths of a route, before prizes and fixed costs.

    By the clock's costs that is its duration, by others the sum of its legs; the first one is at
    the prices of its vehicle. The imbalance of a plan is that of the lengths that routes have here.
    A percentile is that of the route alone.
    """
    pairs = enumerate(zip(fleet.rules.over, fleet.rules.layers, strict=True))
    first, *others = (
        longest_duration(fleet, (route,), percent)
        if (percent := fleet.rules.percent(m)) is not None
        else _length(fleet, route, over, layer)
        for m, (over, layer) in pairs
    )
    vehicle = fleet.rules.vehicles[route.vehicle]
    first *= vehicle.per_distance
    if vehicle.per_time:
        first += vehicle.per_time * schedule(fleet, route).duration
    return (first, *others)


def plan_lengths(fleet: Fleet, plan: Plan) -> tuple[float, ...]:
    """Return the lengths of a plan. The first one includes fixed costs and lost prizes.

    If the prizes of what is left out are an objective, the first does not include them.
    """
    routes = with_waits(fleet, plan).routes
    return joined_lengths(fleet, plan, [route_lengths(fleet, each) for each in routes])


def joined_lengths(
    fleet: Fleet, plan: Plan, of_routes: Sequence[tuple[float, ...]]
) -> tuple[float, ...]:
    """Return the lengths of a plan, given those of its routes."""
    rules, lengths = fleet.rules, routes_together(fleet, plan.routes, of_routes)
    lengths[0] += fixed_costs(rules, plan)
    paid = rules.over.index("unassigned") if "unassigned" in rules.over else 0
    lengths[paid] += lost_prizes(rules, plan)
    if "changes" in rules.over:
        lengths[rules.over.index("changes")] += _dropped(rules, plan)
    return tuple(lengths)


def _dropped(rules: Rules, plan: Plan) -> int:
    """Return how many promised stops a plan leaves out."""
    return len(rules.promises - {*plan.visited()})


def routes_together(
    fleet: Fleet, routes: Sequence[Route], of_routes: Sequence[tuple[float, ...]]
) -> list[float]:
    """Return the lengths of all routes together, given those of each."""
    rules = fleet.rules
    columns = list(zip(*of_routes, strict=True)) or [()] * len(rules.over)
    return [
        longest_duration(fleet, routes, percent)
        if over == "sum" and (percent := rules.percent(m)) is not None
        else _joined(over, column)
        for m, (over, column) in enumerate(zip(rules.over, columns, strict=True))
    ]


def _joined(over: Over | Measure, lengths: Sequence[float]) -> float:
    """Return the length of a plan whose routes have these lengths."""
    if over == "max":
        return max(lengths, default=0.0)
    if over == "imbalance" and lengths:
        return max(lengths) - min(lengths)
    return float(sum(lengths))


def fixed_costs(rules: Rules, plan: Plan) -> float:
    """Return the fixed costs of the vehicles that a plan uses."""
    return sum(rules.vehicles[route.vehicle].fixed for route in plan.routes)


def lost_prizes(rules: Rules, plan: Plan) -> float:
    """Return the prizes of the stops that a plan leaves out."""
    return sum(rules.visits[stop].prize or 0.0 for stop in unassigned(rules, plan))


def unassigned(rules: Rules, plan: Plan) -> list[int]:
    """Return the stops that a plan leaves out, in order."""
    return sorted(set(rules.clients) - set(plan.visited()))


def measures(fleet: Fleet, plan: Plan) -> dict[str, float]:
    """Return those measures of a plan that the data of its fleet allow, by name.

    Most are sums over its routes: see `_LENGTHS`. Others are:

    - `driving`, `service`, `waiting`: how long all vehicles do each, by the clock
    - `longest`, `shortest`, `imbalance`: the longest and the shortest route, and their difference,
      by the clock; without a clock in the objective that is a maximum, or in the first one if
      `imbalance` is an objective
    - `changes`: the sum over the routes, and the promised stops that are left out
    - `on_time`, `duration`, `duration_p90`: where times spread, as `punctuality` has them
    - `unassigned`: the prizes of the stops that are left out
    """
    rules, plan = fleet.rules, with_waits(fleet, plan)
    found: dict[str, float] = {"vehicles": len(plan.routes)}
    if rules.clock is not None:
        found |= _times(fleet, plan) | _sums(fleet, plan, OF_TIMES) | punctuality(fleet, plan)
    if rules.limited is not None:
        lengths = [cost_length(fleet, route, rules.limited) for route in plan.routes]
        longest, shortest = max(lengths, default=0.0), min(lengths, default=0.0)
        found |= {"longest": longest, "shortest": shortest, "imbalance": longest - shortest}
    if MEASURES["unassigned"].given(rules.visits, rules.vehicles):
        found["unassigned"] = lost_prizes(rules, plan)
    found |= _sums(fleet, plan, _OF_ROUTE)
    if "changes" in found:
        found["changes"] += _dropped(rules, plan)
    return found


def _sums(
    fleet: Fleet, plan: Plan, of_route: Mapping[str, Callable[[Fleet, Route], float]]
) -> dict[str, float]:
    """Return the sums over all routes of those measures that the data allow, or that are asked."""
    rules = fleet.rules
    return {
        name: sum(measured(fleet, route) for route in plan.routes)
        for name, measured in of_route.items()
        if name in rules.over or MEASURES[name].given(rules.visits, rules.vehicles)
    }


def _times(fleet: Fleet, plan: Plan) -> dict[str, float]:
    rules = fleet.rules
    assert rules.clock is not None
    return {
        "driving": sum(sum(legs(fleet, route, rules.clock)) for route in plan.routes),
        "service": sum(
            rules.service(each.vehicle, stop) for each in plan.routes for stop in each.stops
        ),
        "waiting": sum(schedule(fleet, route).waiting for route in plan.routes),
    }


def points_of(fleet: Fleet, plans: Sequence[Plan]) -> Array:
    """Return the lengths of k plans under m objectives, shape (k, m)."""
    lengths = [plan_lengths(fleet, plan) for plan in plans]
    return np.array(lengths).reshape(-1, len(fleet.rules.over))


def violations(fleet: Fleet, plan: Plan) -> list[str]:
    """Return a sentence for each rule of the fleet that a plan breaks."""
    return [
        *_visits_broken(fleet.rules, plan),
        *_counts_broken(fleet.rules, plan),
        *_shipments_broken(fleet.rules, plan),
        *(
            f"a vehicle of type {vehicle} {broken.detail}"
            for vehicle, broken in routes_broken(fleet, plan)
        ),
    ]


def routes_broken(fleet: Fleet, plan: Plan) -> Iterator[tuple[int, Broken]]:
    """Yield each rule that a route of a plan breaks, by itself or beside the others, by vehicle."""
    plan = with_waits(fleet, plan)
    for route in plan.routes:
        if first_broken(fleet, route):
            yield from ((route.vehicle, broken) for broken in route_violations(fleet, route))
    for wait in broken_waits(fleet, plan):
        vehicle = next(each.vehicle for each in plan.routes if wait.then in each.stops)
        detail = f"begins the visit of stop {wait.then} too soon after that of {wait.first}"
        yield vehicle, Broken("before", detail)


def _length(fleet: Fleet, route: Route, over: Over | Measure, layer: int) -> float:
    """Return a length of a route."""
    if over in _LENGTHS:
        return _LENGTHS[over](fleet, route)
    if over == "imbalance" and fleet.rules.limited is not None:
        layer = fleet.rules.limited
    return cost_length(fleet, route, layer)


def cost_length(fleet: Fleet, route: Route, layer: int) -> float:
    """Return the length of a route in costs: by the clock its duration, else that of its legs."""
    if layer == fleet.rules.clock:
        return schedule(fleet, route).duration
    return sum(legs(fleet, route, layer))


def _visits_broken(rules: Rules, plan: Plan) -> Iterator[str]:
    visits = Counter(
        stop for route in plan.routes for trip in trips_of(rules, route) for stop in trip
    )
    for stop, times in visits.items():
        if stop not in rules.clients:
            yield f"stop {stop} is not a stop to visit"
        elif times > 1:
            yield f"stop {stop} is visited {times} times"
    for stop in unassigned(rules, plan):
        if stop in rules.required:
            yield f"stop {stop} is not visited"
    yield from ("a route visits no stop" for route in plan.routes if not route.stops)


def _counts_broken(rules: Rules, plan: Plan) -> Iterator[str]:
    for index, count in Counter(route.vehicle for route in plan.routes).items():
        if count > rules.vehicles[index].count:
            yield f"{count} vehicles of type {index} leave, and there are fewer"


def _shipments_broken(rules: Rules, plan: Plan) -> Iterator[str]:
    places = {
        stop: (number, place)
        for number, route in enumerate(plan.routes)
        for place, stop in enumerate(route.stops)
    }
    for each in rules.shipments:
        pickup, delivery = places.get(each.pickup), places.get(each.delivery)
        if (pickup is None) != (delivery is None):
            yield f"only half of the shipment from {each.pickup} to {each.delivery} is done"
        elif pickup and delivery and (pickup[0] != delivery[0] or pickup > delivery):
            yield f"the load for {each.delivery} was not picked up at {each.pickup} before"


@lru_cache(REMEMBERED)
def first_broken(fleet: Fleet, route: Route) -> Broken | None:
    """Return the first rule that a route breaks by itself, or None."""
    return next(route_violations(fleet, route), None)


def route_violations(fleet: Fleet, route: Route) -> Iterator[Broken]:
    """Yield each rule that a route breaks by itself."""
    rules = fleet.rules
    vehicle = rules.vehicles[route.vehicle]
    if fleet.forbids and inf in fleet.legs_along(0, path_of(rules, route), route.vehicle):
        yield Broken("way", "takes a forbidden leg")
        return
    yield from _service_broken(rules, route)
    yield from _trips_broken(rules, route)
    reach = 0.0
    if rules.clock is not None:
        times = schedule(fleet, route)
        if times.late == inf:
            yield Broken("break", "has no time for a break")
            return
        if times.late:
            over = times.end - vehicle.way[1] >= times.late
            yield Broken("shift" if over else "window", f"is late by {times.late:g}")
        reach = times.end
    yield from _length_broken(fleet, route, reach)
    for rule, stop, other in rules.groups.broken([s for s in route.stops if s in rules.clients]):
        yield Broken(rule, _IN_GROUPS[rule].format(stop=stop, other=other))


_IN_GROUPS = {
    "together": "visits stop {stop} without {other}",
    "apart": "visits both stops {stop} and {other}",
    "before": "visits stop {other} before {stop}",
}


def _length_broken(fleet: Fleet, route: Route, reach: float) -> Iterator[Broken]:
    """Yield the rules about the length of a route that it breaks; it ends at `reach`."""
    rules, vehicle = fleet.rules, fleet.rules.vehicles[route.vehicle]
    if vehicle.longest != inf or vehicle.shortest:
        assert rules.limited is not None
        length = cost_length(fleet, route, rules.limited)
        if is_over(length, vehicle.longest, reach):
            detail = f"has a route of {length:g}, longer than {vehicle.longest:g}"
            yield Broken("longest", detail)
        if is_over(vehicle.shortest, length, reach):
            detail = f"has a route of {length:g}, shorter than {vehicle.shortest:g}"
            yield Broken("shortest", detail)
    for layer, most in enumerate(rules.most_legs(route.vehicle)):
        if most < inf and is_over(driven := sum(legs(fleet, route, layer)), most):
            rule: Rule = "max_driving" if layer == rules.clock else "max_distance"
            yield Broken(rule, f"drives {driven:g}, more than {most:g}")


def _service_broken(rules: Rules, route: Route) -> Iterator[Broken]:
    """Yield the rules about which stops a vehicle may visit, and how many."""
    vehicle = rules.vehicles[route.vehicle]
    visited = [stop for trip in trips_of(rules, route) for stop in trip]
    for stop in visited:
        visit = rules.visits[stop]
        if missing := set(visit.skills) - set(vehicle.skills):
            yield Broken("skills", f"lacks the skill {min(missing)}")
        if visit.vehicles and route.vehicle not in visit.vehicles:
            yield Broken("vehicle", "is not the one that the stop names")
    if vehicle.max_stops is not None and len(visited) > vehicle.max_stops:
        yield Broken("max_stops", f"has {len(visited)} stops, and may have {vehicle.max_stops}")
    if len(visited) < vehicle.min_stops:
        yield Broken("min_stops", f"has {len(visited)} stops, and needs {vehicle.min_stops}")


def _trips_broken(rules: Rules, route: Route) -> Iterator[Broken]:
    """Yield the rules about trips and loads that a route breaks."""
    vehicle, trips = rules.vehicles[route.vehicle], trips_of(rules, route)
    if not all(trips[1:]):
        yield Broken("max_trips", "loads again and brings nothing")
    if vehicle.max_trips is not None and len(trips) > vehicle.max_trips:
        yield Broken("max_trips", f"has {len(trips)} trips, and may have {vehicle.max_trips}")
    for dimension, capacity in enumerate(vehicle.capacity):
        for number, trip in enumerate(trips):
            first = vehicle.initial_load if number == 0 else ()
            if (most := max(loads_on(rules, trip, dimension, first))) > capacity:
                yield Broken("capacity", f"holds {most} of {capacity}")
