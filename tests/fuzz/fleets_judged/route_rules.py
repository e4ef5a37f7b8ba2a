"""The rules that a route keeps whenever it is driven: skills, counts, trips, loads and groups."""

from collections.abc import Iterator
from itertools import accumulate
from math import inf

from tests.fuzz.fleets_judged.timeline import Json, trips_of


class RouteRules:
    """Knows the rules of a request that do not depend on times or ways.

    Args:
        request: The request, whose references to stops are numbers.
    """

    def __init__(self, request: Json) -> None:
        self.request = request
        self.stops = request["stops"]
        self.shipments = [(each["pickup"], each["delivery"]) for each in request["shipments"]]
        self.pickup_of = {delivery: pickup for pickup, delivery in self.shipments}

    def broken(self, vehicle: Json, stops: list[int]) -> Iterator[str]:
        """Yield the rules that a route breaks."""
        trips = trips_of(vehicle, stops)
        visited = [stop for trip in trips for stop in trip]
        if any(not self._may_visit(vehicle, self.stops[stop]) for stop in visited):
            yield "skills or vehicle"
        if len(visited) > vehicle.get("max_stops", inf):
            yield "max_stops"
        if len(trips) > vehicle.get("max_trips", inf) or not all(trips[1:]):
            yield "max_trips"
        if any(
            max(self.loads(vehicle, trips, number, dimension)) > capacity
            for dimension, capacity in enumerate(vehicle.get("capacity", ()))
            for number in range(len(trips))
        ):
            yield "capacity"
        if len(visited) < vehicle.get("min_stops", 0):
            yield "min_stops"
        yield from self._groups_broken(visited)
        for pickup, delivery in self.shipments:
            # Both or neither are visited, in this order.
            if [stop for stop in visited if stop in (pickup, delivery)] not in (
                [],
                [pickup, delivery],
            ):
                yield "shipment"

    def _groups_broken(self, visited: list[int]) -> Iterator[str]:
        """Yield the rules about groups of stops that a route breaks."""
        inside = set(visited)
        for group in self.request.get("together", ()):
            if inside & set(group) and not set(group) <= inside:
                yield "together"
        for each in self.request.get("apart", ()):
            stops, others = set(each["stops"]) & inside, set(each.get("others", ())) & inside
            if (stops and others) or (not each.get("others") and len(stops) > 1):
                yield "apart"
        for each in self.request.get("before", ()):
            last = max((visited.index(stop) for stop in each["first"] if stop in inside), default=0)
            if any(visited.index(stop) < last for stop in each["then"] if stop in inside):
                yield "before"

    def _may_visit(self, vehicle: Json, visit: Json) -> bool:
        able = set(visit.get("skills", ())) <= set(vehicle.get("skills", ()))
        return able and visit.get("vehicle") in (None, vehicle["id"])

    def loads(
        self, vehicle: Json, trips: list[list[int]], number: int, dimension: int
    ) -> list[int]:
        """Return the load on a trip: at its start, and after each visit."""
        deliveries = dict(self.shipments)
        loads = []
        for stop in trips[number]:
            demand = self.stops[self.pickup_of.get(stop, stop)].get("demand") or [0] * 9
            taken = self.stops[stop].get("pickup") or [0] * 9
            brought = -demand[dimension] if stop not in deliveries else demand[dimension]
            loads.append(brought + taken[dimension])
        shipped = {*deliveries, *self.pickup_of}
        demands = [self.stops[s].get("demand") for s in trips[number] if s not in shipped]
        first = sum(demand[dimension] for demand in demands if demand)
        if number == 0 and vehicle.get("initial_load"):
            first += vehicle["initial_load"][dimension]
        return list(accumulate(loads, initial=first))
