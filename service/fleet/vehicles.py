"""Say what stops, shipments and types of vehicles ask for: the parts of a fleet's rules."""

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

Span = tuple[float, float]
Break = tuple[float, float, float]  # the earliest and the latest begin, and how long it takes
ALWAYS: Span = (0.0, inf)


@dataclass(frozen=True, kw_only=True)
class Visit:
    """The demands of a stop on the vehicle that visits it.

    Args:
        demand: The load brought there, or at a pick-up the load taken on, in each dimension of the
            vehicles' capacity.
        service: How long the visit takes.
        windows: When the visit may begin: in any of these, by ascending begin.
        prize: The cost of leaving the stop out; None if it must be visited.
        due: The time at which the visit should have begun. If it begins later, the plan is late by
            the difference.
        release: The earliest time at which a vehicle can load what it brings there.
        skills: The skills that its vehicle must have, all of them.
        vehicles: The types of vehicles that may visit it, also some of which none is left; empty
            for any.
        wanted: The time before which the visit should not begin. If it does, the plan is early by
            the difference.
        urgency: What a unit of time until the visit begins counts in weighted arrivals.
        services: How long the visit takes by each type of vehicles; empty where all take `service`.
        promised_to: The type of vehicles that should visit it, as it does in a plan that is driven
            or was promised; -1 if that has gone, and None if the stop was not in that plan.
        promised_by: When the visit begins in that plan.
        pickup: The load taken on there, which stays on board to the end, in each dimension.
    """

    demand: tuple[int, ...] = ()
    service: float = 0.0
    windows: tuple[Span, ...] = (ALWAYS,)
    prize: float | None = None
    due: float = inf
    release: float = 0.0
    skills: tuple[str, ...] = ()
    vehicles: tuple[int, ...] = ()
    wanted: float = 0.0
    urgency: float = 1.0
    services: tuple[float, ...] = ()
    promised_to: int | None = None
    promised_by: float = inf
    pickup: tuple[int, ...] = ()

    def service_by(self, vehicle: int) -> float:
        """Return how long the visit takes by a type of vehicles, before its factor."""
        return self.services[vehicle] if self.services else self.service

    @property
    def is_timed(self) -> bool:
        """Whether its visit may begin too late."""
        return self.due < inf or any(closes < inf for _, closes in self.windows)

    @property
    def longest_service(self) -> float:
        """How long the visit takes by the slowest type of vehicles, before its factor."""
        return max(self.services, default=self.service)


@dataclass(frozen=True)
class Shipment:
    """Two stops: the same vehicle takes a load from the one to the other."""

    pickup: int
    delivery: int


@dataclass(frozen=True, kw_only=True)
class VehicleType:
    """A number of equal vehicles.

    Args:
        start: The stop at which they start; None if each starts at its first visit.
        end: The stop at which they end; None if each ends at its last visit.
        count: The number of vehicles.
        capacity: The most that a vehicle can hold, in each dimension.
        shift: The earliest departure and the latest end of a route.
        longest: The limit on the time of a route; without a clock, on its length in the objective
            that is a maximum.
        fixed: The cost of using one vehicle.
        skills: What they are able to do.
        max_stops: The most stops of a route; None for any number. Not for who may load again.
        reload: The stops at which they may load again on their way.
        max_trips: The most trips of a route, each from one loading to the next; None for any.
        initial_load: The load on board at the start, in each dimension, or empty. It is unloaded at
            the first stop for reloading, or at the end.
        max_overtime: How much later than its shift a route may end.
        breaks: The breaks of a driver who is on the way then, by ascending time.
        leaves_by: The latest departure: of a vehicle on its way, the present time.
        min_stops: The least stops of a route.
        shortest: The least time of a route; without a clock, its least length, as of `longest`.
        home: Of a vehicle on its way, the stop where it started the day.
        speed_factor: By how much they are faster than the clock's costs say.
        service_factor: By what the service of a stop is multiplied.
        per_distance: The price of each unit of the first costs of their legs.
        per_time: The price of each unit of the time of their routes.
        max_distance: The most of the costs of a route's legs that are not time.
        max_driving: The most time that a route's legs take, without visits and waiting.
        profile: The number of the costs of their legs, where some drive by others.
    """

    start: int | None = None
    end: int | None = None
    count: int = 1
    capacity: tuple[int, ...] = ()
    shift: Span = ALWAYS
    longest: float = inf
    fixed: float = 0.0
    skills: tuple[str, ...] = ()
    max_stops: int | None = None
    reload: tuple[int, ...] = ()
    max_trips: int | None = None
    initial_load: tuple[int, ...] = ()
    max_overtime: float = 0.0
    leaves_by: float = inf
    breaks: tuple[Break, ...] = ()
    min_stops: int = 0
    shortest: float = 0.0
    home: int | None = None
    speed_factor: float = 1.0
    service_factor: float = 1.0
    per_distance: float = 1.0
    per_time: float = 0.0
    max_distance: float = inf
    max_driving: float = inf
    profile: int = 0

    @property
    def is_bounded_below(self) -> bool:
        """Whether a route may have too few stops, or be too short."""
        return self.min_stops > 1 or self.shortest > 0

    @property
    def way(self) -> Span:
        """The earliest departure, and the latest end with overtime."""
        return self.shift[0], self.shift[1] + self.max_overtime

    @property
    def rest(self) -> float:
        """How long the breaks take that a route to the end of the shift has."""
        begin, end = self.way
        total = sum(length for _, _, length in self.breaks)
        needed = (each for each in self.breaks if begin < each[0] and each[1] <= end - total)
        return sum(length for _, _, length in needed)


class Pace(NamedTuple):
    """How a type of vehicles drives and serves.

    Attributes:
        speed: What the times of legs are divided by.
        services: How long each visit takes.
        profile: The number of the costs of legs.
    """

    speed: float
    services: tuple[float, ...]
    profile: int
