"""Promises: which vehicle visits each stop, and when, in a plan that is driven or was promised.

A change is a promised stop that another vehicle visits, or later than promised by more than a
tolerance, or nobody. So that vehicles of one type are told apart, each route of that plan gets a
type of its own, of one vehicle.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from math import inf
from typing import NamedTuple

from service.fleet.rounding import is_over
from service.fleet.vehicles import VehicleType, Visit


class Types(NamedTuple):
    """Types of vehicles of which some have a single vehicle, for one route.

    Attributes:
        vehicles: The types.
        old: The number of the type that each was before.
        of_routes: The number of the type of each route.
    """

    vehicles: tuple[VehicleType, ...]
    old: tuple[int, ...]
    of_routes: tuple[int, ...]


def types_by_route(vehicles: Sequence[VehicleType], routes: Sequence[int]) -> Types:
    """Return types of which each of some routes has one of its own, given their types so far.

    Raises:
        ValueError: There are more routes of a type than vehicles.
    """
    used, found, old = Counter(routes), list[VehicleType](), list[int]()
    of_routes = [0] * len(routes)
    for number, vehicle in enumerate(vehicles):
        if used[number] > vehicle.count:
            raise ValueError(f"type {number} has {vehicle.count} vehicles, got {used[number]}")
        for place, kind in enumerate(routes):
            if kind == number:
                of_routes[place] = len(found)
                found.append(replace(vehicle, count=1, home=vehicle.start))
                old.append(number)
        if left := vehicle.count - used[number]:
            found.append(replace(vehicle, count=left))
            old.append(number)
    return Types(tuple(found), tuple(old), tuple(of_routes))


def promised(visit: Visit, vehicle: int, arrival: float | None, slack: float) -> Visit:
    """Return a stop as it is promised.

    Args:
        vehicle: The type of vehicles that visits it; -1 if that has gone.
        arrival: When the vehicle arrives; None if that is not known.
        slack: How long before a window closes it must.
    """
    begin = inf if arrival is None else begin_of(visit, arrival, slack)
    return replace(visit, promised_to=vehicle, promised_by=begin)


def begin_of(visit: Visit, arrival: float, slack: float) -> float:
    """Return when a visit begins, in the first window that is not over or else in the last."""
    opens = [opens for opens, closes in visit.windows if not is_over(arrival, closes - slack)]
    return max(arrival, opens[0] if opens else arrival)
