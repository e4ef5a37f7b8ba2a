"""The values of a fleet: stops, vehicles, rules, and the costs between the stops."""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid

Array = NDArray[np.float64]
Over = Literal["sum", "max"]
Span = tuple[float, float]
ALWAYS: Span = (0.0, inf)
_UNSUMMED = "is added to the first objective, so that must be over sum, got max"
_UNTIMED = "needs the name of the objective that is time, in clock"


@dataclass(frozen=True, kw_only=True)
class Visit:
    """The demands of a stop on the vehicle that visits it.

    Args:
        demand: The load brought there, or at a pick-up the load taken on, in each dimension of the
            vehicles' capacity.
        service: How long the visit takes.
        window: When the visit may begin.
        prize: The cost of leaving the stop out; None if it must be visited.
    """

    demand: tuple[int, ...] = ()
    service: float = 0.0
    window: Span = ALWAYS
    prize: float | None = None


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
    """

    start: int | None = None
    end: int | None = None
    count: int = 1
    capacity: tuple[int, ...] = ()
    shift: Span = ALWAYS
    longest: float = inf
    fixed: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Rules:
    """A fleet without the costs between its stops.

    Args:
        visits: The demands of each of the n stops. Starts and ends of vehicles have none.
        vehicles: The types of vehicles.
        shipments: The pairs of stops that one vehicle must visit in order.
        over: How each objective measures a plan: by the sum over its routes, or by the longest.
        clock: The objective that is time. Service, windows and shifts are in its unit.

    Raises:
        Refusal: The rules contradict each other, or are not supported.
    """

    visits: tuple[Visit, ...]
    vehicles: tuple[VehicleType, ...]
    shipments: tuple[Shipment, ...] = ()
    over: tuple[Over, Over] = ("sum", "sum")
    clock: int | None = None

    def __post_init__(self) -> None:
        if self.over == ("max", "max"):
            demand = "must be sum, as that of objectives/0 is max, got max"
            raise invalid("objectives/1/over", demand)
        for index, vehicle in enumerate(self.vehicles):
            _check_vehicle(self, vehicle, f"vehicles/{index}")
        for index, visit in enumerate(self.visits):
            _check_visit(self, visit, index)
        _check_shipments(self)

    @property
    def n(self) -> int:
        """The number of stops."""
        return len(self.visits)

    @property
    def dimensions(self) -> int:
        """The number of dimensions of demands and capacities."""
        return len(self.vehicles[0].capacity)

    @cached_property
    def depots(self) -> frozenset[int]:
        """The stops at which vehicles start or end."""
        ends = (end for vehicle in self.vehicles for end in (vehicle.start, vehicle.end))
        return frozenset(end for end in ends if end is not None)

    @cached_property
    def shipped(self) -> frozenset[int]:
        """The stops of all shipments."""
        return frozenset(i for each in self.shipments for i in (each.pickup, each.delivery))

    @cached_property
    def clients(self) -> tuple[int, ...]:
        """The stops that vehicles visit: all but the depots."""
        return tuple(stop for stop in range(self.n) if stop not in self.depots)

    @property
    def maximum(self) -> int | None:
        """The objective that is the longest route, if there is one."""
        return self.over.index("max") if "max" in self.over else None

    @property
    def limited(self) -> int | None:
        """The objective that `longest` limits, if there is one."""
        return self.maximum if self.clock is None else self.clock

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """All windows and shifts that bound any time."""
        spans = (*(visit.window for visit in self.visits), *(each.shift for each in self.vehicles))
        return tuple(span for span in spans if span != ALWAYS)

    @property
    def has_bounds(self) -> bool:
        """Whether anything bounds a time or the length of a route."""
        return bool(self.spans) or any(vehicle.longest < inf for vehicle in self.vehicles)


def _check_vehicle(rules: Rules, vehicle: VehicleType, part: str) -> None:
    if len(vehicle.capacity) != rules.dimensions:
        demand = f"must have {rules.dimensions} numbers, as that of vehicles/0"
        raise invalid(f"{part}/capacity", f"{demand}, got {len(vehicle.capacity)}")
    _check_span(rules, vehicle.shift, f"{part}/shift")
    if vehicle.fixed and rules.over[0] == "max":
        raise invalid(f"{part}/fixed", _UNSUMMED)
    if rules.limited is None and vehicle.longest != inf:
        demand = "needs the name of the objective that is time in clock, or an objective over max"
        raise invalid(f"{part}/longest", demand)


def _check_visit(rules: Rules, visit: Visit, index: int) -> None:
    part = f"stops/{index}"
    if index in rules.depots:
        _check_depot(visit, part)
    if rules.clock is None and visit.service:
        raise invalid(f"{part}/service", _UNTIMED)
    _check_span(rules, visit.window, f"{part}/window")
    if visit.demand and len(visit.demand) != rules.dimensions:
        demand = f"must have {rules.dimensions} numbers, as each capacity has"
        raise invalid(f"{part}/demand", f"{demand}, got {len(visit.demand)}")
    if visit.prize is not None and rules.over[0] == "max":
        raise invalid(f"{part}/prize", _UNSUMMED)


def _check_depot(visit: Visit, part: str) -> None:
    demand = "must not be given for a stop at which vehicles start or end"
    if visit.window != ALWAYS:
        raise invalid(f"{part}/window", f"{demand}: say in their shift when they may be on the way")
    for name, given in (
        ("demand", any(visit.demand)),
        ("service", visit.service),
        ("prize", visit.prize is not None),
    ):
        if given:
            raise invalid(f"{part}/{name}", demand)


def _check_span(rules: Rules, span: Span, part: str) -> None:
    if span[0] > span[1]:
        raise invalid(part, f"must not end before it begins, got {span[0]:g} to {span[1]:g}")
    if rules.clock is None and span != ALWAYS:
        raise invalid(part, _UNTIMED)


def _check_shipments(rules: Rules) -> None:
    parts: dict[int, str] = {}
    for index, shipment in enumerate(rules.shipments):
        for name, stop in (("pickup", shipment.pickup), ("delivery", shipment.delivery)):
            part = f"shipments/{index}/{name}"
            if stop in rules.depots:
                raise invalid(part, "must not be a start or end of vehicles")
            if parts.setdefault(stop, part) != part:
                raise invalid(part, f"must be in one shipment, and is {parts[stop]}, too")
        delivery = rules.visits[shipment.delivery]
        if any(delivery.demand) or delivery.prize is not None:
            demand = "must have no demand and no prize: those of the pick-up hold for both"
            raise invalid(f"shipments/{index}/delivery", demand)
