"""The places in a plan at which an order can be inserted: in its routes, or in a new one."""

from collections.abc import Iterator
from dataclasses import dataclass

from service.fleet.fleet import Fleet
from service.fleet.left_out import open_routes
from service.fleet.plans import Plan, Route


@dataclass(frozen=True)
class Places:
    """The stops of a route, and the places among them at which the order may come.

    Args:
        number: The number of the route in the plan; that of the next one for a new route.
        vehicle: The type of its vehicle.
        stops: Its stops without the order, maybe with one more stop for loading again.
        places: How many of these stops come before the order, ascending.
    """

    number: int
    vehicle: int
    stops: tuple[int, ...]
    places: tuple[int, ...]

    def route(self, place: int, order: int) -> Route:
        """Return the route with the order at a place."""
        return Route(self.vehicle, (*self.stops[:place], order, *self.stops[place:]))


def places_in(fleet: Fleet, plan: Plan) -> Iterator[Places]:
    """Yield all places for one more stop in a plan.

    It may come anywhere in each route, or alone in the route of a vehicle that is left. A vehicle
    that may load again may do so just before the stop, or just after it.
    """
    for number, route in open_routes(fleet, plan):
        stops = route.stops
        yield Places(number, route.vehicle, stops, tuple(range(len(stops) + 1)))
        for reload in fleet.rules.vehicles[route.vehicle].reload:
            for place in range(len(stops) + 1):
                longer = (*stops[:place], reload, *stops[place:])
                yield Places(number, route.vehicle, longer, (place, place + 1))
