"""Why plans leave stops out: the price of serving each, or what keeps each vehicle from it."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from operator import truediv
from typing import NamedTuple, get_args

import numpy as np

from service.fleet.evaluation import (
    Broken,
    first_broken,
    plan_lengths,
    route_lengths,
    routes_broken,
    routes_together,
    unassigned,
)
from service.fleet.fleet import Array, Fleet
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rule, Rules

_RULES: tuple[Rule, ...] = get_args(Rule)  # from those that never change to those that may
# Rules that are broken wherever the stop is inserted, if they are.
_SAME_EVERYWHERE: tuple[Rule, ...] = ("skills", "vehicle", "apart", "max_stops")


_Inserted = tuple[int, Route]  # the number of a route, and the route with one more stop


class Reason(NamedTuple):
    """The rule that keeps all vehicles of a type from a stop where it would break the fewest."""

    vehicle: int
    broken: Broken


class Serving(NamedTuple):
    """How a stop that a plan leaves out can be served, or why not.

    Attributes:
        stop: The stop.
        plan: The number of the plan of the front that serves it, and is the least longer; None if
            no plan does.
        price: What the lengths grow by, in that plan or with the stop inserted where it costs the
            least. None if it cannot be inserted.
        reasons: If it cannot, a reason for each type of vehicles; none if there was no time to try.
    """

    stop: int
    plan: int | None
    price: tuple[float, ...] | None
    reasons: tuple[Reason, ...] = ()


def explain(
    fleet: Fleet,
    plans: Sequence[Plan],
    points: Array,
    ended: Callable[[], bool] = lambda: False,
) -> list[list[Serving]]:
    """Return for each plan of a front how the stops that it leaves out can be served, in order.

    A stop that no plan serves is inserted into the plan that leaves out the fewest.

    Args:
        plans: The m plans.
        points: Their lengths under d objectives, shape (m, d).
        ended: Called before each insertion; once it returns True, the other stops that no plan
            serves have neither a price nor reasons.
    """
    left_out = [unassigned(fleet.rules, plan) for plan in plans]
    if not any(left_out):
        return [[] for _ in plans]
    fullest = min(range(len(plans)), key=lambda index: len(left_out[index]))
    served_by_none = set.intersection(*map(set, left_out))
    inserted = {
        stop: Serving(stop, None, None) if ended() else _inserted(fleet, plans[fullest], stop)
        for stop in sorted(served_by_none)
    }
    outside = [set(stops) for stops in left_out]
    return [
        [
            inserted[stop]
            if stop in inserted
            else _served_elsewhere(fleet, stop, index, outside, points)
            for stop in stops
        ]
        for index, stops in enumerate(left_out)
    ]


def _served_elsewhere(
    fleet: Fleet, stop: int, index: int, left_out: Sequence[set[int]], points: Array
) -> Serving:
    """Return the plan that serves a stop and is the least longer than one that leaves it out."""
    serving = [other for other, stops in enumerate(left_out) if stop not in stops]
    grown = points[serving] - points[index]
    with np.errstate(over="ignore"):
        best = int((grown.clip(min=0.0) / fleet.scale).sum(axis=1).argmin())
    return Serving(stop, serving[best], tuple(grown[best].tolist()))


def with_all_stops(fleet: Fleet, plan: Plan) -> Plan:
    """Return a plan with the stops that it leaves out where they cost the least, if they fit."""
    return with_stops(fleet, plan, unassigned(fleet.rules, plan))


def with_stops(fleet: Fleet, plan: Plan, stops: Iterable[int]) -> Plan:
    """Return a plan with those of some stops that it leaves out, as `with_all_stops` does."""
    for stop in stops:
        if stop not in plan.visited():
            plan = with_stop(fleet, plan, stop) or plan
    return plan


def with_stop(fleet: Fleet, plan: Plan, stop: int) -> Plan | None:
    """Return a plan with one more stop where it costs the least; None if it fits nowhere.

    All lengths count in units of the fleet's scale.
    """
    routes, _ = _insertions(fleet, plan, stop)
    return _cheapest(fleet, plan, routes)


def _cheapest(fleet: Fleet, plan: Plan, routes: Sequence[_Inserted]) -> Plan | None:
    """Return the plan with one of its routes exchanged for the one with which it is the shortest.

    All lengths count in units of the fleet's scale. The same prizes are lost with each route.
    """
    known = [route_lengths(fleet, each) for each in plan.routes]

    def cost(inserted: _Inserted) -> float:
        number, route = inserted
        if fleet.rules.groups.waiting:  # then the times of other routes may change
            return sum(map(truediv, plan_lengths(fleet, exchanged(plan, number, route)), scale))
        of_routes = [*known[:number], route_lengths(fleet, route), *known[number + 1 :]]
        lengths = routes_together(fleet, exchanged(plan, number, route).routes, of_routes)
        if number == len(known):
            lengths[0] += fleet.rules.vehicles[route.vehicle].fixed
        return sum(map(truediv, lengths, scale))

    scale = fleet.scale.tolist()
    if not routes:
        return None
    return exchanged(plan, *min(routes, key=cost))


def exchanged(plan: Plan, number: int, route: Route) -> Plan:
    """Return a plan with another route of a number, or one more route."""
    return Plan((*plan.routes[:number], route, *plan.routes[number + 1 :]))


def _inserted(fleet: Fleet, plan: Plan, stop: int) -> Serving:
    """Return the cheapest insertion of a stop into a plan, or what forbids each."""
    routes, reasons = _insertions(fleet, plan, stop)
    cheapest = _cheapest(fleet, plan, routes)
    if cheapest is None:
        return Serving(stop, None, None, tuple(Reason(*each) for each in sorted(reasons.items())))
    price = np.subtract(plan_lengths(fleet, cheapest), plan_lengths(fleet, plan))
    return Serving(stop, None, tuple(price.tolist()))


def _insertions(fleet: Fleet, plan: Plan, stop: int) -> tuple[list[_Inserted], dict[int, Broken]]:
    """Return all routes with one more stop, and by type the rule that forbids others.

    Of several rules it is the one that the fewest insertions get as far as.
    """
    found: list[_Inserted] = []
    reasons: dict[int, Broken] = {}
    for number, route in open_routes(fleet, plan):
        for extended in _extensions(fleet, route, stop):
            broken = first_broken(fleet, extended) or _broken_beside(fleet, plan, number, extended)
            if broken is None:
                found.append((number, extended))
                continue
            known = reasons.setdefault(route.vehicle, broken)
            if _RULES.index(broken.rule) > _RULES.index(known.rule):
                reasons[route.vehicle] = broken
            if is_same_everywhere(fleet.rules, route.vehicle, broken.rule):
                break
    return found, reasons


def is_same_everywhere(rules: Rules, vehicle: int, rule: Rule) -> bool:
    """Return whether a route with one more stop breaks a rule wherever that is, if it does once."""
    if rules.vehicles[vehicle].reload:
        return False
    if rule == "capacity":  # what is taken on board on the way depends on the order
        return not (rules.shipments or rules.takes)
    return rule in _SAME_EVERYWHERE


def _broken_beside(fleet: Fleet, plan: Plan, number: int, route: Route) -> Broken | None:
    """Return the first rule that a plan breaks with an exchanged route, if visits wait."""
    if not fleet.rules.groups.waiting:
        return None
    broken = routes_broken(fleet, exchanged(plan, number, route))
    return next((each for _, each in broken), None)


def open_routes(fleet: Fleet, plan: Plan) -> Iterator[tuple[int, Route]]:
    """Yield the routes of a plan with their numbers, and one for each type with a vehicle left."""
    yield from enumerate(plan.routes)
    used = [route.vehicle for route in plan.routes]
    for index, vehicle in enumerate(fleet.rules.vehicles):
        if used.count(index) < vehicle.count:
            yield len(plan.routes), Route(index, ())


def _extensions(fleet: Fleet, route: Route, stop: int) -> Iterator[Route]:
    """Yield the routes with a stop inserted, also after loading again at the end of a route.

    Of a shipment both stops are inserted, one after the other, and so are all that ride together.
    """
    shipped = [each for each in fleet.rules.shipments if stop in (each.pickup, each.delivery)]
    alone = tuple(sorted(fleet.rules.groups.mates.get(stop, (stop,))))
    added = (shipped[0].pickup, shipped[0].delivery) if shipped else alone
    for place in range(len(route.stops) + 1):
        yield Route(route.vehicle, (*route.stops[:place], *added, *route.stops[place:]))
    for reload in fleet.rules.vehicles[route.vehicle].reload:
        yield Route(route.vehicle, (*route.stops, reload, *added))
