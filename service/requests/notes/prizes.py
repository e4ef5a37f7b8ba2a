"""Notes on prizes that no visit is worth, as of money beside metres."""

from collections.abc import Iterator, Sequence
from math import inf

import numpy as np
from numpy.typing import NDArray

from service.fleet.fleet import LAYERS
from service.fleet.rules import Rules
from service.requests.stops import Matrix, Measured, Plane, Stops, base_of
from service.roads.great_circle import great_circle_matrix

Array = NDArray[np.float64]
_ALONG_ROADS = ("road_distance", "great_circle")  # as long as great circles, or longer


def notes_on_prizes(rules: Rules, stops: Stops, names: Sequence[str], cost: str) -> Iterator[str]:
    """Yield a sentence if each stop may be left out, and costs more than its prize if it is alone.

    Args:
        stops: Its stops, with the sources of their costs.
        cost: The name of the first objective.
    """
    prizes = np.array([rules.visits[stop].prize or 0.0 for stop in rules.clients])
    optional = all(rules.visits[stop].prize is not None for stop in rules.clients)
    if "unassigned" in rules.over or not optional or not prizes.any():
        return
    costs = _costs(stops)
    if costs is None:
        return
    alone = np.min([_alone(rules, costs, number) for number in range(len(rules.vehicles))], axis=0)
    if (alone <= prizes).any():
        return
    best = int(np.argmin(alone - prizes))
    name, prize, least = names[rules.clients[best]], prizes[best], alone[best]
    yield (
        f"No stop pays for itself: {name!r:.80} has a prize of {prize:g}, and a visit to it alone"
        f" costs {least:.6g} or more in {cost!r:.80}. Prizes are in its unit. If they are money"
        " beside metres, make the measure `unassigned` an objective."
    )


def _alone(rules: Rules, costs: Array, number: int) -> Array:
    """Return what a route of a vehicle to one stop alone costs at least, for each client."""
    vehicle, clients = rules.vehicles[number], [*rules.clients]
    there = 0.0 if vehicle.start is None else costs[vehicle.start, clients]
    back = 0.0 if vehicle.end is None else costs[clients, vehicle.end]
    legs = vehicle.per_distance * (there + back) / rules.speed(number, rules.layers[0])
    least: Array = np.full(len(clients), vehicle.fixed) + legs
    return np.where(np.isnan(least), inf, least)


def _costs(stops: Stops) -> Array | None:
    """Return costs of the first objective that are not too high; None if nothing is known of them.

    Costs by road are not known yet; those along great circles are at most as high.
    """
    if len(stops.sources) > LAYERS:  # each profile has its own
        return None
    match base_of(stops.sources[0]):
        case Matrix(costs):
            return costs
        case Plane(points):
            return np.linalg.norm(points[:, np.newaxis] - points, axis=-1)
        case Measured(measure, None) if measure in _ALONG_ROADS:
            return great_circle_matrix(stops.locations)
        case _:
            return None
