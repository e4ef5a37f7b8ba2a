"""Open routes: tours that do not return to where they began, between ends fixed or free."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from service.instance import Instance, step_lengths, tour_lengths

Array = NDArray[np.float64]
Tours = NDArray[np.integer[Any]]
_Index = TypeVar("_Index", bound=np.integer[Any])
Build = Callable[[Instance, Array], Tours]
MIN_JOINED = 3  # cities: with two ends joined to one, fewer are left than a network was trained on


def built_tours(build: Build, instance: Instance, preferences: Array) -> Tours:
    """Return tours of an instance, shape (m, n), by a network that builds closed tours.

    Its tours are opened to routes. But matrices can say that a tour leads from the fixed end to
    the fixed start, and the front is then better; other ends said by matrices make it worse.

    Args:
        build: Returns closed tours, shape (m, n): one for each preference, then maybe one more for
            each, and so on.
        instance: The instance, closed or open.
        preferences: Shape (k, 2).
    """
    if instance.closed:
        return build(instance, preferences)
    if instance.kind == "matrices" and len(instance.fixed_ends) == 2 and instance.n > MIN_JOINED:
        return _with_ends_apart(instance, build(_with_ends_joined(instance), preferences))
    # Where the first length may be long, in the direction (1, 0), only the second counts.
    tours = build(instance, preferences)
    weights = np.resize(preferences[:, ::-1], (len(tours), preferences.shape[1]))
    return opened(instance, tours, weights)


def plain_tours(instance: Instance) -> Tours:
    """Return the cities in order as a tour, shape (1, n), or as routes in both orders, (2, n).

    Of one or two cities that is every tour.
    """
    order = np.arange(instance.n)[np.newaxis]
    if instance.closed:
        return order
    return moved_ends(instance, np.concatenate((order, order[:, ::-1])))


def rotated(tours: NDArray[_Index], places: NDArray[np.intp]) -> NDArray[_Index]:
    """Return closed tours, shape (k, n), each from another place on, 0 to n, shape (k,)."""
    k, n = tours.shape
    twice = np.concatenate((tours, tours), axis=1)  # so that no tour ends where it goes on
    begins = places + 2 * n * np.arange(k)
    return twice.reshape(-1).take(begins[:, np.newaxis] + np.arange(n))


def moved_ends(instance: Instance, tours: Tours) -> Tours:
    """Return tours, shape (k, n), with each fixed end taken out and put where it belongs."""
    place = np.ones(instance.n, np.intp)
    if instance.end is not None:
        place[instance.end] = 2
    if instance.start is not None:
        place[instance.start] = 0
    return np.take_along_axis(tours, np.argsort(place[tours], axis=1, kind="stable"), axis=1)


def oriented(instance: Instance, routes: Tours) -> Tours:
    """Return open routes, shape (k, n), each in the direction in which it is reported.

    Where the direction makes no difference that is from the fixed start, or to the fixed end, or
    else from the end with the lower number.
    """
    if instance.closed or not instance.symmetric:
        return routes
    first, last = routes[:, 0], routes[:, -1]
    if instance.start is not None:
        backward = first != instance.start
    elif instance.end is not None:
        backward = last != instance.end
    else:
        backward = first > last
    return np.where(backward[:, np.newaxis], routes[:, ::-1], routes)


def opened(instance: Instance, tours: Tours, weights: Array) -> Tours:
    """Return closed tours, shape (k, n), opened to routes between an instance's ends.

    Each is opened where the route becomes shortest under a weighted sum of scaled lengths, weights
    of shape (k, 2). Without fixed ends its longest step is left out. From a fixed start, or
    backward from a fixed end, the rest is cut in two; one part is turned round or, where costs
    differ by direction, put before the other. Of two fixed ends, one is first taken out. O(k n).
    """
    if instance.closed:
        return tours
    if instance.start is None and instance.end is not None:
        return opened(_turned(instance), tours[:, ::-1], weights)[:, ::-1]
    if instance.start is None:
        steps = _weighted(instance, tours, np.roll(tours, -1, axis=1), weights)
        return oriented(instance, rotated(tours, steps.argmax(axis=1) + 1))
    routes = _from_start(instance, tours, weights)
    if not instance.symmetric:
        return routes
    others = _from_start(instance, tours[:, ::-1], weights)
    lengths, other_lengths = (
        (tour_lengths(instance, each) / instance.scale * weights).sum(axis=1)
        for each in (routes, others)
    )
    return np.where((lengths <= other_lengths)[:, np.newaxis], routes, others)


def _with_ends_joined(instance: Instance) -> Instance:
    """Return closed tours' instance, by matrices, in which a route's end is a part of its start.

    Who comes to the start in it comes to the end, and leaves from the start.
    """
    assert instance.matrices is not None
    costs = instance.matrices.copy()
    costs[:, :, instance.start] = costs[:, :, instance.end]
    kept = np.arange(instance.n) != instance.end
    return Instance(matrices=costs[:, kept][:, :, kept])


def _with_ends_apart(instance: Instance, tours: Tours) -> Tours:
    """Return closed tours, shape (k, n - 1), through joined ends as routes, shape (k, n)."""
    others = np.delete(np.arange(instance.n), instance.end or 0)[tours]
    routes = rotated(others, (others == instance.start).argmax(axis=1))
    return np.pad(routes, ((0, 0), (0, 1)), constant_values=instance.end or 0)


def _from_start(instance: Instance, tours: Tours, weights: Array) -> Tours:
    """Return closed tours opened to routes from an instance's start on, in their direction."""
    places = (tours == instance.start).argmax(axis=1)
    routes = moved_ends(instance, rotated(tours, places))
    size = instance.n if instance.end is None else instance.n - 1
    if size == 1:
        return routes
    cut = _best_cut(instance, routes[:, :size], weights)[:, np.newaxis]
    place = np.arange(size)
    if instance.symmetric:
        order = np.where(place <= cut, place, size + cut - place)
    else:
        order = np.where(place == 0, 0, 1 + (place - 1 + cut) % (size - 1))
    return np.concatenate((np.take_along_axis(routes, order, axis=1), routes[:, size:]), axis=1)


def _best_cut(instance: Instance, routes: Tours, weights: Array) -> NDArray[np.intp]:
    """Return the place after which each route, without a fixed end, is best cut, shape (k,).

    What comes then is turned round; or, where costs differ by direction, put right after the start.
    """

    def cost(origins: Tours, destinations: Tours) -> Array:
        origins, destinations = np.broadcast_arrays(origins, destinations)
        return _weighted(instance, origins, destinations, weights)

    start, first, last = routes[:, :1], routes[:, 1:2], routes[:, -1:]
    before, after, ends = routes[:, :-1], routes[:, 1:], routes[:, 1:]
    if instance.symmetric:
        lengths = cost(before, last) - cost(before, after)
    else:
        lengths = cost(start, after) - cost(before, after)
        lengths += cost(last, first) - cost(start, first)
        lengths[:, :1] = 0.0  # to put all of it first leaves the route as it is
        ends = np.concatenate((last, routes[:, 1:-1]), axis=1)
    if instance.end is not None:
        lengths = lengths + cost(ends, np.full((len(routes), 1), instance.end))
    return lengths.argmin(axis=1)


def _weighted(instance: Instance, origins: Tours, destinations: Tours, weights: Array) -> Array:
    """Return the weighted, scaled costs of steps, shape (k, m), weights of shape (k, 2)."""
    lengths = step_lengths(instance, origins, destinations) / instance.scale
    return (lengths * weights[:, np.newaxis]).sum(axis=-1)


def _turned(instance: Instance) -> Instance:
    """Return the instance of the same routes in the other direction."""
    matrices = None if instance.matrices is None else instance.matrices.transpose(0, 2, 1)
    return replace(instance, matrices=matrices, start=instance.end, end=instance.start)
