"""The times of routes: when vehicles leave, arrive and wait, also for each other, and how late."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise
from math import inf
from typing import NamedTuple

from service.fleet.breaks import with_breaks
from service.fleet.day_legs import Leg, leg_of
from service.fleet.day_schedule import best_departure
from service.fleet.fleet import Fleet
from service.fleet.plans import Plan, Route, path_of
from service.fleet.rounding import is_over
from service.fleet.rules import Rules
from service.fleet.times import Chain, Schedule, Stay, drive
from service.fleet.vehicles import ALWAYS, Span

REMEMBERED = 4096  # latest routes whose times and lengths are known: plans share many routes
_FREE = Stay((ALWAYS,), 0.0, inf)
Times = Mapping[int, float]


@lru_cache(REMEMBERED)
def schedule(fleet: Fleet, route: Route) -> Schedule:
    """Return the times of a route whose vehicle is done as early as possible.

    Of the ways to be done then, it takes one of the least lateness. It leaves as late as neither
    delays its end nor makes a visit later than due, or than promised if changes count, and no later
    than it must; or as early as it may, if the rules say so. Over the day it leaves when the route
    takes the least time instead: see `best_departure`.

    Raises:
        ValueError: The fleet has no clock.
    """
    if fleet.rules.clock is None:
        raise ValueError("a fleet without a clock has no times")
    breaks = fleet.rules.vehicles[route.vehicle].breaks
    chain = _chain_of(fleet, route)
    return with_breaks(chain, breaks, _timed) if breaks else _timed(chain)


def _chain_of(fleet: Fleet, route: Route) -> Chain:
    """Return a route as a chain, without breaks."""
    rules, vehicle = fleet.rules, fleet.rules.vehicles[route.vehicle]
    assert rules.clock is not None
    trips, over_the_day = trips_of(rules, route), fleet.day is not None
    return Chain(
        stays=_stays(rules, route, trips),
        legs=_legs_of_day(fleet, route) if over_the_day else legs(fleet, route, rules.clock),
        begin=max(vehicle.way[0], _released(rules, trips[0])),
        leaves_by=vehicle.leaves_by,
        last=vehicle.way[1],
        shift_end=vehicle.shift[1],
        early=rules.leave == "early",
        over_the_day=over_the_day,
    )


def _timed(chain: Chain) -> Schedule:
    """Return the times of a route whose breaks are stays, as in `schedule`."""
    first = drive(chain, chain.begin)
    if is_over(chain.begin, chain.leaves_by):
        return replace(first, late=max(first.late, chain.begin - chain.leaves_by))
    if first.late or chain.early:
        return first
    later = best_departure if chain.over_the_day else _latest_departure
    departure = later(chain, first)
    return first if departure == chain.begin else drive(chain, departure, first.end)


def _latest_departure(chain: Chain, first: Schedule) -> float:
    """Return the latest departure that makes nothing later, given the times after the earliest."""
    best = first
    # A later window at the stop that keeps the vehicle from leaving later may not delay the end.
    while best.slack <= best.waiting and best.tightest >= 0:
        allowed = list(best.windows)
        allowed[best.tightest] += 1
        later = drive(chain, chain.begin, allowed=allowed)
        if (
            later.late
            or is_over(later.end, best.end)
            or is_over(later.lateness, best.lateness, best.end)
            or _delays(chain.stays, best, later)
        ):
            break
        best = later
    # Savelsbergh (1992): leaving later by the waiting time, or by what windows allow, does not
    # delay the end of the route.
    delay = min(best.waiting, best.slack, chain.leaves_by - chain.begin)
    return chain.begin + max(0.0, delay)


def _delays(stays: Sequence[Stay], first: Schedule, later: Schedule) -> bool:
    """Return whether a visit begins later than at first, and than what no departure may miss."""
    columns = zip(stays, first.begins, later.begins, strict=True)
    return any(is_over(then, max(stay.hold, begin), later.end) for stay, begin, then in columns)


@lru_cache(REMEMBERED)
def earliest_begins(fleet: Fleet, route: Route) -> dict[int, float]:
    """Return when each visit of a route begins if its vehicle leaves as early as it may.

    The fleet has a clock, and its vehicles have no breaks and do not load again.
    """
    chain = _chain_of(fleet, route)
    return dict(zip(path_of(fleet.rules, route), drive(chain, chain.begin).begins, strict=True))


def _stays(rules: Rules, route: Route, trips: Sequence[Sequence[int]]) -> list[Stay]:
    """Return what is asked for at each stop of `path_of`.

    A trip begins when all that it brings is released.
    """
    vehicle, visits = rules.vehicles[route.vehicle], rules.visits
    stays = [
        Stay(
            rules.windows[stop],
            rules.service(route.vehicle, stop),
            visits[stop].due,
            rules.holds[stop],
        )
        for stop in route.stops
    ]
    for stop, since, until in route.bounds:
        place = route.stops.index(stop)
        windows, service, due, hold = stays[place]
        stays[place] = Stay(_open_since(windows, since), service, due, min(hold, until))
    if len(trips) > 1:
        released = iter(trips[1:])
        for place, stop in enumerate(route.stops):
            if stop in vehicle.reload:
                stays[place] = Stay(((_released(rules, next(released)), inf),), 0.0, inf)
    start, end = ([] if each is None else [_FREE] for each in (vehicle.start, vehicle.end))
    return [*start, *stays, *end]


def _open_since(windows: Sequence[Span], since: float) -> tuple[Span, ...]:
    """Return the windows of a stop from a time on; all if none is open then."""
    later = ((max(opens, since), closes) for opens, closes in windows if not is_over(since, closes))
    return tuple(later) or tuple(windows)


def _released(rules: Rules, trip: Sequence[int]) -> float:
    return max((rules.visits[stop].release for stop in trip), default=0.0)


def trips_of(rules: Rules, route: Route) -> list[list[int]]:
    """Return the visits of each trip of a route; a trip ends where the vehicle loads again."""
    reload = rules.vehicles[route.vehicle].reload
    if not reload:
        return [list(route.stops)]
    trips: list[list[int]] = [[]]
    for stop in route.stops:
        if stop in reload:
            trips.append([])
        else:
            trips[-1].append(stop)
    return trips


def legs(fleet: Fleet, route: Route, objective: int) -> list[float]:
    """Return what the legs of a route cost its vehicle in one objective.

    Over the day these are the costs at the times of the route.
    """
    path = path_of(fleet.rules, route)
    if fleet.day is None:
        speed = fleet.rules.speed(route.vehicle, objective)
        return [leg / speed for leg in fleet.legs_along(objective, path, route.vehicle)]
    times = schedule(fleet, route)
    if objective == fleet.rules.clock:
        driven = zip(times.leaves, times.arrivals[1:], strict=False)
        return [after - leaves for leaves, after in driven]
    costs = fleet.day_by(route.vehicle)[objective]
    between = zip(times.leaves, pairwise(path), strict=False)
    return [costs.at(leaves, *leg) for leaves, leg in between]


def _legs_of_day(fleet: Fleet, route: Route) -> list[Leg]:
    path, vehicle = path_of(fleet.rules, route), fleet.rules.vehicles[route.vehicle]
    pace = vehicle.speed_factor, vehicle.profile
    return [_leg_of_day(fleet, pace, a, b) for a, b in pairwise(path)]


@lru_cache(4 * REMEMBERED)
def _leg_of_day(fleet: Fleet, pace: tuple[float, int], a: int, b: int) -> Leg:
    speed, profile = pace
    assert fleet.rules.clock is not None
    return leg_of(fleet.days[profile][fleet.rules.clock], a, b, speed)


class Wait(NamedTuple):
    """Two stops that a plan visits: the second visit begins a gap after the end of the first."""

    first: int
    then: int
    gap: float


@lru_cache(REMEMBERED)
def with_waits(fleet: Fleet, plan: Plan) -> Plan:
    """Return a plan whose routes know the bounds of the visits that wait for others.

    Every visit begins as early as the order of all routes allows. Then each vehicle leaves as late
    as delays neither the end of its own route nor a visit on another one.
    Where visits wait for each other in a circle, some begin before others have ended.
    """
    waits = _waits(fleet, plan)
    if not waits:
        return plan
    services = _services(fleet, plan)
    since: dict[int, float] = {}
    begins = _begins(fleet, plan, since)
    for _ in waits:  # a chain of them is as long at most
        known, since = since, _since(waits, begins, services)
        if since == known:
            break
        begins = _begins(fleet, plan, since)
    until: dict[int, float] = {}
    for first, then, gap in waits:
        latest = begins[then] - gap - services[first]
        until[first] = min(latest, until.get(first, inf))
    return Plan(tuple(_bounded(route, since, until) for route in plan.routes))


def broken_waits(fleet: Fleet, plan: Plan) -> Iterator[Wait]:
    """Yield the pairs of visits of a plan, as with_waits() returns it, that keep no order."""
    waits = _waits(fleet, plan)
    begins: dict[int, float] = {}
    for route in plan.routes if waits else ():
        path = path_of(fleet.rules, route)
        begins |= zip(path, schedule(fleet, route).begins, strict=True)
    services = _services(fleet, plan)
    for each in waits:
        end = begins[each.first] + services[each.first] + each.gap
        if is_over(end, begins[each.then]):
            yield each


def _waits(fleet: Fleet, plan: Plan) -> list[Wait]:
    """Return the visits of a plan that wait for others.

    Where one route has both and there is no gap, the order on the route says it all.
    """
    waiting = fleet.rules.groups.waiting
    if not waiting:
        return []
    routes = {stop: number for number, route in enumerate(plan.routes) for stop in route.stops}
    return [
        Wait(first, then, gap)
        for (first, then), gap in waiting.items()
        if first in routes and then in routes and (gap or routes[first] != routes[then])
    ]


def _services(fleet: Fleet, plan: Plan) -> Times:
    rules = fleet.rules
    return {s: rules.service(route.vehicle, s) for route in plan.routes for s in route.stops}


def _begins(fleet: Fleet, plan: Plan, since: Times) -> Times:
    """Return when each visit of a plan begins at the earliest, if some begin no earlier."""
    begins: dict[int, float] = {}
    for route in plan.routes:
        begins |= earliest_begins(fleet, _bounded(route, since, {}))
    return begins


def _since(waits: Sequence[Wait], begins: Times, services: Times) -> dict[int, float]:
    """Return from when on visits may begin that wait for others."""
    since: dict[int, float] = {}
    for first, then, gap in waits:
        since[then] = max(begins[first] + services[first] + gap, since.get(then, 0.0))
    return since


def _bounded(route: Route, since: Times, until: Times) -> Route:
    bounds = (
        (stop, since.get(stop, 0.0), until.get(stop, inf))
        for stop in route.stops
        if stop in since or stop in until
    )
    return replace(route, bounds=tuple(bounds))
