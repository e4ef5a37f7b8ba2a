"""First tours, which a network builds and repairs: how many fit into a time limit.

With a time limit the network gets a tenth of it at most. At equal total time the search gains
nothing from more of the network's tours (`python -m tests.benchmarks ablation`).
"""

import time
from threading import Event, Thread
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.construction.call_estimate import CallEstimate
from service.errors import Cancelled
from service.instance import Instance
from service.preferences import spread
from service.search.open_routes import built_tours

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
MIN_CONSTRUCTED = 3  # cities: of fewer there is one tour, and no network was trained on them
SHARE = 0.1  # of the time limit, after which a call that nobody asked for is ended
_AIMED = 0.6  # of its time: what a call may take by the estimate, which may be too low
_BUILDING = 0.5  # of that, where the tours shall be repaired as well
_LATE_CALLS, _LATE_SECONDS = 3.0, 1.0  # after the limit: estimates, and seconds, of asked-for tours
_TERMINATE_EVERY = 0.01  # seconds: the call may only be about to begin


class Constructor(Protocol):
    """A builder of tours from nothing but an instance and preferences."""

    estimate: CallEstimate

    def tours(self, instance: Instance, preferences: Array, repairs: int = 0) -> Tours:
        """Return closed tours, shape (k, n), one a preference (k, m), or raise Cancelled.

        With repairs, each is repaired that many times, and other tours, found on the way, may
        follow in as many rows again.
        """

    def terminate(self) -> None:
        """Have the call of `tours` that is under way raise Cancelled; for any thread."""


def construct(
    constructor: Constructor,
    instance: Instance,
    preferences: Array,
    repairs: int = 0,
    *,
    within: float | None = None,
    limit: float | None = None,
) -> Tours:
    """Return tours for each preference, shape (t, n), as a call of the constructor builds them.

    Args:
        constructor: Builds the tours.
        instance: The instance; of fewer than three cities no tour is built.
        preferences: Directions, shape (k, m); k may be 0.
        repairs: How often each tour is repaired, at most.
        within: Seconds of the call: then it is for at most k evenly spread preferences, as many as
            are estimated to fit, maybe none, and is ended if it takes longer. None honours all
            preferences.
        limit: Where all of them are honoured, seconds for repairs: as many are made as are
            estimated to fit, and a call that still takes longer is ended, and made without. That
            one may exceed the limit, but is ended where it takes far longer than estimated. None
            makes all repairs, and ends no call.

    Raises:
        Cancelled: The constructor was told to stop.
    """
    n, estimate = instance.n, constructor.estimate
    if n < MIN_CONSTRUCTED or not len(preferences):
        return np.empty((0, n), np.int64)
    if within is None:
        return _honoured(constructor, instance, preferences, repairs, limit)
    aimed = _AIMED * within
    k = min(len(preferences), estimate.fitting(n, aimed * _BUILDING if repairs else aimed))
    if k == 0:
        return np.empty((0, n), np.int64)
    repairs = min(repairs, estimate.fitting_repairs(n, k, aimed))
    evenly = spread(k, instance.objectives)
    return _tours_within(constructor, instance, evenly, repairs, within)


def _honoured(
    constructor: Constructor,
    instance: Instance,
    preferences: Array,
    repairs: int,
    limit: float | None,
) -> Tours:
    """Return tours for all preferences, with as many repairs as fit into a limit, if any."""
    if limit is None:
        return _timed_tours(constructor, instance, preferences, repairs)
    n, k, estimate = instance.n, len(preferences), constructor.estimate
    repairs = min(repairs, estimate.fitting_repairs(n, k, _AIMED * limit))
    if repairs > 0:
        tours = _tours_within(constructor, instance, preferences, repairs, limit)
        if len(tours):
            return tours
    late = limit + _LATE_SECONDS + _LATE_CALLS * estimate.seconds(n, k)
    return _tours_within(constructor, instance, preferences, 0, late)


def _tours_within(
    constructor: Constructor, instance: Instance, preferences: Array, repairs: int, seconds: float
) -> Tours:
    """Return the tours of one call; none where it takes more seconds than given and is ended."""
    returned, ended = Event(), Event()

    def end() -> None:
        pause = seconds
        while not returned.wait(pause):
            ended.set()
            constructor.terminate()
            pause = _TERMINATE_EVERY

    timer = Thread(target=end, daemon=True)
    timer.start()
    try:
        return _timed_tours(constructor, instance, preferences, repairs)
    except Cancelled:
        if not ended.is_set():
            raise
        constructor.estimate.correct_ended()
        return np.empty((0, instance.n), np.int64)
    finally:
        returned.set()
        timer.join()


def _timed_tours(
    constructor: Constructor, instance: Instance, preferences: Array, repairs: int
) -> Tours:
    """Return the tours of one call, and correct the estimate by the time that it took."""

    def build(closed: Instance, directions: Array) -> Tours:
        return constructor.tours(closed, directions, repairs)

    began = time.perf_counter()
    tours = built_tours(build, instance, preferences).astype(np.int64)
    seconds = time.perf_counter() - began
    constructor.estimate.correct(instance.n, len(preferences), seconds, repairs)
    return tours
