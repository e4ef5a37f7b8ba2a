"""Check conditions that every feasible plan needs; the first that fails names what to change."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache, partial
from math import ceil, inf
from operator import le

import numpy as np
from numpy.typing import NDArray

from service.errors import CityNames, Fault, NoTour, Obstacle, Refusal
from service.fleet.costs import Day
from service.fleet.evaluation import first_broken
from service.fleet.fleet import LAYERS, Array, Fleet
from service.fleet.groups import NO_GROUPS
from service.fleet.plans import Route
from service.fleet.rounding import is_over
from service.fleet.rules import Rules
from service.fleet.vehicles import ALWAYS, VehicleType

NAMES = CityNames("stop")


def check_necessary(fleet: Fleet, ended: Callable[[], bool] = lambda: False) -> None:
    """Raise a refusal if a stop fits no vehicle, or all stops together do not fit all vehicles.

    `ended` is called often; once it returns True, slow conditions are left out.

    Raises:
        NoTour: A necessary condition fails for some stops.
        Refusal: There is no vehicle, or a condition fails for all stops together. If none fails, a
            plan may still not exist.
    """
    rules = fleet.rules
    check_left(rules)
    _refuse(_unserved(rules))
    _refuse(_too_heavy(rules))
    _check_totals(rules)
    _refuse(_without_ways(fleet))
    _refuse(_shipped_too_late(rules))
    _refuse(_waiting_too_long(rules))
    _refuse(_unreachable(fleet, ended))


def check_left(rules: Rules) -> None:
    """Raise a refusal if there is no vehicle: while a fleet is replanned, all may be away."""
    if not any(vehicle.count for vehicle in rules.vehicles):
        raise Refusal("no-plan", errors=[Fault("no-vehicle-left")])


def _refuse(obstacles: Iterator[Obstacle]) -> None:
    """Raise NoTour if there are obstacles."""
    if found := list(obstacles):
        raise NoTour(found, NAMES)


def least_lengths(fleet: Fleet) -> Array:
    """Return lower bounds on m lengths of plans, shape (m,), that are cheap to compute. O(n^2).

    If all vehicles have a start, a leg must lead to each required stop; if all have an end, a leg
    must lead away from it.
    """
    rules = fleet.rules
    required = _required(rules)
    nearest = [fleet.nearest(layer) for layer in range(LAYERS)]
    longest = np.array([over == "max" for over in rules.over])
    least = np.zeros(len(rules.layers))
    for number, end in enumerate(("start", "end")):
        if required and all(getattr(vehicle, end) is not None for vehicle in rules.vehicles):
            of_stops = np.array([nearest[layer][number][required] for layer in rules.layers])
            total = np.where(longest, of_stops.max(axis=1), of_stops.sum(axis=1))
            least = np.maximum(least, total)
    least[[over not in ("sum", "max") for over in rules.over]] = 0.0
    least[0] *= min(vehicle.per_distance for vehicle in rules.vehicles)
    kinds = range(len(rules.vehicles))
    fastest = [max(rules.speed(kind, layer) for kind in kinds) for layer in rules.layers]
    return least / fastest


def least_longest(fleet: Fleet) -> float:
    """Return a length in the swept costs that the longest route of each plan has at least."""
    rules = fleet.rules
    if rules.swept is None:
        return 0.0
    there: dict[int | None, Array] = {None: np.zeros(rules.n)}
    back = there.copy()
    for vehicle in rules.vehicles:
        if vehicle.start is not None and vehicle.start not in there:
            there[vehicle.start] = fleet.least_paths(rules.swept, [vehicle.start])
        if vehicle.end is not None and vehicle.end not in back:
            back[vehicle.end] = fleet.least_paths(rules.swept, [vehicle.end], back=True)
    required = [stop for stop in rules.clients if rules.visits[stop].prize is None]
    ways = []
    for kind, vehicle in enumerate(rules.vehicles):
        way = (there[vehicle.start] + back[vehicle.end]) / rules.speed(kind, rules.swept)
        served = [rules.service(kind, stop) for stop in required]
        ways.append(way[required] + (np.array(served) if rules.swept == rules.clock else 0.0))
    alone = np.min(ways, axis=0)
    return float(alone.max(initial=0.0, where=np.isfinite(alone)))


def _required(rules: Rules) -> list[int]:
    """Return the required stops; a shipment counts as its pick-up alone."""
    deliveries = {each.delivery for each in rules.shipments}
    return [
        stop
        for stop in rules.clients
        if stop not in deliveries and rules.visits[stop].prize is None
    ]


def _unserved(rules: Rules) -> Iterator[Obstacle]:
    """Yield the stops that no vehicle may visit."""
    for stop in _required(rules):
        if not rules.servers(stop):
            yield Obstacle("no-skills", (stop,))


def _too_heavy(rules: Rules) -> Iterator[Obstacle]:
    """Yield the stops whose demand exceeds the capacity of every vehicle."""
    for stop in _required(rules):
        # Each of every dimension, or empty.
        loads = (rules.visits[stop].demand, rules.visits[stop].pickup)
        vehicles = [rules.vehicles[each] for each in rules.servers(stop)]
        if not any(all(_fits(load, vehicle) for load in loads) for vehicle in vehicles):
            some = len(vehicles) < len(rules.vehicles)
            yield Obstacle("too-heavy-for-its-vehicles" if some else "too-heavy", (stop,))


def _fits(load: tuple[int, ...], vehicle: VehicleType) -> bool:
    return all(map(le, load, vehicle.capacity))


def _check_totals(rules: Rules) -> None:
    """Raise a refusal if all vehicles together hold less than the required demand."""
    for name in ("demand", "pickup"):
        for dimension, total in enumerate(_totals(rules, name)):
            most = sum(_holds(vehicle, dimension) for vehicle in rules.vehicles)
            if total > most:
                which = f" in number {dimension + 1} of each" if rules.dimensions > 1 else ""
                hold = f"all vehicles together hold {int(most)}"
                raise Refusal("no-plan", reason=f"the {name}s sum to {total}{which}, and {hold}")
    limits = [(each.count, each.max_stops) for each in rules.vehicles]
    stops = sum(inf if each is None else count * each for count, each in limits)
    if len(_required(rules)) > stops:
        many = f"{len(_required(rules))} stops must be visited"
        raise Refusal("no-plan", reason=f"{many}, and all vehicles together may visit {stops}")


def fewest_vehicles(rules: Rules, times: float = 1.0) -> int:
    """Return how many vehicles every plan needs at least to bring so many times the demands."""
    fewest = 1
    for dimension, total in enumerate(_totals(rules)):
        left, vehicles = times * total, 0
        for each in sorted(rules.vehicles, key=lambda each: -_brings(each, dimension)):
            brings = _brings(each, dimension)
            needed = min(each.count, ceil(left / brings)) if left > 0 and brings > 0 else 0
            left, vehicles = left - needed * brings, vehicles + needed
        fewest = max(fewest, vehicles)
    return fewest


def _totals(rules: Rules, name: str = "demand") -> list[int]:
    """Return the sum of a load of all stops that must be visited, in each dimension."""
    alone = [stop for stop in _required(rules) if stop not in rules.shipped]
    loads = [load for stop in alone if (load := getattr(rules.visits[stop], name))]
    return [sum(each[dimension] for each in loads) for dimension in range(rules.dimensions)]


def _holds(vehicle: VehicleType, dimension: int) -> float:
    """Return the load that all vehicles of a type can bring on all of their trips."""
    brings = _brings(vehicle, dimension)
    return vehicle.count * brings if brings else 0.0


def _brings(vehicle: VehicleType, dimension: int) -> float:
    """Return the load that a vehicle can bring on all of its trips."""
    capacity = vehicle.capacity[dimension]
    initial = vehicle.initial_load[dimension] if vehicle.initial_load else 0
    trips = 1.0 if not vehicle.reload else inf if vehicle.max_trips is None else vehicle.max_trips
    return capacity * trips - initial if capacity else 0.0


def _unreachable(fleet: Fleet, ended: Callable[[], bool]) -> Iterator[Obstacle]:
    """Yield the stops that no vehicle can serve, even on a route of their own.

    If a detour over another stop may be shorter, this condition is not necessary.
    """
    rules = fleet.rules
    if not rules.has_bounds:
        return
    # With other stops on the way, there may be a place for a break, and the route is longer.
    vehicles = tuple(replace(each, breaks=(), min_stops=0, shortest=0.0) for each in rules.vehicles)
    fleet = fleet.under(replace(rules, vehicles=vehicles, groups=NO_GROUPS))
    triangle = cache(partial(_triangle_holds, fleet, ended))
    deliveries = {each.pickup: (each.delivery,) for each in rules.shipments}
    pinned = any(visit.vehicles for visit in rules.visits)
    different = {
        (replace(each, count=1, fixed=0.0), pinned and i): i
        for i, each in enumerate(rules.vehicles)
    }
    for stop in _required(rules):
        stops = (stop, *deliveries.get(stop, ()))
        routes = (
            Route(vehicle, (*reload, *stops))
            for vehicle in different.values()
            for reload in [(), *((stop,) for stop in rules.vehicles[vehicle].reload)]
        )
        served = any(ended() or not first_broken(fleet, route) for route in routes)
        if not served and triangle():
            bounds = _bounds_of(rules, stop)
            yield Obstacle("out-of-reach", (stop,), values={"bounds": bounds})


def _bounds_of(rules: Rules, stop: int) -> list[str]:
    """Return what bounds the visit of a stop, as the table of obstacles names it."""
    vehicles = [rules.vehicles[each] for each in rules.servers(stop)]
    bounds = {
        "window": rules.visits[stop].windows != (ALWAYS,),
        "shift": any(each.shift != ALWAYS for each in vehicles),
        "longest": any(each.longest < inf for each in vehicles),
        "max_distance": any(each.max_distance < inf for each in vehicles),
        "max_driving": any(each.max_driving < inf for each in vehicles),
    }
    return [name for name, given in bounds.items() if given] or ["route"]


def _without_ways(fleet: Fleet) -> Iterator[Obstacle]:
    """Yield the required stops to which no vehicle has a way, and from there a way to its end."""
    if not fleet.forbids:
        return
    rules = fleet.rules
    ends = {(vehicle.start, vehicle.end) for vehicle in rules.vehicles}
    to = {start: _connected(fleet, start, back=False) for start in {start for start, _ in ends}}
    back = {end: _connected(fleet, end, back=True) for end in {end for _, end in ends}}
    deliveries = {each.pickup: each.delivery for each in rules.shipments}
    required = _required(rules)
    for stop in sorted([*required, *(deliveries[s] for s in required if s in deliveries)]):
        if not any(to[start][stop] for start, _ in ends):
            yield Obstacle("no-way-from-start", (stop,))
        elif not any(back[end][stop] for _, end in ends):
            yield Obstacle("no-way-to-end", (stop,))
        elif not any(to[start][stop] and back[end][stop] for start, end in ends):
            yield Obstacle("no-way-through", (stop,))


def _connected(fleet: Fleet, end: int | None, *, back: bool) -> NDArray[np.bool_]:
    """Return which stops can be reached from one stop, or from which it can, shape (n,).

    From anywhere, all can.
    """
    starts = range(fleet.rules.n) if end is None else [end]
    return np.isfinite(fleet.least_paths(0, starts, back=back))


def _shipped_too_late(rules: Rules) -> Iterator[Obstacle]:
    """Yield the shipments that must be delivered before they can be picked up."""
    for each in rules.shipments:
        pickup = rules.visits[each.pickup]
        opens, closes = pickup.windows[0][0], rules.windows[each.delivery][0][1]
        soonest = opens + min(rules.service(k, each.pickup) for k in range(len(rules.vehicles)))
        if pickup.prize is None and is_over(soonest, closes):
            yield Obstacle("delivered-too-early", (each.delivery,), (each.pickup,))


def _waiting_too_long(rules: Rules) -> Iterator[Obstacle]:
    """Yield the stops whose windows close before the visits that they wait for can have ended."""
    required = set(_required(rules))
    for (first, then), gap in rules.groups.waiting.items():
        service = min(rules.service(kind, first) for kind in range(len(rules.vehicles)))
        soonest = rules.visits[first].windows[0][0] + service + gap
        if {first, then} <= required and is_over(soonest, rules.windows[then][-1][1]):
            yield Obstacle("waits-too-long", (then,), (first,))


def _triangle_holds(fleet: Fleet, ended: Callable[[], bool]) -> bool:
    """Return whether no detour over a stop is shorter, in the costs that are bounded.

    False if legs are forbidden, since then a detour may be the only way to a stop, if some legs
    become slower over the day than others or the legs of a day are bounded by themselves, which
    then depend on the departure, and if it ended before all detours were tried.
    """
    rules = fleet.rules
    if fleet.forbids or (fleet.day is not None and _is_uneven(fleet.day, rules)):
        return False
    if fleet.lines:
        return True
    layers = {*rules.capped, *(() if rules.limited is None else (rules.limited,))}
    return all(_has_no_detours(fleet, layer, ended) for layer in layers)


def _is_uneven(day: Day, rules: Rules) -> bool:
    return bool(rules.capped) or day[rules.limited or 0].varies


def _has_no_detours(fleet: Fleet, layer: int, ended: Callable[[], bool]) -> bool:
    """Return whether no detour over a stop is shorter; False if it ended before all were tried."""
    slack = 1e-9 * fleet.largest_legs[layer]
    return all(
        not ended() and (costs[layer, :, [k]].T + costs[layer, [k]] >= costs[layer] - slack).all()
        for costs in fleet.profiles or (fleet.costs,)
        for k in range(fleet.rules.n)
    )
