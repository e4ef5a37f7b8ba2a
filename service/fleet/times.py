"""The times of a route."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Schedule:
    """The times of a route: when the vehicle reaches each stop, and when it is done.

    Attributes:
        arrivals: The arrival at each stop of `path_of`; at the first stop, the departure. The
            vehicle may wait at a stop until its window opens.
        end: The end of the route.
        late: The largest delay at a window, or at the end of the shift with its overtime; 0 if it
            is a rounding.
        waiting: The time that the vehicle waits.
        slack: How much later it may leave without being late, if it is never late.
        lateness: The sum of the times by which visits begin after they are due.
        windows: The number of the window used at each stop of `path_of`.
        tightest: The place in `path_of` of the stop that limits the slack by a window that is not
            its last; -1 if something else does.
        begins: When the visit at each stop of `path_of` begins.
        breaks: When each break on the way begins.
        leaves: When the vehicle leaves each stop of `path_of`, if costs change over the day.
    """

    arrivals: tuple[float, ...]
    end: float
    late: float
    waiting: float
    slack: float
    lateness: float
    windows: tuple[int, ...]
    tightest: int
    begins: tuple[float, ...]
    breaks: tuple[float, ...] = ()
    leaves: tuple[float, ...] = ()

    @property
    def duration(self) -> float:
        """The time from the departure to the end."""
        return self.end - self.arrivals[0]
