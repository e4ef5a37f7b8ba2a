"""Deadlines: the time by which something must be done, passed down to all the code that does it."""

from dataclasses import dataclass
from time import monotonic


@dataclass(frozen=True)
class Deadline:
    """A time of `time.monotonic()`."""

    at: float

    @classmethod
    def after(cls, seconds: float) -> "Deadline":
        """Return the deadline that is this many seconds from now."""
        return cls(monotonic() + seconds)

    def left(self) -> float:
        """Return the seconds that are left, below 0 once it is over."""
        return self.at - monotonic()

    def over(self) -> bool:
        """Return whether no time is left."""
        return self.left() <= 0
