"""Conditions that every feasible plan needs: the first that fails names what to change."""

from collections.abc import Iterator
from functools import cache, partial
from itertools import chain

import numpy as np

from service.errors import Refusal
from service.fleet.evaluation import route_violations
from service.fleet.fleet import Array, Fleet, Rules, VehicleType
from service.fleet.plans import Route
from service.instance import least_steps


def check_necessary(fleet: Fleet) -> None:
    """Raise a refusal where some stop fits no vehicle, or all of them do not fit all vehicles.

    Raises:
        Refusal: A necessary condition fails; that none does is no proof of a plan.
    """
    rules = fleet.rules
    reasons = chain(
        _demands(rules),
        _totals(rules),
        _without_ways(fleet),
        _shipped_too_late(rules),
        _unreachable(fleet),
    )
    for reason in reasons:
        raise Refusal("no-plan", reason=reason)


def least_lengths(fleet: Fleet) -> Array:
    """Return lengths, shape (2,), that no plan goes below, by what is cheap. O(n^2).

    Where all vehicles have a start, a leg leads to each stop that must be visited; where all have
    an end, one leads away from it.
    """
    rules = fleet.rules
    required = _required(rules)
    steps = np.where(np.eye(rules.n, dtype=bool), np.inf, fleet.costs)
    least = np.zeros(len(steps))
    for ends, legs in (
        ([vehicle.start for vehicle in rules.vehicles], steps.min(axis=1)),
        ([vehicle.end for vehicle in rules.vehicles], steps.min(axis=2)),
    ):
        if required and None not in ends:
            of_stops = legs[:, required]
            longest = np.array([over == "max" for over in rules.over])
            total = np.where(longest, of_stops.max(axis=1), of_stops.sum(axis=1))
            least = np.maximum(least, total)
    return least


def _required(rules: Rules) -> list[int]:
    """Return the stops that must be visited, a shipment by its pick-up alone."""
    deliveries = {each.delivery for each in rules.shipments}
    return [
        stop
        for stop in rules.clients
        if stop not in deliveries and rules.visits[stop].prize is None
    ]


def _demands(rules: Rules) -> Iterator[str]:
    for stop in _required(rules):
        demand = rules.visits[stop].demand
        if demand and not any(_holds(vehicle, demand) for vehicle in rules.vehicles):
            yield f"the demand of stops/{stop} is over the capacity of every vehicle"


def _holds(vehicle: VehicleType, demand: tuple[int, ...]) -> bool:
    return all(d <= c for d, c in zip(demand, vehicle.capacity, strict=True))


def _totals(rules: Rules) -> Iterator[str]:
    """Name the dimension in which what must be brought is more than all vehicles hold."""
    brought = [stop for stop in _required(rules) if stop not in rules.shipped]
    for dimension in range(rules.dimensions):
        demands = (rules.visits[stop].demand or (0,) * rules.dimensions for stop in brought)
        total = sum(demand[dimension] for demand in demands)
        most = sum(vehicle.count * vehicle.capacity[dimension] for vehicle in rules.vehicles)
        if total > most:
            yield (
                f"the demands sum to {total} in dimension {dimension}, and all vehicles together"
                f" hold {most}"
            )


def _unreachable(fleet: Fleet) -> Iterator[str]:
    """Name a stop that no vehicle can serve even if it serves nothing else.

    Where a detour over another stop may be shorter, that is no necessary condition.
    """
    rules = fleet.rules
    triangle = cache(partial(_triangle_holds, fleet))
    deliveries = {each.pickup: (each.pickup, each.delivery) for each in rules.shipments}
    for stop in _required(rules):
        stops = deliveries.get(stop, (stop,))
        served = any(_serves(fleet, vehicle, stops) for vehicle in range(len(rules.vehicles)))
        if not served and triangle():
            yield (
                f"stops/{stop} cannot be reached within its window, the shift and the longest"
                " route of any vehicle, even on a route of its own"
            )


def _without_ways(fleet: Fleet) -> Iterator[str]:
    """Name a stop that must be visited and that no way leads to, or away from."""
    if not fleet.forbids:
        return
    leaving, entering = (least[0] for least in least_steps(fleet.costs))
    vehicles = fleet.rules.vehicles
    for stop in _required(fleet.rules):
        if np.isinf(entering[stop]) and all(each.start is not None for each in vehicles):
            yield f"no way leads to stops/{stop} from any other stop"
        if np.isinf(leaving[stop]) and all(each.end is not None for each in vehicles):
            yield f"no way leads from stops/{stop} to any other stop"


def _shipped_too_late(rules: Rules) -> Iterator[str]:
    """Name a shipment that must be delivered before it can be picked up."""
    for each in rules.shipments:
        pickup, delivery = rules.visits[each.pickup], rules.visits[each.delivery]
        if pickup.prize is None and delivery.window[1] < pickup.window[0] + pickup.service:
            yield (
                f"the window of stops/{each.delivery}, where a shipment is delivered, closes before"
                f" it can be picked up at stops/{each.pickup}"
            )


def _serves(fleet: Fleet, vehicle: int, stops: tuple[int, ...]) -> bool:
    """Return whether a vehicle can visit these stops alone."""
    return not any(route_violations(fleet, Route(vehicle, stops)))


def _triangle_holds(fleet: Fleet) -> bool:
    """Return whether no detour over a stop is shorter, in the objective that is limited.

    Where legs are forbidden, it may be that only a detour leads to a stop.
    """
    rules = fleet.rules
    objective = rules.maximum if rules.clock is None else rules.clock
    if fleet.forbids:
        return False
    if objective is None:
        return True
    costs = fleet.costs[objective]
    slack = 1e-9 * fleet.largest_legs[objective]
    return all((costs[:, [k]] + costs[[k]] >= costs - slack).all() for k in range(rules.n))
