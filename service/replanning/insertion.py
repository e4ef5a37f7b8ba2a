"""Insert new cities into the rest of the tours of an earlier front. Partly compiled."""

import numpy as np
from numpy.typing import NDArray
from paretour.choice import losses

from service.instance import Instance, step_lengths, tour_steps
from service.jit import compiled
from service.objectives import OBJECTIVES
from service.replanning.earlier_tours import EarlierTours, Tours
from service.search.closing import closed_tours, opened_tours
from service.search.costs import Costs, make_costs, step_costs, weighted_costs

Array = NDArray[np.float64]
_LEAST_WEIGHT = 1e-3  # of three or four objectives: so that all count


def completed(instance: Instance, earlier: EarlierTours) -> Tours:
    """Return the earlier tours with the other cities of an instance inserted, shape (k, n).

    Each city in turn goes where it costs least under a weighted sum of the lengths. The weights
    differ by tour, and are greatest for the objective under which it is best. A route between two
    fixed ends is first reversed if that is shorter under its weights, except for the driven one.
    O(k n a) for a cities that are inserted.
    """
    lengths = _scaled_lengths(instance, earlier.tours)
    weights = _weights(lengths)
    routes = _better_way_round(instance, earlier.tours, (lengths * weights).sum(axis=1), weights)
    known = np.isin(np.arange(instance.n), routes[0])
    added = np.flatnonzero(~known)
    tours = np.concatenate((routes, np.tile(added, (len(routes), 1))), axis=1).astype(np.int32)
    tours = closed_tours(instance, tours)
    scaled = weights / np.ldexp(instance.scale, instance.shifts)
    begun = tours.shape[1] - len(added)
    costs = make_costs(instance)
    if instance.objectives == OBJECTIVES:
        insert_cheapest(costs, tours, begun, scaled)
    else:
        alone = np.array([[1.0, 0.0]])
        for k, each in enumerate(scaled):
            insert_cheapest(weighted_costs(costs, each), tours[k : k + 1], begun, alone)
    return opened_tours(instance, tours).astype(np.int64)


def _scaled_lengths(instance: Instance, tours: Tours) -> Array:
    """Return lengths in units of scale, shape (k, m); finite even if a leg is now forbidden."""
    steps = step_lengths(instance, *tour_steps(instance, tours))
    return steps.sum(axis=1) / instance.scale


def _weights(lengths: Array) -> Array:
    """Return the weights of scaled lengths, shape (k, m), rows adding to 1.

    Of two objectives they are by the rank of each route in balance: of that with the least first
    length (1, 0), of that with the least second (0, 1). Of more they are by what it does not lose.
    """
    if lengths.shape[1] > OBJECTIVES:
        kept = (1 - losses(lengths)).clip(_LEAST_WEIGHT)
        weights: Array = kept / kept.sum(axis=1, keepdims=True)
        return weights
    rank = (lengths[:, 0] - lengths[:, 1]).argsort(kind="stable").argsort(kind="stable")
    share = rank / max(1, len(lengths) - 1)
    return np.stack((1 - share, share), axis=1)


def _better_way_round(instance: Instance, routes: Tours, sums: Array, weights: Array) -> Tours:
    """Return the routes, reversed if that makes the weighted sum of their lengths less."""
    if instance.closed or not instance.symmetric:
        return routes
    begin = int(instance.start is not None)
    end = routes.shape[1] - int(instance.end is not None)
    turned = routes.copy()
    turned[:, begin:end] = routes[:, begin:end][:, ::-1]
    better = (_scaled_lengths(instance, turned) * weights).sum(axis=1) < sums
    better[0] = False
    return np.where(better[:, np.newaxis], turned, routes)


@compiled
def insert_cheapest(costs: Costs, tours: NDArray[np.int32], begun: int, weights: Array) -> None:
    """Insert the cities after the first `begun` of closed tours, shape (m, n), in place."""
    for k in range(len(tours)):
        tour = tours[k]
        for size in range(begun, len(tour)):
            city = tour[size]
            least, place = np.inf, size
            for i in range(size):
                before, after = tour[i], tour[i + 1 if i + 1 < size else 0]
                to, on, direct = (
                    step_costs(costs, before, city),
                    step_costs(costs, city, after),
                    step_costs(costs, before, after),
                )
                more = weights[k, 0] * (to[0] + on[0] - direct[0])
                more += weights[k, 1] * (to[1] + on[1] - direct[1])
                if more < least:
                    least, place = more, i + 1
            for i in range(size, place, -1):
                tour[i] = tour[i - 1]
            tour[place] = city


def warm_up() -> None:
    """Compile the insertion, or load it from the cache of an earlier process."""
    cities = np.arange(4.0)
    coordinates = np.stack([cities, cities**2, cities**2, cities], axis=1)
    begun = EarlierTours(np.array([[0, 1, 2]]))
    for closed in (True, False):
        completed(Instance(coordinates=coordinates, closed=closed), begun)
