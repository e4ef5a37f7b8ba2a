"""Sequences of stops to cut into routes: the tours of a network through all of them."""

import numpy as np

from service.construction.first_tours import MIN_CONSTRUCTED, Constructor, construct
from service.fleet.fleet import Array, Fleet
from service.fleet.splitting.route_table import Indices
from service.instance import Instance
from service.preferences import fan

_TOURS = 21  # the number of evenly spread preferences


def network_sequences(
    fleet: Fleet, constructor: Constructor, within: float | None = None
) -> list[Indices]:
    """Return the different tours of a network through all stops to visit, shape (c,) each.

    They begin after the depot of the first type of vehicles, where it has one.

    Args:
        fleet: The fleet.
        constructor: The network, which must read matrices.
        within: The seconds that it may take; there may be fewer tours then, or none. With None the
            network builds all of them.

    Raises:
        Cancelled: The network was told to stop.
        InvalidInstance: Costs are too far apart for it.
    """
    clients = np.array(fleet.rules.clients, np.int64)
    hub = _hub(fleet)
    places = clients if hub is None else np.concatenate(([hub], clients))
    if len(places) < MIN_CONSTRUCTED:
        return [clients]
    costs = fleet.costs[:, places[:, np.newaxis], places]
    if hub is not None and np.array_equal(costs[0], costs[1]):
        # If both costs are equal, every preference leads to the same tour.
        costs = np.stack((costs[0], _angular_costs(costs[0])))
    tours = construct(constructor, Instance(matrices=costs), fan(_TOURS), within=within)
    begun = [np.roll(tour, -int(tour.argmin())) for tour in tours]
    different = np.unique(np.array(begun, np.int64).reshape(-1, len(places)), axis=0)
    return [places[tour] for tour in (different if hub is None else different[:, 1:])]


def _hub(fleet: Fleet) -> int | None:
    """Return a depot of the first type of vehicles; None if its routes are open at both ends."""
    vehicle = fleet.rules.vehicles[0]
    return vehicle.end if vehicle.start is None else vehicle.start


def _angular_costs(costs: Array) -> Array:
    """Return costs that are small between stops in the same direction from the first, the depot.

    They are the geometric mean of the cost and the sine of half the angle at the depot. The angle
    is that of a triangle whose sides are three costs. Tours of small costs sweep round the depot.
    """
    away = (costs[0] + costs[:, 0]) / 2
    sides = away[:, np.newaxis] * away
    difference = away[:, np.newaxis] - away
    with np.errstate(divide="ignore", invalid="ignore"):
        squares = (costs**2 - difference**2) / (4 * sides)
    sines = np.sqrt(np.where(sides > 0, squares, 1.0).clip(0.0, 1.0))
    return np.sqrt(costs * sines)
