"""First tours, which a network builds: how many fit into a time limit, and under which symmetries.

With a time limit the network gets a tenth of it at most. At equal total time the search gains
nothing from more of the network's tours (`python -m tests.benchmarks ablation`).
"""

import time
from collections.abc import Callable
from threading import Event, Timer
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from service.construction.call_estimate import CallEstimate
from service.construction.symmetries import symmetries
from service.errors import Cancelled
from service.instance import Instance
from service.preferences import fan, from_angles
from service.search.open_routes import built_tours

Array = NDArray[np.float64]
Tours = NDArray[np.int64]
MIN_CONSTRUCTED = 3  # cities: of fewer there is one tour, and no network was trained on them
SHARE = 0.1  # of the time limit, after which a call that nobody asked for is ended
_AIMED = 0.6  # of that share: what a call may take by the estimate, which may be too low


class Constructor(Protocol):
    """A builder of tours from nothing but an instance and preferences."""

    estimate: CallEstimate

    def tours(self, instance: Instance, preferences: Array) -> Tours:
        """Return closed tours, shape (k, n), one a preference (k, 2), or raise Cancelled."""

    def terminate(self) -> None:
        """Have the call of `tours` that is under way raise Cancelled; for any thread."""


def construct(
    constructor: Constructor,
    instance: Instance,
    angles: Array,
    augment: int = 1,
    *,
    within: float | None = None,
    stop: Callable[[], bool] = lambda: False,
) -> Tours:
    """Return a tour for each angle and each symmetry, shape (m, n), until told to stop.

    Args:
        constructor: Builds the tours.
        instance: The instance; of fewer than three cities no tour is built.
        angles: Of the preferences in degrees, shape (k,); k may be 0.
        augment: How often the constructor is called, each time with another symmetry of the
            coordinates and with angles between those of the other calls.
        within: Seconds for all calls together: then it is at most k evenly spread preferences, as
            many as are estimated to fit, maybe none, and a call that takes longer is ended. None
            honours all angles.
        stop: Called after each call; no further one follows once it returns True.

    Raises:
        Cancelled: The constructor was told to stop before it had a tour.
    """
    tours = [np.empty((0, instance.n), np.int64)]
    if instance.n < MIN_CONSTRUCTED or not len(angles):
        return tours[0]
    if within is not None:
        within /= augment
        fitting = constructor.estimate.fitting(instance.n, _AIMED * within)
        if fitting == 0:
            return tours[0]
        angles = fan(min(len(angles), fitting))
    for call, image in enumerate(symmetries(instance, augment)):
        preferences = from_angles(_shifted(angles, call / augment))
        try:
            tours.append(_tours_within(constructor, image, preferences, within))
        except Cancelled:
            if len(tours) == 1:
                raise
            break
        if stop():
            break
    return np.concatenate(tours)


def _shifted(angles: Array, share: float) -> Array:
    """Return the angles, each shifted by a share of the way to the next; the last stays."""
    index = np.arange(len(angles))
    return np.interp(index + share, index, angles)


def _tours_within(
    constructor: Constructor, instance: Instance, preferences: Array, seconds: float | None
) -> Tours:
    """Return the tours of one call; none where it takes more seconds than given and is ended."""
    if seconds is None:
        return _timed_tours(constructor, instance, preferences)
    ended = Event()

    def end() -> None:
        ended.set()
        constructor.terminate()

    timer = Timer(seconds, end)
    timer.daemon = True
    timer.start()
    try:
        return _timed_tours(constructor, instance, preferences)
    except Cancelled:
        if not ended.is_set():
            raise
        constructor.estimate.correct_ended()
        return np.empty((0, instance.n), np.int64)
    finally:
        timer.cancel()


def _timed_tours(constructor: Constructor, instance: Instance, preferences: Array) -> Tours:
    """Return the tours of one call, and correct the estimate by the time that it took."""
    began = time.perf_counter()
    tours = built_tours(constructor.tours, instance, preferences).astype(np.int64)
    constructor.estimate.correct(instance.n, len(preferences), time.perf_counter() - began)
    return tours
