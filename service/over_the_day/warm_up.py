"""Compile the search over the day, or load it from the cache.

Two processes compile it side by side. So it has two pieces, which share little: the descent, and
what a search needs besides.
"""

import math
from itertools import islice

import numpy as np

from service.over_the_day.day import CostsOfDay, Day
from service.over_the_day.descent import descend, improved_at_ends, perturb, save, take
from service.over_the_day.search import WEIGHTS, DaySearch

_N = 12  # cities: too many to try all tours


def warm_up() -> None:
    """Compile it by searches that use all of it."""
    for n in (4, _N):
        search = _search(n)
        for _ in islice(search.run(), 4 * WEIGHTS[2]):
            pass
        search.driven(search.found()[1], math.inf)


def descent() -> None:
    """Compile the descent, and then what is still missing."""
    descend(_search(_N, begun=False).weighted_search(0), 0)
    warm_up()


def beside_descent() -> None:
    """Compile what a search needs besides the descent."""
    search = _search(_N)
    weighted = search.weighted_search(0)
    take(weighted, search.found()[1][0], 0.0)
    save(weighted)
    perturb(weighted)
    search.driven(search.found()[1], math.inf)
    improved_at_ends(weighted, 0)  # last: it calls what the other piece begins with


def _search(n: int, begun: bool = True) -> DaySearch:
    """Return a search of n cities, with a tour to begin with unless told otherwise."""
    cities = np.arange(float(n))
    matrix = np.outer(cities, cities) % 7.0
    costs = [
        CostsOfDay(cities[:2], np.array([1.0, 2.0]), np.zeros(2, np.int64), matrix[np.newaxis]),
        CostsOfDay.constant(matrix),
    ]
    search = DaySearch(Day(costs, clock=0, service=cities, earliest=0.0, latest=1.0), 0)
    if begun:
        search.add(np.arange(n)[np.newaxis])
    return search
