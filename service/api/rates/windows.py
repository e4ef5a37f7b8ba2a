"""Windows of time in which requests are counted, in memory: for few callers or many addresses."""

import time
from collections import defaultdict, deque
from collections.abc import Callable

Clock = Callable[[], float]


class MovingWindow:
    """Counts the requests of each caller in the last seconds, exactly, by their times.

    Args:
        amount: How many there may be.
        seconds: The length of the window.
        clock: Gives the time in seconds.
    """

    def __init__(self, amount: int, seconds: float, clock: Clock = time.monotonic) -> None:
        self._amount = amount
        self._seconds = seconds
        self._clock = clock
        self._times: defaultdict[str, deque[float]] = defaultdict(deque)

    async def hit(self, caller: str) -> float | None:
        """Count a request, and return None; or return in how many seconds the next one may come."""
        now, times = self._clock(), self._times[caller]
        while times and times[0] <= now - self._seconds:
            times.popleft()
        if len(times) >= self._amount:
            return times[0] + self._seconds - now
        times.append(now)
        return None


class SlidingWindow:
    """Counts the requests of each address in the last seconds, nearly, by two numbers for each.

    Time is cut into windows, and only the counts of the present one and of that before are kept.
    Of the latter so large a share counts as lies within the last seconds: as if its requests had
    come evenly. The arguments are those of MovingWindow.
    """

    def __init__(self, amount: int, seconds: float, clock: Clock = time.monotonic) -> None:
        self._amount = amount
        self._seconds = seconds
        self._clock = clock
        self._number = 0  # of the present window
        self._before: dict[str, int] = {}
        self._present: dict[str, int] = {}

    async def hit(self, address: str) -> float | None:
        """Count a request, and return None; or return in how many seconds the next one may come."""
        number, into = divmod(self._clock(), self._seconds)
        self._move_to(int(number))
        count, before = self._present.get(address, 0), self._before.get(address, 0)
        if count + before * (1 - into / self._seconds) < self._amount:
            self._present[address] = count + 1
            return None
        # When so little of the window before is left that one more fits; or the next window.
        free = 1.0 if count >= self._amount else 1 - (self._amount - count) / before
        return free * self._seconds - into

    def _move_to(self, number: int) -> None:
        """Make the window of this number the present one."""
        if number != self._number:
            self._before = self._present if number == self._number + 1 else {}
            self._present = {}
            self._number = number
