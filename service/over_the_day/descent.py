"""Local search of one weighted sum over the day: descents, and descents from changed tours."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.jit import compiled, inlined, standalone
from service.over_the_day.moves import (
    DrivenTour,
    Move,
    estimate,
    estimated_gain,
    load,
    make,
    make_driven_tour,
    value_after,
    write_moved,
)
from service.over_the_day.travel import Cities, Traffic, sum_lengths
from service.search.archive.insertion import insert
from service.search.archive.layout import Archive
from service.search.local_search import random_below

Array = NDArray[np.float64]

_LONGEST_PART = 3  # cities that are moved elsewhere together
_CANDIDATES = 8  # cities that may follow each
_KINDS = 4 * (_LONGEST_PART + 1)  # of moves
_LEAST_GAIN = 1e-12  # of the value of a tour
_NEAR = 8  # places: how far apart the ends of the parts are that are swapped at random
_WARMTH = 0.05  # of a tour's mean leg: by how much worse a changed tour may be that is kept
_PARENTS = 10
_FINE = 2**20  # steps of a random number between 0 and 1


class WeightedSearch(NamedTuple):
    """The search of one weighted sum.

    `candidates`: shape (n, k), the cities that are cheap to go to from each. `dirty`: by city,
    whether moves at it have to be tried. `places`: the first place that may change, and the one
    after the last. `cursor`: where to look for the next dirty city. `kept` and `kept_value`: the
    tour that is changed next, and what `DrivenTour.value` was; `saved` and `saved_value`: those of
    the best one. `parents`, `parent_values` and `bred`: tours that are crossed, their values, how
    many there are, and how many children in a row were not among them. `random`: the state of the
    random numbers. `archive`: is offered every tour on the way.
    """

    walk: DrivenTour
    traffic: Traffic
    weights: Array
    candidates: Cities
    dirty: NDArray[np.bool_]
    places: NDArray[np.int64]
    cursor: NDArray[np.int64]
    kept: Cities
    kept_value: Array
    saved: Cities
    saved_value: Array
    parents: NDArray[np.int32]
    parent_values: Array
    bred: NDArray[np.int64]
    random: NDArray[np.int64]
    archive: Archive


def make_weighted_search(
    traffic: Traffic,
    means: Array,
    weights: Array,
    archive: Archive,
    places: tuple[int, int],
    seed: int,
) -> WeightedSearch:
    """Return a search under weights, shape (m,), that knows no tour yet. O(m n^2).

    Args:
        traffic: The day.
        means: The mean costs, shape (m, n, n).
        weights: The weight of each length.
        archive: Is offered every tour on the way.
        places: The first place that may change, and the one after the last.
        seed: The seed of its random numbers.
    """
    n = means.shape[1]
    costs = np.tensordot(weights, means, axes=1)
    np.fill_diagonal(costs, np.inf)
    count = min(_CANDIDATES, n - 1)
    nearest = np.argpartition(costs, count - 1, axis=1)[:, :count]
    order = np.take_along_axis(costs, nearest, axis=1).argsort(axis=1, kind="stable")
    nearest = np.take_along_axis(nearest, order, axis=1)
    return WeightedSearch(
        walk=make_driven_tour(n),
        traffic=traffic,
        weights=weights,
        candidates=np.ascontiguousarray(nearest, np.int32),
        dirty=np.zeros(n, np.bool_),
        places=np.array(places),
        cursor=np.zeros(1, np.int64),
        kept=np.zeros(n, np.int32),
        kept_value=np.zeros(2),
        saved=np.zeros(n, np.int32),
        saved_value=np.zeros(2),
        parents=np.zeros((_PARENTS, n), np.int32),
        parent_values=np.zeros(_PARENTS),
        bred=np.zeros(2, np.int64),
        random=np.array([seed], np.int64),
        archive=archive,
    )


@compiled
def take(search: WeightedSearch, tour: Cities, departure: float) -> None:
    """Take a tour, which has moves to be tried at every city."""
    load(search.walk, search.traffic, search.weights, tour, departure)
    search.dirty[:] = True
    save(search)


@compiled
def keep(search: WeightedSearch) -> None:
    """Remember the tour as the one to change next."""
    for k in range(len(search.kept)):
        search.kept[k] = search.walk.tour[k]
    search.kept_value[0], search.kept_value[1] = search.walk.value


@compiled
def save(search: WeightedSearch) -> None:
    """Remember the tour as the best one, and as the one to change next."""
    keep(search)
    for k in range(len(search.saved)):
        search.saved[k] = search.walk.tour[k]
    search.saved_value[0], search.saved_value[1] = search.walk.value


@compiled
def insert_driven(archive: Archive, traffic: Traffic, tour: Cities, departure: float) -> bool:
    """Offer a tour that leaves at a time to the archive; return whether it was inserted."""
    sum_lengths(traffic, tour, departure, archive.lengths)
    return insert(archive, archive.lengths, tour)


@standalone
def descend(search: WeightedSearch, steps: int) -> bool:
    """Try moves at up to `steps` dirty cities; return whether none is dirty any more."""
    n = len(search.dirty)
    for _ in range(steps):
        looked = 0
        while looked < n and not search.dirty[search.cursor[0]]:
            search.cursor[0] = (search.cursor[0] + 1) % n
            looked += 1
        if looked == n:
            return True
        city = int(search.cursor[0])
        search.dirty[city] = False
        while improved_at(search, city) or improved_at_ends(search, city):
            pass
    return False


@compiled
def iterate(search: WeightedSearch, steps: int) -> None:
    """Change a tour at random and descend, `steps` times; go back from much worse results.

    How much worse a result may be is random (Metropolis et al., 1953).
    """
    for _ in range(steps):
        if not perturb(search):
            return
        descend_fully(search)
        value = search.walk.value[0]
        if value < search.saved_value[0]:
            save(search)
        elif value <= search.kept_value[0] + warmth(search):
            keep(search)
        else:
            load(search.walk, search.traffic, search.weights, search.kept, search.kept_value[1])


@compiled
def descend_fully(search: WeightedSearch) -> None:
    """Descend to a local optimum."""
    while not descend(search, len(search.dirty)):
        pass


@inlined
def warmth(search: WeightedSearch) -> float:
    """Return by how much worse than the kept tour one may be, this time."""
    chance = (1 + random_below(search.random, _FINE)) / _FINE
    return -np.log(chance) * _WARMTH * search.kept_value[0] / len(search.kept)


@compiled
def perturb(search: WeightedSearch) -> bool:
    """Swap two parts that are near to each other; return False where it has fewer than two."""
    lowest, highest = search.places
    if highest - lowest < 2:
        return False
    first = lowest + random_below(search.random, highest - lowest - 1)
    middle = first + 1 + random_below(search.random, min(_NEAR, highest - first - 1))
    last = middle + 1 + random_below(search.random, min(_NEAR, highest - middle))
    apply(search, Move(first, middle, last, False, False))
    return True


@compiled
def apply(search: WeightedSearch, move: Move) -> None:
    """Make a move, whatever it is worth."""
    write_moved(search.walk, move)
    make_and_mark(search, move)


@compiled
def make_and_mark(search: WeightedSearch, move: Move) -> None:
    """Make a move, and note that moves are to be tried at the ends of all parts."""
    make(search.walk, search.traffic, search.weights, move)
    n = len(search.dirty)
    begins_b = move.first + move.last - move.middle  # now
    for place in (move.first, begins_b, move.last):
        search.dirty[search.walk.tour[max(0, place - 1)]] = True
        search.dirty[search.walk.tour[place % n]] = True


@inlined
def attempt(search: WeightedSearch, move: Move) -> bool:
    """Make a move if it is possible and shortens the tour; return whether it did."""
    lowest, highest = search.places
    if not lowest <= move.first < move.middle <= move.last <= highest:
        return False
    if not estimated_gain(search.walk, search.traffic, search.weights, move) > 0.0:
        return False
    return made_if_shorter(search, move)


@compiled
def made_if_shorter(search: WeightedSearch, move: Move) -> bool:
    """Drive a tour as a move changes it, and make the move if that shortens it."""
    walk, traffic, weights = search.walk, search.traffic, search.weights
    write_moved(walk, move)
    if not value_after(walk, traffic, weights, move) < walk.value[0] * (1 - _LEAST_GAIN):
        return False
    make_and_mark(search, move)
    insert_driven(search.archive, traffic, walk.tour, walk.value[1])
    return True


@compiled
def improved_at(search: WeightedSearch, city: int) -> bool:
    """Make the first move that shortens the tour by a leg from a city to a candidate.

    A move that shortens a tour adds a leg that is cheaper than one that it removes beside it (Lin
    and Kernighan, 1973).
    """
    walk, traffic, weights = search.walk, search.traffic, search.weights
    tour, n = walk.tour, len(walk.tour)
    p = walk.place[city]
    following = np.inf
    if p + 1 < n or traffic.closed:
        following = estimate(traffic, weights, walk.slices[p], city, tour[(p + 1) % n])
    for candidate in search.candidates[city]:
        q = walk.place[candidate]
        added = estimate(traffic, weights, walk.slices[p], city, candidate)
        preceding = np.inf
        if q > 0:
            preceding = estimate(traffic, weights, walk.slices[q - 1], tour[q - 1], candidate)
        for kind in range(_KINDS):
            removed = following if kind % 4 == 0 else preceding if kind % 4 == 1 else np.inf
            if kind % 4 > 1:
                removed = max(following, preceding)
            if added < removed and attempt(search, move_of(kind, p, q)):
                return True
    return False


@inlined
def move_of(kind: int, p: int, q: int) -> Move:
    """Return a move that adds a leg from place p to q, of a kind; an impossible one for none.

    By the remainder of the kind by 4, it removes the leg from p (0), that to q (1) or both. The
    first two reverse a part, and the others move one of up to three cities.
    """
    size, variant = kind // 4, kind % 4
    if size > 0:
        return moved_on(variant, size, p, q) if q > p else moved_back(variant, size, p, q)
    if q < p:
        return Move(1, 0, 0, False, False)
    return Move(p + 1 - variant, q + 1 - variant, q + 1 - variant, False, False)


@inlined
def moved_on(variant: int, size: int, p: int, q: int) -> Move:
    """Return a move of a part of a size that brings places p and q, a later one, together."""
    if variant == 0:
        return Move(p + 1, q - size + 1, q + 1, False, True)
    if variant == 1:
        return Move(p, p + size, q, True, False)
    if variant == 2:
        return Move(p + 1, q, q + size, False, False)
    return Move(p - size + 1, p + 1, q, False, False)


@inlined
def moved_back(variant: int, size: int, p: int, q: int) -> Move:
    """Return a move of a part of a size that brings places p and q, an earlier one, together."""
    if variant == 0:
        return Move(q - size + 1, q + 1, p + 1, True, False)
    if variant == 1:
        return Move(q, p, p + size, False, True)
    if variant == 2:
        return Move(q, q + size, p + 1, False, False)
    return Move(q, p - size + 1, p + 1, False, False)


@compiled
def improved_at_ends(search: WeightedSearch, city: int) -> bool:
    """Make the first move that shortens an open route by another city at an end that is free."""
    n, p = len(search.dirty), search.walk.place[city]
    if search.places[0] == 0 and attempt(search, Move(0, p + 1, p + 1, False, False)):
        return True
    if search.places[1] < n or search.traffic.closed:
        return False
    return attempt(search, Move(p, n, n, False, False))
