"""The lengths of plans, the times of their routes, and the rules that they break.

Every plan is checked with this code, which shares nothing with the engine that finds plans.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from math import inf

import numpy as np

from service.fleet.fleet import Array, Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rules import Rules
from service.objectives import OBJECTIVES

_TOLERANCE = 1e-9  # of the length of a route: sums of floats depend on their order
_ROUNDING = 2.0**-52  # relative, for each time of a route


@dataclass(frozen=True)
class Schedule:
    """The times of a route: when the vehicle reaches each stop, and when it is done.

    Attributes:
        arrivals: The arrival at each stop of `path_of`; at the first stop, the departure. The
            vehicle may wait at a stop until its window opens.
        end: The end of the route.
        late: The largest delay at a window or at the end of the shift.
        waiting: The time that the vehicle waits.
        slack: How much later it may leave without being late, if it is never late.
    """

    arrivals: tuple[float, ...]
    end: float
    late: float
    waiting: float
    slack: float

    @property
    def duration(self) -> float:
        """The time from the departure to the end."""
        return self.end - self.arrivals[0]


def schedule(fleet: Fleet, route: Route) -> Schedule:
    """Return the times of a route whose vehicle leaves as late as does not delay its end.

    Raises:
        ValueError: The fleet has no clock.
    """
    if fleet.rules.clock is None:
        raise ValueError("a fleet without a clock has no times")
    driven = legs(fleet, route, fleet.rules.clock)
    begin, last = fleet.rules.vehicles[route.vehicle].shift
    early = _drive(fleet.rules, route, driven, begin, last)
    # Savelsbergh (1992): leaving later by the waiting time, or by what windows allow, does not
    # delay the end of the route.
    delay = 0.0 if early.late else min(early.waiting, early.slack)
    if not delay:
        return early
    return replace(_drive(fleet.rules, route, driven, begin + delay, last), late=early.late)


def _drive(
    rules: Rules, route: Route, driven: Sequence[float], departure: float, last: float
) -> Schedule:
    """Return the times of a route with legs of these times, from a departure on."""
    time, waiting, slack, late = departure, 0.0, inf, 0.0
    arrivals = []
    for stop, leg in zip(path_of(rules, route), [*driven, 0.0], strict=True):
        visit = rules.visits[stop]
        opens, closes = visit.window
        arrivals.append(time)
        waiting += max(0.0, opens - time)
        begin = max(time, opens)
        slack = min(slack, closes - begin + waiting)
        late = max(late, begin - closes)
        end = begin + visit.service
        time = end + leg
    slack = min(slack, last - end + waiting)
    return Schedule(tuple(arrivals), end, max(late, end - last), waiting, slack)


def legs(fleet: Fleet, route: Route, objective: int) -> list[float]:
    """Return the costs of the legs of a route in one objective."""
    costs = fleet.costs[objective]
    return [float(costs[a, b]) for a, b in pairwise(path_of(fleet.rules, route))]


def route_lengths(fleet: Fleet, route: Route) -> tuple[float, float]:
    """Return the lengths of a route: its duration in the clock's objective, else its costs."""
    return _length(fleet, route, 0), _length(fleet, route, 1)


def plan_lengths(fleet: Fleet, plan: Plan) -> tuple[float, float]:
    """Return the lengths of a plan. The first one includes lost prizes and fixed costs."""
    routes = np.reshape([route_lengths(fleet, each) for each in plan.routes], (-1, OBJECTIVES))
    first, second = (
        float(lengths.max(initial=0.0) if over == "max" else lengths.sum())
        for lengths, over in zip(routes.T, fleet.rules.over, strict=True)
    )
    return first + extras(fleet.rules, plan), second


def extras(rules: Rules, plan: Plan) -> float:
    """Return the prizes that a plan loses, and the fixed costs of the vehicles that it uses."""
    fixed = sum(rules.vehicles[route.vehicle].fixed for route in plan.routes)
    return fixed + sum(rules.visits[stop].prize or 0.0 for stop in unassigned(rules, plan))


def unassigned(rules: Rules, plan: Plan) -> list[int]:
    """Return the stops that a plan leaves out, in order."""
    return sorted(set(rules.clients) - set(plan.visited()))


def points_of(fleet: Fleet, plans: Sequence[Plan]) -> Array:
    """Return the lengths of plans, shape (m, 2)."""
    return np.array([plan_lengths(fleet, plan) for plan in plans]).reshape(-1, OBJECTIVES)


def violations(fleet: Fleet, plan: Plan) -> list[str]:
    """Return a sentence for each rule of the fleet that a plan breaks."""
    return [
        *_visits_broken(fleet.rules, plan),
        *_counts_broken(fleet.rules, plan),
        *_shipments_broken(fleet.rules, plan),
        *(broken for route in plan.routes for broken in route_violations(fleet, route)),
    ]


def _length(fleet: Fleet, route: Route, objective: int) -> float:
    if objective == fleet.rules.clock:
        return schedule(fleet, route).duration
    return sum(legs(fleet, route, objective))


def _visits_broken(rules: Rules, plan: Plan) -> Iterator[str]:
    visits = Counter(plan.visited())
    for stop, times in visits.items():
        if stop not in rules.clients:
            yield f"stop {stop} is not a stop to visit"
        elif times > 1:
            yield f"stop {stop} is visited {times} times"
    pickups = {each.delivery: each.pickup for each in rules.shipments}
    for stop in unassigned(rules, plan):
        if rules.visits[pickups.get(stop, stop)].prize is None:
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


def route_violations(fleet: Fleet, route: Route) -> Iterator[str]:
    """Yield a sentence for each rule that a route breaks by itself."""
    rules = fleet.rules
    vehicle = rules.vehicles[route.vehicle]
    if fleet.forbids and inf in legs(fleet, route, 0):
        yield f"a vehicle of type {route.vehicle} takes a forbidden leg"
        return
    for dimension, capacity in enumerate(vehicle.capacity):
        if (most := max(_loads(rules, route, dimension))) > capacity:
            yield f"a vehicle of type {route.vehicle} holds {most} of {capacity}"
    if rules.clock is not None:
        times = schedule(fleet, route)
        rounding = 2 * _ROUNDING * len(times.arrivals) * times.end
        if times.late > _TOLERANCE * times.duration + rounding:
            yield f"a vehicle of type {route.vehicle} is late by {times.late:g}"
    if vehicle.longest != inf:
        assert rules.limited is not None
        if (length := _length(fleet, route, rules.limited)) * (1 - _TOLERANCE) > vehicle.longest:
            yield f"a route of length {length:g} is longer than {vehicle.longest:g}"


def _loads(rules: Rules, route: Route, dimension: int) -> Iterator[int]:
    """Return the load of a vehicle in one dimension, at its start and after each visit.

    At the start it holds the demands of all stops that are not in shipments.
    """
    pickups = {each.delivery: each.pickup for each in rules.shipments}

    def change(stop: int) -> int:
        demand = rules.visits[pickups.get(stop, stop)].demand
        load = demand[dimension] if demand else 0
        return load if stop in rules.shipped and stop not in pickups else -load

    brought = -sum(change(stop) for stop in route.stops if stop not in rules.shipped)
    return accumulate(map(change, route.stops), initial=brought)
