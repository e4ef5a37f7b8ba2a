"""improve(...): the search for a whole front, within a deadline, and its reports of progress.

Weighted sums are searched first, each from the best tour that the others have found; then the gaps
between what they reach are filled. Every nondominated tour that is visited is kept.
"""

import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from service.front import SearchResult, Termination
from service.instance import Instance, tour_lengths
from service.objectives import OBJECTIVES
from service.search.archive.layout import MAX_POINTS
from service.search.enumeration import exact_tours
from service.search.front_search import FrontSearch
from service.search.nondominated import nondominated
from service.search.schedule import Search
from service.search.several.schedule import SearchOfSeveral
from service.search.sizes import MAX_ENUMERATED
from service.watch import Watch

Array = NDArray[np.float64]

# Of fewer points, and fewer blocks, a search goes on after its deadline, some 10 ms up to 200
# cities: a process that was not run for a moment else answers with one tour. It goes on until there
# is one: of 10,000 cities some 50 to 100 ms after it began, half of what nearest neighbours take.
LEAST_POINTS, LEAST_BLOCKS = 10, 50
# Where other programs share the core, what follows the search takes longer, too. The search assumes
# the factor by which it was slowed itself: up to this one, and once it has computed for a while.
MOST_SLOWED, LEAST_COMPUTED = 4.0, 0.02


def improve(  # noqa: PLR0913  all but the first two are keyword-only and have a default
    instance: Instance,
    tours: NDArray[np.integer],
    *,
    watch: Watch[SearchResult] | None = None,
    reserve: Callable[[int], float] = lambda _: 0.0,
    iterations: float = np.inf,
    seed: int = 0,
    reference_point: Array | None = None,
    capacity: int = MAX_POINTS,
    touched: NDArray[np.integer] | None = None,
) -> SearchResult:
    """Return the front that a search finds; it dominates or equals each of the given tours.

    No tour has a forbidden leg; if every tour found has one, the front is empty.
    Up to eleven cities, ten of an open route, `converged` means that the front is exact, by
    enumeration. Beyond that, it means that 1,000 iterations per city found no new tour, which does
    not prove that none exists.

    Args:
        instance: The instance.
        tours: Tours to start from, shape (m, n); m may be 0.
        watch: Asked every millisecond or two whether to stop, which ends the search at once. At the
            end of its time the search stops, or up to a few dozen ms later where hardly a tour is
            found by then. None sets no limit.
        reserve: Called with the number of points found so far: the seconds before the end at which
            to stop, because they are needed for what follows the search.
        iterations: Number of local optima to visit; one by three-opt counts as several. Without a
            limit of time, the same seed and the same iterations give the same front.
        seed: The seed of all random choices.
        reference_point: Shape (m,), of the hypervolume, in the instance's units; by default
            the instance's. The search works where this hypervolume grows fastest.
        capacity: The most tours that the search keeps, at least 16; the result has more only where
            it was given more.
        touched: Where the given tours are of an earlier front: the cities at which they may have
            become worse, where the search looks first. It constructs no tours then.
    """
    watch = watch or Watch()
    if instance.n <= MAX_ENUMERATED:
        return _enumerated(instance, tours, watch)
    if reference_point is None:
        reference_point = instance.reference_point
    kind = Search if instance.objectives == OBJECTIVES else SearchOfSeveral
    search = kind(instance, seed, reference_point, capacity, touched)
    search.add(tours)
    terminated = _run(search, watch, reserve, iterations)
    if not search.size:
        search.construct()
    dropped = search.not_covered(tours)
    if not search.allowed:
        return _front(instance, np.concatenate((search.tours(), dropped)), terminated)
    if len(dropped):
        return _with_dropped(search, dropped, terminated)
    return SearchResult(search.points(), search.tours, terminated)


def _run(
    search: FrontSearch,
    watch: Watch[SearchResult],
    reserve: Callable[[int], float],
    iterations: float,
) -> Termination:
    """Run a search until it converges, its watch ends it, or its iterations are done."""
    began = looked = watch.spent
    computed = time.thread_time()
    step, visited = 0.0, 0
    for block, done in enumerate(search.run()):
        visited += done
        now = watch.spent
        if watch.stopped():
            return "cancelled"
        before, step = step, now - looked
        begun = search.size >= (LEAST_POINTS if block < LEAST_BLOCKS else 1)
        next_step = min(before, step)  # the process may not have run during one of the two
        slowed = _slowed(now - began, time.thread_time() - computed)
        late = begun and watch.over(slowed * reserve(search.size) + next_step)
        if late or visited >= iterations:
            return "time_limit"
        watch.report_if_due(search.progress, search.best)
        looked = watch.spent
    return "converged"


def _slowed(seconds: float, computed: float) -> float:
    """Return how many times as long as it computes this thread takes, 1 or more."""
    if computed < LEAST_COMPUTED:
        return 1.0
    return min(MOST_SLOWED, max(1.0, seconds / computed))


def _enumerated(
    instance: Instance, tours: NDArray[np.integer], watch: Watch[SearchResult]
) -> SearchResult:
    """Return the exact front, or where time runs out what was found of it and the given tours."""
    found, complete = exact_tours(instance, watch)
    if complete:
        return _front(instance, found, "converged")
    every = np.concatenate((found, tours))
    return _front(instance, every, "cancelled" if watch.stopped() else "time_limit")


def _with_dropped(
    search: FrontSearch, dropped: NDArray[np.integer], terminated: Termination
) -> SearchResult:
    """Return the front of a search, and of tours that its full archive had to drop."""
    found = search.size
    points = np.concatenate((search.points(), tour_lengths(search.instance, dropped)))
    front = nondominated(points)

    def tours_at(indices: NDArray[np.intp]) -> NDArray[np.integer]:
        rows = front[indices]
        tours = np.empty((len(rows), dropped.shape[1]), np.int32)
        tours[rows < found] = search.tours(rows[rows < found])
        tours[rows >= found] = dropped[rows[rows >= found] - found]
        return tours

    return SearchResult(points[front], tours_at, terminated)


def _front(instance: Instance, tours: NDArray[np.integer], terminated: Termination) -> SearchResult:
    """Return the nondominated among tours, without those that have a forbidden leg."""
    points = tour_lengths(instance, tours)
    indices = nondominated(points)
    return SearchResult(points[indices], tours[indices].astype(np.int32).__getitem__, terminated)
