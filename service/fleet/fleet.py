"""Fleets: stops, vehicles and rules, and the costs between the stops."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.errors import Refusal, invalid
from service.fleet.least_paths import least_paths
from service.instance import OBJECTIVES, largest_costs, ordinary_costs

Array = NDArray[np.float64]
Over = Literal["sum", "max"]
Span = tuple[float, float]
ALWAYS: Span = (0.0, inf)


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
    """Two stops: what is picked up at one is delivered to the other later, by the same vehicle."""

    pickup: int
    delivery: int


@dataclass(frozen=True, kw_only=True)
class VehicleType:
    """A number of equal vehicles.

    Args:
        start: The stop at which they start; None if each starts at its first visit.
        end: The stop at which they end; None if each ends at its last visit.
        count: How many there are.
        capacity: The most that a vehicle can hold, in each dimension.
        shift: The earliest departure and the latest end of a route.
        longest: The limit on a route: on its time if the fleet has a clock, else on its length in
            the objective that is a maximum.
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
    """All of a fleet but the costs between its stops.

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
        _check_objectives(self)
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
    def has_spans(self) -> bool:
        """Whether a window or a shift bounds any time."""
        spans = [*(visit.window for visit in self.visits), *(each.shift for each in self.vehicles)]
        return any(span != ALWAYS for span in spans)

    @property
    def has_bounds(self) -> bool:
        """Whether anything bounds a time or the length of a route."""
        return self.has_spans or any(vehicle.longest < inf for vehicle in self.vehicles)


@dataclass(frozen=True, eq=False, kw_only=True)
class Fleet:
    """Rules, and under each of two objectives the costs between the stops, shape (2, n, n).

    The costs are copied, with a diagonal of 0, and made read-only. A leg that has an infinite cost
    in one objective is forbidden, and gets infinite costs in both.
    """

    rules: Rules
    costs: Array

    def __post_init__(self) -> None:
        shape = (OBJECTIVES, self.rules.n, self.rules.n)
        if self.costs.shape != shape:
            raise ValueError(f"costs must have shape {shape}, got {self.costs.shape}")
        costs = np.where(np.eye(self.rules.n, dtype=np.bool_), 0.0, self.costs)
        if not (costs >= 0).all():
            raise ValueError("costs must be numbers and not negative")
        costs[:, np.isinf(costs).any(axis=0)] = inf
        costs.flags.writeable = False
        object.__setattr__(self, "costs", costs)

    @cached_property
    def forbids(self) -> bool:
        """Whether some leg is forbidden."""
        return bool(np.isinf(self.costs[0]).any())

    @cached_property
    def needed_legs(self) -> Array:
        """The least cost, shape (2,), such that legs up to it lead to all stops and back.

        Unreachable stops do not count.
        """
        starts = _places([vehicle.start for vehicle in self.rules.vehicles], self.rules)
        ends = _places([vehicle.end for vehicle in self.rules.vehicles], self.rules)
        return np.array([max(_least_bound(c, starts), _least_bound(c.T, ends)) for c in self.costs])

    @cached_property
    def largest_legs(self) -> Array:
        """The largest cost of a leg in ordinary plans, in each objective, shape (2,).

        Outliers count only if a stop cannot be reached or left without them.
        """
        largest, needed = largest_costs(self.costs), self.needed_legs
        ordinary = ordinary_costs(self.costs, largest)
        legs: Array = np.where(needed > ordinary, needed + ordinary, ordinary)
        return np.minimum(legs, largest)


def _places(ends: Sequence[int | None], rules: Rules) -> list[int]:
    """Return the stops at which routes start or end; one stop if a single route may start anywhere.

    Several vehicles with open routes may begin at every stop, so no stop is needed as a start.
    """
    if None not in ends:
        return sorted({end for end in ends if end is not None})
    if sum(vehicle.count for vehicle in rules.vehicles) > 1:
        return []
    return [0]


def _least_bound(costs: Array, starts: Sequence[int]) -> float:
    """Return the least cost such that legs up to it lead from the starts to all stops. O(n^2).

    Without starts, one such leg must lead to each stop.
    """
    if not starts:
        steps = np.where(np.eye(len(costs), dtype=np.bool_), inf, costs).min(axis=0)
        return float(steps.max(where=np.isfinite(steps), initial=0.0))
    bounds = least_paths(costs, starts, np.maximum)
    return float(bounds.max(where=np.isfinite(bounds), initial=0.0))


def _check_objectives(rules: Rules) -> None:
    if rules.over == ("max", "max"):
        raise invalid("objectives/1/over", "must be sum, as that of objectives/0 is max, got max")
    if rules.over[0] == "max":
        prized = (i for i, visit in enumerate(rules.visits) if visit.prize is not None)
        fixed = (i for i, vehicle in enumerate(rules.vehicles) if vehicle.fixed)
        for index in prized:
            raise _unsummed(f"stops/{index}/prize")
        for index in fixed:
            raise _unsummed(f"vehicles/{index}/fixed")


def _unsummed(part: str) -> Refusal:
    demand = "is added to the first objective, so that must be over sum, got max"
    return invalid(part, demand)


def _check_vehicle(rules: Rules, vehicle: VehicleType, part: str) -> None:
    if len(vehicle.capacity) != rules.dimensions:
        demand = f"must have {rules.dimensions} numbers, as that of vehicles/0"
        raise invalid(f"{part}/capacity", f"{demand}, got {len(vehicle.capacity)}")
    _check_span(vehicle.shift, f"{part}/shift")
    if rules.clock is None and vehicle.shift != ALWAYS:
        raise _untimed(f"{part}/shift")
    if rules.clock is None and rules.maximum is None and vehicle.longest != inf:
        demand = "needs the name of the objective that is time in clock, or an objective over max"
        raise invalid(f"{part}/longest", demand)


def _check_visit(rules: Rules, visit: Visit, index: int) -> None:
    part = f"stops/{index}"
    _check_span(visit.window, f"{part}/window")
    if index in rules.depots:
        _check_depot(visit, part)
    if visit.demand and len(visit.demand) != rules.dimensions:
        demand = f"must have {rules.dimensions} numbers, as each capacity has"
        raise invalid(f"{part}/demand", f"{demand}, got {len(visit.demand)}")
    if rules.clock is None and visit.service:
        raise _untimed(f"{part}/service")
    if rules.clock is None and visit.window != ALWAYS:
        raise _untimed(f"{part}/window")


def _check_depot(visit: Visit, part: str) -> None:
    demand = "must not be given for a stop at which vehicles start or end"
    if any(visit.demand):
        raise invalid(f"{part}/demand", demand)
    if visit.window != ALWAYS:
        raise invalid(f"{part}/window", f"{demand}: say in their shift when they may be on the way")
    for name, default in (("service", 0.0), ("prize", None)):
        if getattr(visit, name) != default:
            raise invalid(f"{part}/{name}", demand)


def _check_span(span: Span, part: str) -> None:
    if span[0] > span[1]:
        raise invalid(part, f"must not end before it begins, got {span[0]:g} to {span[1]:g}")


def _untimed(part: str) -> Refusal:
    return invalid(part, "needs the name of the objective that is time, in clock")


def _check_shipments(rules: Rules) -> None:
    for index, shipment in enumerate(rules.shipments):
        part = f"shipments/{index}"
        for name, stop in (("pickup", shipment.pickup), ("delivery", shipment.delivery)):
            if stop in rules.depots:
                raise invalid(f"{part}/{name}", "must not be a start or end of vehicles")
        delivery = rules.visits[shipment.delivery]
        if any(delivery.demand) or delivery.prize is not None:
            demand = "must have no demand and no prize: those of the pick-up hold for both"
            raise invalid(f"{part}/delivery", demand)
    _check_shipped_once(rules)


def _check_shipped_once(rules: Rules) -> None:
    """Raise a refusal if a stop is in two shipments, or twice in one."""
    names = [
        (stop, f"shipments/{index}/{name}")
        for index, each in enumerate(rules.shipments)
        for name, stop in (("pickup", each.pickup), ("delivery", each.delivery))
    ]
    first: dict[int, str] = {}
    for stop, part in names:
        if stop in first:
            raise invalid(part, f"must be in one shipment, and is {first[stop]}, too")
        first[stop] = part
