"""The parts of the compiled code, which of them a kind of task needs, and their compilation.

Compiling all takes most of a minute, once, and some parts are needed far more often than others. So
a task waits for its own parts alone. This module loads no compiled code.
"""

from dataclasses import dataclass
from enum import Enum

from service.construction.repairs import TOURS_REPAIRED
from service.coverage.coverage import Coverage
from service.errors import WarmingUp
from service.objectives import OBJECTIVES
from service.requests.stops import Stops
from service.requests.task import SharedCoverage, Task, UnmeasuredFleet
from service.search.sizes import DENSE_BELOW, GREEDY, MAX_ENUMERATED, THREE_OPT

# Cities from which on candidates or tours are found by other code.
_MANY = {"coordinates": DENSE_BELOW, "matrices": GREEDY}


class Part(Enum):
    """A part of the compiled code. They are compiled in this order: by how often they are used."""

    FEW_CITIES = "few-cities"
    FEWEST_CITIES = "fewest-cities"  # whose tours are all tried
    MORE_CITIES = "more-cities"  # and costs that differ by direction
    MAPS = "maps"
    CHANGES = "changes"
    FLEETS = "fleets"
    SEVERAL_OBJECTIVES = "several-objectives"  # three and four
    OVER_THE_DAY = "over-the-day"
    FLEETS_OVER_THE_DAY = "fleets-over-the-day"
    MANY_CITIES = "many-cities"
    BOUNDS = "bounds"


_OF_DAYS = (Part.OVER_THE_DAY, Part.FLEETS_OVER_THE_DAY)


@dataclass(frozen=True)
class Compiling:
    """The progress of compiling all parts.

    Args:
        share: What is done, from 0 to 1.
        seconds_left: About how long the rest takes.
    """

    share: float
    seconds_left: float

    def __str__(self) -> str:
        """Return a sentence about it."""
        return (
            f"compiling the search: {100 * self.share:.0f} %, about {self.seconds_left:.0f} s left"
        )

    @property
    def refusal(self) -> WarmingUp:
        """The refusal of what cannot wait until it is done."""
        return WarmingUp(str(self), self.seconds_left)


def parts_for_robots(shared: SharedCoverage, _: Task) -> frozenset[Part]:
    """Return the parts that several robots on a map need."""
    timed = shared.coverage.hours is not None
    other = Part.FLEETS if timed else Part.FLEETS_OVER_THE_DAY
    return frozenset(Part) - {Part.CHANGES, Part.SEVERAL_OBJECTIVES, Part.OVER_THE_DAY, other}


def parts_for_fleet(fleet: UnmeasuredFleet, _: Task) -> frozenset[Part]:
    """Return the parts that a fleet needs."""
    several = {Part.SEVERAL_OBJECTIVES} if len(fleet.rules.over) > OBJECTIVES else set()
    search = Part.FLEETS_OVER_THE_DAY if fleet.stops.changes else Part.FLEETS
    return frozenset({Part.FEW_CITIES, search} | several)


def parts_for_map(coverage: Coverage, _: Task) -> frozenset[Part]:
    """Return the parts that one robot on a map needs."""
    unneeded = {Part.FLEETS, *_OF_DAYS}
    if coverage.hours is not None:
        unneeded.remove(Part.OVER_THE_DAY)
    elif coverage.objectives == OBJECTIVES:
        unneeded.add(Part.SEVERAL_OBJECTIVES)
    return frozenset(Part) - unneeded


def parts_for_stops(stops: Stops, task: Task) -> frozenset[Part]:
    """Return the parts that tours through stops need; none if the network does it alone."""
    several, replanned = len(stops.sources) > OBJECTIVES, task.earlier is not None
    if not (_needs_search(task) or several or stops.hours is not None):
        return frozenset()
    few = stops.kind == "coordinates" and stops.n < THREE_OPT and not several and not replanned
    needed = {
        Part.FEW_CITIES: True,
        Part.FEWEST_CITIES: stops.n <= MAX_ENUMERATED,
        Part.MORE_CITIES: not few,
        Part.CHANGES: replanned,
        Part.SEVERAL_OBJECTIVES: several or stops.hours is not None,
        Part.MANY_CITIES: stops.n >= _MANY[stops.kind],
        Part.OVER_THE_DAY: stops.hours is not None,
        Part.BOUNDS: True,
    }
    return frozenset(part for part, is_needed in needed.items() if is_needed)


def _needs_search(task: Task) -> bool:
    """Whether planning under two objectives needs a search, a bound, or the best subset."""
    options = task.options
    constructed = len(options.directions) * (TOURS_REPAIRED if options.repairs > 0 else 1)
    return options.time_limit > 0 or options.bound or constructed > options.size
