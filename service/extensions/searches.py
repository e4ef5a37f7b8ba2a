"""Improve tours with a function of another package, in place of Paretour's search."""

import numpy as np
from numpy.typing import NDArray

from service.extensions.checks import called, checked
from service.extensions.entry_points import SEARCHES, described, loaded
from service.front import PlanOptions, SearchFunction, SearchResult, Termination
from service.instance import Instance, tour_lengths
from service.search.nondominated import nondominated
from service.watch import Watch

_FEWEST_CITIES = 3  # of a search: with fewer cities, all tours are known already
_SHARE = 0.95  # of the seconds left that the function gets; the rest is for checks and the choice


def load_search(name: str | None) -> SearchFunction | None:
    """Import a search, and return it as a function that checks its results.

    Args:
        name: The name of its entry point. With None the result is None.

    Raises:
        ValueError: The search is not installed, or cannot be imported.
    """
    if name is None:
        return None
    function, at = loaded(SEARCHES, name), described(SEARCHES, name)

    def search(
        instance: Instance,
        tours: NDArray[np.integer],
        options: PlanOptions,  # noqa: ARG001
        watch: Watch[SearchResult],
    ) -> SearchResult:
        every = tours
        if instance.n >= _FEWEST_CITIES:
            seconds = max(_SHARE * watch.left, 0.0)
            found = called(function, instance, tours, seconds, watch.stopped)
            every = np.concatenate((checked(found, instance, at), tours))
        points = tour_lengths(instance, every)
        front = nondominated(points)
        return SearchResult(points[front], every[front].__getitem__, _termination(watch))

    return search


def _termination(watch: Watch[SearchResult]) -> Termination:
    if watch.stopped():
        return "cancelled"
    return "time_limit" if watch.over() else "converged"
