"""Find the exact front of a fleet of few stops and vehicles by dynamic programming over routes.

Every order of every subset of the stops is a route. One vehicle after another takes a route or
none. Among the partial plans that visit the same stops, dominated ones are dropped, unless visits
wait for others: then what a route costs depends on all routes. Where the imbalance is an objective,
they are compared by their longest route, which should be short, and by their shortest, which should
be long.
"""

from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from itertools import permutations, product
from math import inf
from operator import add
from typing import NamedTuple

import numpy as np

from service.fleet.evaluation import first_broken, route_lengths, violations
from service.fleet.fleet import Fleet
from service.fleet.measures.punctuality import Normal, duration_of
from service.fleet.plans import Plan, Route
from service.fleet.rules import Rules
from service.pareto import nondominated

MOST_STOPS = 6  # stops to visit
_MOST_WAITING = 4  # where visits wait for others, so that all plans are tried
_MOST_VEHICLES = 6
Stops = frozenset[int]
# How the values of two partial plans are joined, if not by adding them, and those of no route.
_JOINED: Mapping[str, tuple[Callable[[float, float], float], ...]] = {
    "max": (max,),
    "imbalance": (max, max),
}
_NOTHING: Mapping[str, float] = {"imbalance": -inf}


class _Partial(NamedTuple):
    """The routes of some vehicles, and the values by which these are compared."""

    values: tuple[float, ...]
    routes: tuple[Route, ...]


Partials = Mapping[Stops, list[_Partial]]


def is_enumerable(rules: Rules) -> bool:
    """Return whether a fleet has few stops and vehicles.

    It is not, if a percentile of all routes together is of several days: too few partial plans are
    better than others on all days.
    """
    pairs = zip(rules.over, rules.percents, strict=False)
    if rules.sampled and any(over == "sum" and percent is not None for over, percent in pairs):
        return False
    stops = len(rules.clients)
    vehicles = sum(min(vehicle.count, stops) for vehicle in rules.vehicles)
    most = _MOST_WAITING if rules.groups.waiting else MOST_STOPS
    return stops <= most and vehicles <= _MOST_VEHICLES


def some_plan(fleet: Fleet, ended: Callable[[], bool]) -> Plan | None:
    """Return a plan of a fleet of few stops that keeps every rule; None if there is none.

    Also None if `ended`, which is called every few milliseconds, returns True before the end. Only
    the first route found through the same stops is tried, so this is faster than `exact_plans`.
    """
    rules = fleet.rules
    reached: dict[Stops, Plan] = {frozenset(): Plan(())}
    try:
        for index, vehicle in enumerate(rules.vehicles):
            routes = _first_routes(fleet, index, ended)
            for _ in range(min(vehicle.count, len(rules.clients))):
                _reach_more(reached, routes)
            for plan in reached.values():
                if not violations(fleet, plan):
                    return plan
    except _Ended:
        pass
    return None


def _reach_more(reached: dict[Stops, Plan], routes: Mapping[Stops, Route]) -> None:
    """Add a plan for each set of stops that one more route reaches first."""
    for visited, plan in list(reached.items()):
        for added, route in routes.items():
            if not visited & added:
                reached.setdefault(visited | added, Plan((*plan.routes, route)))


def _first_routes(fleet: Fleet, vehicle: int, ended: Callable[[], bool]) -> dict[Stops, Route]:
    """Return a route of a vehicle through each set of stops that it can visit."""
    found: dict[Stops, Route] = {}
    for stops, route in _in_order(fleet.rules, vehicle, ended):
        visited = frozenset(stops)
        if visited not in found and not first_broken(fleet, route):
            found[visited] = route
    return found


class _Ended(Exception):
    """The time is over."""


def exact_plans(fleet: Fleet, ended: Callable[[], bool] = lambda: False) -> list[Plan] | None:
    """Return a plan for each point of the exact front, and some dominated plans.

    Return None if `ended`, which is called every few milliseconds, returns True before the end.
    """
    rules = fleet.rules
    nothing = tuple(
        0.0 if way is add else _NOTHING.get(over, 0.0)
        for m, over in enumerate(rules.over)
        for way in _ways(rules, m)
    )
    partials: Partials = {frozenset(): [_Partial(nothing, ())]}
    try:
        for index, vehicle in enumerate(rules.vehicles):
            routes = _routes(fleet, index, ended)
            for _ in range(min(vehicle.count, len(rules.clients))):
                partials = _with_another(rules, partials, routes, ended)
    except _Ended:
        return None
    plans = [Plan(partial.routes) for each in partials.values() for partial in each]
    return [plan for plan in plans if not violations(fleet, plan)]


def _routes(fleet: Fleet, vehicle: int, ended: Callable[[], bool]) -> Partials:
    """Return the routes of a vehicle that break no rule, grouped by the stops that they visit."""
    rules = fleet.rules
    fixed = rules.vehicles[vehicle].fixed
    found: dict[Stops, list[_Partial]] = defaultdict(list)
    for stops, route in _in_order(rules, vehicle, ended):
        broken = first_broken(fleet, route)
        # A route that waits for others may be long enough.
        if not broken or (broken.rule == "shortest" and rules.groups.waiting):
            first, *others = _values(fleet, route)
            found[frozenset(stops)].append(_Partial((first + fixed, *others), (route,)))
    return _undominated(rules, found)


def _in_order(
    rules: Rules, vehicle: int, ended: Callable[[], bool]
) -> Iterator[tuple[tuple[int, ...], Route]]:
    """Yield all routes of a vehicle and the stops that each visits, shorter ones first."""
    for most in range(1, len(rules.clients) + 1):
        for stops in permutations(rules.clients, most):
            if _ships_in_order(rules, stops):
                for route in _trips(rules, vehicle, stops):
                    if ended():
                        raise _Ended
                    yield stops, route


def _values(fleet: Fleet, route: Route) -> Iterator[float]:
    """Yield the values by which a route is compared: its lengths, for imbalance with both signs.

    A percentile of all routes together rises with the mean and with the variance of each.
    """
    for m, (over, length) in enumerate(
        zip(fleet.rules.over, route_lengths(fleet, route), strict=True)
    ):
        if over == "sum" and fleet.rules.percent(m) is not None:
            duration = duration_of(fleet, route)
            assert isinstance(duration, Normal)
            yield from duration
            continue
        yield length
        if over == "imbalance":
            yield -length


def _ways(rules: Rules, objective: int) -> tuple[Callable[[float, float], float], ...]:
    """Return how the values of two partial plans in an objective are joined."""
    over = rules.over[objective]
    if over == "sum" and rules.percent(objective) is not None:
        return add, add
    return _JOINED.get(over, (add,))


def _trips(rules: Rules, vehicle: int, stops: tuple[int, ...]) -> Iterator[Route]:
    """Yield the routes of a vehicle that visit these stops in order, with any stops to reload."""
    reloads = [(), *((stop,) for stop in rules.vehicles[vehicle].reload)]
    for before in product(reloads, repeat=len(stops)):
        trips = zip(before, stops, strict=True)
        yield Route(vehicle, tuple(each for reload, stop in trips for each in (*reload, stop)))


def _ships_in_order(rules: Rules, stops: tuple[int, ...]) -> bool:
    """Return whether a route has both stops of each of its shipments, in the right order."""
    places = {stop: place for place, stop in enumerate(stops)}
    missing = len(stops)
    return all(
        places.get(each.pickup, missing) < places.get(each.delivery, missing)
        or not {each.pickup, each.delivery} & places.keys()
        for each in rules.shipments
    )


def _with_another(
    rules: Rules, partials: Partials, routes: Partials, ended: Callable[[], bool]
) -> Partials:
    """Return the partial plans in which one more vehicle takes one of these routes, or none."""
    found = {visited: list(each) for visited, each in partials.items()}
    for visited, before in partials.items():
        for added, each in routes.items():
            if ended():
                raise _Ended
            if not visited & added:
                joined = (_joined(rules, a, b) for a in before for b in each)
                found.setdefault(visited | added, []).extend(joined)
    return _undominated(rules, found)


def _joined(rules: Rules, a: _Partial, b: _Partial) -> _Partial:
    ways = [way for m in range(len(rules.over)) for way in _ways(rules, m)]
    values = tuple(way(x, y) for way, x, y in zip(ways, a.values, b.values, strict=True))
    return _Partial(values, a.routes + b.routes)


def _undominated(rules: Rules, found: Partials) -> Partials:
    """Return the partial plans without those that another one of the same stops dominates."""
    if rules.groups.waiting:
        return found
    return {
        visited: [each[index] for index in nondominated(np.array([one.values for one in each]))]
        if len(each) > 1
        else each
        for visited, each in found.items()
    }
