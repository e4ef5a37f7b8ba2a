"""First tours made of those of an earlier front: what is left of each, with new cities in it."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, step_lengths, tour_steps
from service.jit import compiled
from service.search.closing import closed_tours, opened_tours
from service.search.costs import Costs, make_costs, step_costs

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
_LONGER = 2.0  # scaled, than any leg that is allowed
_MOST = 1e300  # of a leg's cost, where it is forbidden
MOST_TRIED = 2**25  # places of cities that are inserted, each in some ten nanoseconds


@dataclass(frozen=True, eq=False)
class EarlierTours:
    """What is left of the tours of an earlier front.

    Args:
        tours: The cities of an instance that were in the earlier front already, in the order of
            each of its tours, shape (m, k), m at least 1. The first is the tour being driven. All
            begin and end at the fixed ends of the instance, if it has any.
        min_kept: The least share of the driven tour's legs that a tour shall keep.
        touched: The cities beside which another has gone from one of the tours, or to or from which
            a cost has changed; None where that may be any.
        balance: Of the tour being driven, in the earlier front; None where it was not of that.
    """

    tours: Tours
    min_kept: float = 0.0
    touched: NDArray[np.int64] | None = None
    balance: float | None = None

    @property
    def driven(self) -> NDArray[np.int64]:
        """What is left of the tour being driven, shape (k,)."""
        return self.tours[0]


def few_enough(instance: Instance, earlier: EarlierTours, most: int = MOST_TRIED) -> EarlierTours:
    """Return the earlier tours, or fewer of them, so that to complete them takes at most a second.

    Those that stay are the one being driven, and others evenly spread.

    Args:
        instance: The instance.
        earlier: The earlier tours, shape (m, k).
        most: The most places, of all cities in all tours, that are tried to insert them.
    """
    m, k = earlier.tours.shape
    fitting = max(1, most // max(1, instance.n * (instance.n - k)))
    chosen = np.linspace(0, m - 1, min(m, fitting)).astype(np.intp)
    return replace(earlier, tours=earlier.tours[chosen])


def completed(instance: Instance, earlier: EarlierTours) -> Tours:
    """Return the earlier tours with the other cities of an instance inserted, shape (m, n).

    Each city goes, one after another, where it costs least under a weighted sum of the lengths: of
    the tour whose first length is the least, that is the first length, and so on to the second. A
    route between two fixed ends is turned round first where that is shorter under its weights, but
    for the driven one. O(m n (n - k)).
    """
    costs = make_costs(instance)
    lengths = _bounded_lengths(instance, earlier.tours)
    weights = _weights(lengths)
    routes = _better_way_round(instance, earlier.tours, (lengths * weights).sum(axis=1), weights)
    known = np.isin(np.arange(instance.n), routes[0])
    added = np.flatnonzero(~known)
    tours = np.concatenate((routes, np.tile(added, (len(routes), 1))), axis=1).astype(np.int32)
    tours = closed_tours(instance, tours)
    scaled = weights / np.ldexp(instance.scale, instance.shifts)
    insert_cheapest(costs, tours, tours.shape[1] - len(added), scaled)
    return opened_tours(instance, tours).astype(np.int64)


def touched_cities(instance: Instance, earlier: EarlierTours, tours: Tours) -> NDArray[np.int64]:
    """Return the cities where the completed earlier tours may be improved at first, ascending.

    Those are the cities touched, the ones inserted, and those before and after these.
    """
    if earlier.touched is None:
        return np.arange(instance.n)
    inserted = ~np.isin(tours, earlier.driven)
    beside = inserted | np.roll(inserted, 1, axis=1) | np.roll(inserted, -1, axis=1)
    return np.union1d(earlier.touched, tours[beside])


def _bounded_lengths(instance: Instance, tours: Tours) -> Array:
    """Return the scaled lengths of tours, shape (m, 2), with a finite one for a forbidden leg."""
    steps = step_lengths(instance, *tour_steps(instance, tours)) / instance.scale
    return np.where(np.isinf(steps), _LONGER, steps).sum(axis=1)


def _weights(lengths: Array) -> Array:
    """Return weights of scaled lengths, shape (m, 2), by the rank of each route in balance."""
    rank = (lengths[:, 0] - lengths[:, 1]).argsort(kind="stable").argsort(kind="stable")
    share = rank / max(1, len(lengths) - 1)
    return np.stack((1 - share, share), axis=1)


def _better_way_round(instance: Instance, routes: Tours, sums: Array, weights: Array) -> Tours:
    """Return the routes, those turned round whose weighted sum of lengths is less then."""
    if instance.closed or not instance.symmetric:
        return routes
    begin = int(instance.start is not None)
    end = routes.shape[1] - int(instance.end is not None)
    turned = routes.copy()
    turned[:, begin:end] = routes[:, begin:end][:, ::-1]
    better = (_bounded_lengths(instance, turned) * weights).sum(axis=1) < sums
    better[0] = False
    return np.where(better[:, np.newaxis], turned, routes)


@compiled
def insert_cheapest(costs: Costs, tours: NDArray[np.int32], begun: int, weights: Array) -> None:
    """Insert the last cities of closed tours, shape (m, n), into their first `begun`, in place."""
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
                more = 0.0
                for m in range(2):
                    # Infinite costs have no difference, and no product with a weight of 0.
                    extra = min(to[m], _MOST) + min(on[m], _MOST) - min(direct[m], _MOST)
                    more += weights[k, m] * extra
                if more < least:
                    least, place = more, i + 1
            for i in range(size, place, -1):
                tour[i] = tour[i - 1]
            tour[place] = city


def warm_up() -> None:
    """Compile what is compiled, or load it from the cache of an earlier process."""
    cities = np.arange(4.0)
    coordinates = np.stack([cities, cities**2, cities**2, cities], axis=1)
    begun = EarlierTours(np.array([[0, 1, 2]]))
    for closed in (True, False):
        completed(Instance(coordinates=coordinates, closed=closed), begun)
