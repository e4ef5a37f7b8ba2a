"""Compile the search over the day, or load it from the cache."""

import numpy as np

from service.day.costs import CostsOfDay
from service.over_the_day.day import Day
from service.over_the_day.search import DaySearch
from service.watch import Watch

_N = 12  # cities: too many to try all tours


def warm_up() -> None:
    """Compile it by searches that use all of it."""
    for n in (4, _N):
        search = _search(n)
        any(search.run())  # until it has iterated
        search.driven(search.found()[1], Watch())


def _search(n: int) -> DaySearch:
    """Return a search of n cities, with a tour to begin with."""
    cities = np.arange(float(n))
    matrix = np.outer(cities, cities) % 7.0
    costs = [
        CostsOfDay(cities[:2], np.array([1.0, 2.0]), np.zeros(2, np.int64), matrix[np.newaxis]),
        CostsOfDay.constant(matrix),
    ]
    search = DaySearch(Day(costs, clock=0, service=cities, earliest=0.0, latest=1.0), 0)
    search.add(np.arange(n)[np.newaxis])
    return search
