"""A watch over planning: how much time is left, whether to stop, and when to report.

Each loop that plans is given one, and asks it between two short steps.
"""

import time
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from math import inf
from typing import Any, Generic, TypeVar

A = TypeVar("A")
B = TypeVar("B")


@dataclass(frozen=True)
class Progress:
    """The state of a running search: seconds, hypervolume and nondominated points so far."""

    seconds: float
    hypervolume: float
    points: int


# Called with the progress of a search, and a function that returns the best front of n tours.
ReportOf = Callable[[Progress, Callable[[int], A]], None]
# Returns the hypervolume and the number of points found so far; None if there is none to report.
Found = Callable[[], tuple[float, int] | None]

_REPORT_EVERY = 0.1  # seconds
_LONGEST_REPORTS = 10  # times as long as a report takes, the work goes on before the next


class Watch(Generic[A]):
    """Watches work from now on.

    Args:
        seconds: How long the work may take; infinite without a limit.
        stop: Called often; True ends the work at once.
        report: Called about ten times a second with the progress, and with a function that returns
            the best front so far of at most n tours, which is valid until the report returns.
        clock: Returns the time in seconds.
    """

    def __init__(
        self,
        seconds: float = inf,
        stop: Callable[[], bool] = lambda: False,
        report: ReportOf[A] = lambda *_: None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.seconds = seconds
        self.stopped = stop
        self.report = report
        self._clock = clock
        self._began = self._reported = clock()
        self._pause = _REPORT_EVERY

    @property
    def spent(self) -> float:
        """The seconds since the work began."""
        return self._clock() - self._began

    @property
    def left(self) -> float:
        """The seconds left, below 0 after the end."""
        return self.seconds - self.spent

    def over(self, reserve: float = 0.0) -> bool:
        """Return whether no time is left, but for the seconds that what follows the work takes."""
        return self.left <= reserve

    def ended(self) -> bool:
        """Return whether no time is left, or the work is to stop."""
        return self.stopped() or self.over()

    def lasting(self, seconds: float) -> "Watch[A]":
        """Return a watch over work that begins now and may take this many seconds."""
        return Watch(seconds, self.stopped, self.report, self._clock)

    def until(self, seconds: float) -> "Watch[A]":
        """Return a watch over a part of this work, which ends `seconds` after the whole began."""
        part = copy(self)
        part.seconds = seconds
        return part

    def reporting(self, report: ReportOf[B]) -> "Watch[B]":
        """Return a watch over the same work, with other reports."""
        part: Watch[Any] = copy(self)
        part.report = report
        return part

    def converting(self, converted: Callable[[B], A]) -> "Watch[B]":
        """Return a watch over the same work; its fronts are converted before they are reported."""
        report = self.report
        return self.reporting(
            lambda progress, best: report(progress, lambda size: converted(best(size)))
        )

    def report_if_due(self, found: Found, best: Callable[[int], A]) -> None:
        """Report if the last report is long enough ago, but not shortly before the end.

        A report takes time, which may not be left then.
        """
        now = self._clock()
        due = now - self._reported >= self._pause and self.left > self._pause
        if not due or (values := found()) is None:
            return
        self.report(Progress(now - self._began, *values), best)
        self._reported = self._clock()
        self._pause = max(_REPORT_EVERY, _LONGEST_REPORTS * (self._reported - now))
