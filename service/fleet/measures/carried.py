"""Work out what vehicles carry on their routes: the load at each step, and how far it goes."""

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import accumulate

from service.fleet.fleet import Fleet
from service.fleet.plans import Route
from service.fleet.rules import Rules
from service.fleet.schedule import REMEMBERED, legs, trips_of


@lru_cache(REMEMBERED)
def load_distance(fleet: Fleet, route: Route) -> float:
    """Return the sum over the legs of the first costs times the load, in its first dimension."""
    vehicle = fleet.rules.vehicles[route.vehicle]
    first, *others = trips_of(fleet.rules, route)
    # The loads before and after each stop. Open routes have no leg at that end.
    loads = [*loads_on(fleet.rules, first, 0, vehicle.initial_load)]
    loads += [load for trip in others for load in loads_on(fleet.rules, trip, 0, ())]
    loads = loads[vehicle.start is None : len(loads) - (vehicle.end is None)]
    return sum(cost * load for cost, load in zip(legs(fleet, route, 0), loads, strict=True))


def most_carried(rules: Rules, route: Route) -> list[int]:
    """Return the most that a vehicle carries at a time on its route, in each dimension."""
    first = rules.vehicles[route.vehicle].initial_load
    trips = list(enumerate(trips_of(rules, route)))
    return [
        max(max(loads_on(rules, trip, each, () if number else first)) for number, trip in trips)
        for each in range(rules.dimensions)
    ]


def loads_on(
    rules: Rules, trip: Sequence[int], dimension: int, initial_load: Sequence[int]
) -> Iterator[int]:
    """Return the load on a trip in one dimension, at its start and after each visit.

    At the start it is the demand of all stops that are not in shipments, and the initial load,
    which stays on board, as do the pick-ups of stops.
    """
    pickups = {each.delivery: each.pickup for each in rules.shipments}

    def change(stop: int) -> int:
        demand = rules.visits[pickups.get(stop, stop)].demand
        load = demand[dimension] if demand else 0
        taken = rules.visits[stop].pickup
        on = taken[dimension] if taken else 0
        return load if stop in rules.shipped and stop not in pickups else on - load

    demands = [rules.visits[stop].demand for stop in trip if stop not in rules.shipped]
    brought = sum(demand[dimension] for demand in demands if demand)
    brought += initial_load[dimension] if initial_load else 0
    return accumulate(map(change, trip), initial=brought)
