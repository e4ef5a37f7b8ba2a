"""Bound the time of a survey: it is refused as soon as it is clear that it would take too long.

The time is that of the processor, so that other work on a busy machine does not count.
"""

import math
import time
from collections.abc import Callable

from service.errors import Refusal

_LOOKED = 0.1  # of the seconds allowed: after as long, what is left is estimated
_CLEARLY = 1.5  # an estimate is off by less than this factor


class Pace:
    """The time that the searches of a survey take.

    Args:
        seconds: The most processor time of this thread that all searches may take.
        stop: Returns whether the survey is to end.
        cells: The number of free cells, for the refusal.
        places: The number of places, for the refusal.
    """

    def __init__(
        self, seconds: float, stop: Callable[[], bool], *, cells: int, places: int
    ) -> None:
        self._began = time.thread_time()
        self._seconds, self._stop = seconds, stop
        self._cells, self._places = cells, places

    def of(self, searches: int) -> Callable[[], bool]:
        """Return a function to call before each of a number of searches that take equally long.

        It returns what `stop` returns.

        Raises:
            Refusal: The time is over, or will clearly be over before all searches are done. Raised
                by that function.
        """
        began, done = time.thread_time(), 0

        def before_search() -> bool:
            nonlocal done
            now = time.thread_time()
            spent, here = now - self._began, now - began
            estimated = began - self._began + here * searches / max(done, 1)
            clear = here > _LOOKED * self._seconds and estimated > _CLEARLY * self._seconds
            if clear or spent > self._seconds:
                raise self._refusal(max(estimated, spent))
            done += 1
            return self._stop()

        return before_search

    def _refusal(self, needed: float) -> Refusal:
        """Return the refusal of a survey that needs this many seconds, or more."""
        return Refusal(
            "survey-too-long",
            cells=self._cells,
            places=self._places,
            limit=self._seconds,
            fitting=max(2, math.floor(self._places * self._seconds / needed)),
        )
