"""Bounds on the lengths of a plan with an order, at all its places and in all slots at once.

They use the bounds on times of `screen.py`: no plan is shorter in any objective than they say.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np

from service.fleet.evaluation import joined_lengths, plan_lengths, route_lengths
from service.fleet.fleet import Array, Fleet
from service.fleet.measures.carried import load_distance
from service.fleet.plans import Plan, Route, path_of
from service.fleet.schedule import legs, schedule
from service.offers.places import Places
from service.offers.screen import Bounds
from service.offers.slots import SlottedFleet


class LeastRises:
    """The least that each length of a plan grows by with an order in one of its routes.

    Args:
        slotted: The fleet, with the order and its slots.
        plan: The plan without the order.
    """

    def __init__(self, slotted: SlottedFleet, plan: Plan) -> None:
        self._fleet, self._order = slotted.fleet, slotted.order
        self._waits = bool(slotted.fleet.rules.groups.waiting)
        self._of_routes = [self._beside(route) for route in plan.routes]
        # The parts of each length that do not depend on routes: fixed costs and lost prizes.
        empty = [(0.0,) * len(slotted.fleet.rules.over) for _ in plan.routes]
        constants = np.array(joined_lengths(slotted.fleet, plan, empty))
        self._apart = constants - np.array(plan_lengths(slotted.fleet, plan))

    def at(self, places: Places, known: Bounds) -> Array:
        """Return the least that each length grows by at p places in s slots, shape (p, s, m)."""
        rules = self._fleet.rules
        others = [each for n, each in enumerate(self._of_routes) if n != places.number]
        found = []
        vehicle = rules.vehicles[places.vehicle]
        for m, (over, layer) in enumerate(zip(rules.over, rules.layers, strict=True)):
            own = self._least_length(places, known, over, layer)
            if m == 0:
                own = vehicle.per_distance * own
                own = own + vehicle.per_time * known.duration if vehicle.per_time else own
            lengths = [each[m] for each in others]
            match over:
                case "sum" if rules.percent(m) is not None:
                    total = np.zeros(known.end.shape)
                case "max":
                    total = np.maximum(own, max(lengths, default=0.0))
                case "imbalance":
                    total = 0.0 * own if self._waits else _least_imbalance(own, lengths)
                case _:
                    total = own + sum(lengths)
            added = places.number == len(self._of_routes) and m == 0
            fixed = vehicle.fixed if added else 0.0
            found.append(total + fixed + self._apart[m])
        return np.stack(found, axis=-1)

    def _beside(self, route: Route) -> tuple[float, ...]:
        """Return the lengths of a route beside the order, or the least of them if visits wait.

        Then its visits may wait for longer, or its vehicle leave later, as the order delays others.
        """
        rules, lengths = self._fleet.rules, [*route_lengths(self._fleet, route)]
        if not self._waits:
            return tuple(lengths)
        waiting, vehicle = schedule(self._fleet, route).waiting, rules.vehicles[route.vehicle]
        for m, (over, layer) in enumerate(zip(rules.over, rules.layers, strict=True)):
            if over in rules.of_begins:
                lengths[m] = 0.0
            elif over in ("sum", "max") and layer == rules.clock:
                lengths[m] -= waiting * (1.0 if m else vehicle.per_distance)
        lengths[0] -= waiting * vehicle.per_time
        return tuple(lengths)

    def _least_length(self, places: Places, known: Bounds, over: str, layer: int) -> Array:
        """Return the least length of the route in an objective, shape (p, s)."""
        rules = self._fleet.rules
        match over:
            case "sum" | "max":
                return self._least_costs(places, known, layer)
            case "imbalance":
                return self._least_costs(places, known, rules.limited)
            case "vehicles":
                return np.ones(known.end.shape)
            case "lateness":
                return known.lateness
            case "overtime":
                return np.maximum(known.end - rules.vehicles[places.vehicle].shift[1], 0.0)
            case "load_distance" if self._fleet.day is None:
                return self._at_any_time(places, known, load_distance)
        return np.zeros(known.end.shape)  # there may be none of it

    def _least_costs(self, places: Places, known: Bounds, layer: int | None) -> Array:
        """Return the least length of the route in some costs, shape (p, s)."""
        if layer == self._fleet.rules.clock or layer is None:
            return known.duration

        def driven(fleet: Fleet, route: Route) -> float:
            if fleet.day is None:
                return sum(legs(fleet, route, layer))
            path = pairwise(path_of(fleet.rules, route))
            return sum(fleet.leg(layer, *leg, route.vehicle) for leg in path)

        return self._at_any_time(places, known, driven)

    def _at_any_time(
        self, places: Places, known: Bounds, length: Callable[[Fleet, Route], float]
    ) -> Array:
        """Return a length that is the same in all slots, shape (p, s)."""
        each = [length(self._fleet, places.route(place, self._order)) for place in places.places]
        return np.broadcast_to(np.array(each)[:, np.newaxis], known.end.shape)


def _least_imbalance(own: Array, others: Sequence[float]) -> Array:
    """Return the least difference between the longest and the shortest route.

    The route with the order may be longer than `own`, which may make the shortest one longer.
    """
    if not others:
        return np.zeros(own.shape)
    shortest, longest = min(others), max(others)
    least: Array = np.maximum(own, longest) - shortest
    return np.where(own < shortest, longest - shortest, least)
