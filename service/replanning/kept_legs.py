"""Count the legs of the driven tour that other tours keep, and choose tours that keep many."""

import numpy as np
from numpy.typing import NDArray
from paretour.choice import balances

from service.front import SearchResult
from service.instance import Instance, tour_lengths, tour_steps

Array = NDArray[np.float64]
Tours = NDArray[np.integer]
Indices = NDArray[np.intp]
_MOST_COMPARED = 100  # tours of about one balance: some milliseconds with thousands of cities
# How much longer a tour may be if it keeps more legs: a share of its length, and a share of a mean
# leg. With 1000 stops, a thousandth alone would gain two legs in a hundred and cost all of it.
_LONGER, _LEG = 1e-3, 0.125
_EQUAL = 1e-12  # lengths with a smaller relative difference count as equal, as in the search


def kept_shares(instance: Instance, tours: Tours, driven: NDArray[np.int64]) -> Array:
    """Return the share of a driven tour's legs that each tour keeps, shape (m,). O(m n).

    A leg leads from a city to the next one. If costs are the same in both directions, a leg in the
    other direction is kept too. The share is 1 if the driven tour has no legs.

    Args:
        tours: Shape (m, n).
        driven: The cities of the driven tour that are in the instance, in order, shape (k,).

    >>> corners = np.array([[0, 0, 0, 0], [3, 0, 0, 1], [3, 4, 2, 1], [0, 4, 2, 0]])
    >>> square = Instance(coordinates=corners)
    >>> kept_shares(square, np.array([[0, 3, 2, 1], [0, 2, 1, 3]]), np.array([0, 1, 2, 3]))
    array([1. , 0.5])
    """
    origins, destinations = (each[0] for each in tour_steps(instance, driven[np.newaxis]))
    legs = origins != destinations
    if not legs.any():
        return np.ones(len(tours))
    following = np.full((len(tours), instance.n), -1)
    np.put_along_axis(following, *tour_steps(instance, tours), axis=1)
    kept = following[:, origins] == destinations
    if instance.symmetric:
        kept |= following[:, destinations] == origins
    return kept[:, legs].mean(axis=1)


def most_like_driven(
    instance: Instance, tours: Tours, points: Array, others: Tours, driven: NDArray[np.int64]
) -> Tours:
    """Return tours, each replaced by another of equal lengths if that keeps more legs.

    `points` are the lengths of the tours, and there is at least one other. O(m n + m k) for m tours
    of n cities and k others.
    """
    differences = np.abs(tour_lengths(instance, others) - points[:, np.newaxis])
    equal = (differences <= _EQUAL * points[:, np.newaxis]).all(axis=2)
    if not equal.any():
        return tours
    kept, kept_of_others = (kept_shares(instance, each, driven) for each in (tours, others))
    kept_of_equal = np.where(equal, kept_of_others, -1.0)
    better = kept_of_equal.max(axis=1) > kept
    chosen = tours.copy()
    chosen[better] = others[kept_of_equal.argmax(axis=1)[better]]
    return chosen


def with_most_kept_at(
    instance: Instance,
    driven: NDArray[np.int64],
    balance: float,
    found: SearchResult,
    chosen: Indices,
) -> Indices:
    """Return the chosen tours of a front; one at a balance may be replaced.

    Its replacement keeps most legs of the driven tour. Candidates are nearer to the balance than
    the chosen tours on either side. They exceed the shortest of them by at most a thousandth, and
    by at most an eighth of a mean leg. The ends of the front stay.

    Args:
        driven: The cities of the driven tour, as in kept_shares().
        balance: The balance, in the box of the chosen tours.
        found: The front.
        chosen: Indices in it, ascending.
    """
    begin = chosen[0]
    away = np.abs(balances(found.points[begin : chosen[-1] + 1]) - balance)
    at = int(away[chosen - begin].argmin())
    if not 0 < at < len(chosen) - 1:
        return chosen
    before, after = chosen[at - 1], chosen[at + 1]
    between = np.arange(before + 1, after)
    nearest = between[np.argsort(away[between - begin], kind="stable")][:_MOST_COMPARED]
    nearer = nearest[away[nearest - begin] <= away[[before - begin, after - begin]].min()]
    longer = min(_LONGER, _LEG / instance.n)
    short = nearer[_above_shortest(found.points, before, after, nearer) <= longer]
    kept = kept_shares(instance, found.tours_at(short), driven)
    instead = chosen.copy()
    instead[at] = short[kept.argmax()]
    return instead


def _above_shortest(points: Array, before: int, after: int, between: Indices) -> Array:
    """Return by what share each point between two others exceeds the shortest of these points.

    Lengths are added with the weights under which the two others are equal.
    """
    shares = points / points[[before, after]].max(axis=0)
    weights = np.abs(shares[after] - shares[before])[::-1]
    sums: Array = shares[between] @ weights
    return sums / sums.min() - 1
