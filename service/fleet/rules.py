"""The rules of a fleet: what its stops and vehicles ask for, and what a plan is measured by."""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.fleet.checks import (
    Basis,
    check_depot,
    check_percents,
    check_shipments,
    check_vehicle,
    check_visit,
)
from service.fleet.groups import NO_GROUPS, Groups, check_groups, check_waiting
from service.fleet.measures.table import MEASURES, Measure
from service.fleet.vehicles import ALWAYS, Pace, Shipment, Span, VehicleType, Visit

Array = NDArray[np.float64]
Over = Literal["sum", "max"]
Leave = Literal["late", "early"]
# The rules that a route can break by itself.
Rule = Literal[
    "skills",
    "vehicle",
    "way",
    "apart",
    "capacity",
    "max_stops",
    "max_trips",
    "max_distance",
    "max_driving",
    "window",
    "shift",
    "longest",
    "break",
    "before",
    "together",
    "min_stops",
    "shortest",
]


@dataclass(frozen=True, kw_only=True)
class Rules:
    """A fleet without the costs between its stops.

    Args:
        visits: The demands of each of the n stops. Starts and ends of vehicles have none.
        vehicles: The types of vehicles.
        shipments: The pairs of stops that one vehicle must visit in order.
        over: How each of two to four objectives measures a plan: by the costs of its legs, of
            which it takes the sum over the routes, or the longest route; or by another measure. The
            first is of costs.
        layers: The number, 0 or 1, of the costs that each objective is of. Of the first it is 0,
            and of a measure it says nothing.
        clock: The number of the costs that are time. Service, windows and shifts are in its unit.
        slack: How long before a window closes a vehicle must reach the stop.
        tolerance: How much later than in a plan that is driven or was promised a visit may begin
            without a change; None for any time.
        leave: Whether a vehicle leaves as late as makes nothing later, or as early as it may.
        groups: The groups of stops that share a vehicle, or must not, or have an order.
        spread: The standard deviation of the time of each leg, as a share of it; None if that is
            not given. No rule reads it: plans are kept on an average day.
        sampled: Whether the times of the legs on several days are given instead.
        percents: The length in an objective is what so many days of a hundred do not exceed; None
            for that of a day as planned, and without any for all.
        copies: Of what stop each of the last stops is a copy, of which a plan visits one at most.

    Raises:
        Refusal: The rules contradict each other, or are not supported.
    """

    visits: tuple[Visit, ...]
    vehicles: tuple[VehicleType, ...]
    shipments: tuple[Shipment, ...] = ()
    over: tuple[Over | Measure, ...] = ("sum", "sum")
    layers: tuple[int, ...] = (0, 1)
    clock: int | None = None
    slack: float = 0.0
    tolerance: float | None = None
    leave: Leave = "late"
    groups: Groups = NO_GROUPS
    spread: float | None = None
    sampled: bool = False
    percents: tuple[int | None, ...] = ()
    copies: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if len(self.layers) != len(self.over):
            raise ValueError(f"there are {len(self.over)} objectives, got layers {self.layers}")
        _check_objectives(self)
        for name, given in (("slack", self.slack > 0), ("leave", self.leave != "late")):
            if given and self.clock is None:
                raise invalid(name, "untimed")
        basis = self._basis()
        for index, vehicle in enumerate(self.vehicles):
            check_vehicle(vehicle, f"vehicles/{index}", basis)
        for index, visit in enumerate(self.visits):
            if index in self.depots:
                check_depot(visit, f"stops/{index}")
            check_visit(visit, f"stops/{index}", basis)
        check_shipments(self.shipments, self.visits, self.depots)
        check_percents(self.percents, self._of_clock, self.vehicles, spreads=self.spreads)
        check_groups(self.groups, self.depots, self.shipped)
        others = {
            "shipments": bool(self.shipments),
            "reload": self.reloads,
            "breaks": any(vehicle.breaks for vehicle in self.vehicles),
            "spread": self.spreads,
        }
        check_waiting(self.groups, timed=self.clock is not None, others=others)

    @property
    def _costly(self) -> list[bool]:
        """Whether each objective is of costs."""
        return [over in ("sum", "max") for over in self.over]

    @property
    def _of_clock(self) -> list[bool]:
        """Whether each objective is the time of routes."""
        pairs = zip(self._costly, self.layers, strict=True)
        return [costly and layer == self.clock for costly, layer in pairs]

    def _basis(self) -> Basis:
        return Basis(
            timed=self.clock is not None,
            summed=self.over[0] != "max",
            limited=self.limited is not None,
            far=self.clock != 0 or (1, True) in zip(self.layers, self._costly, strict=True),
            ships=bool(self.shipments),
            takes=self.takes,
            dimensions=self.dimensions,
        )

    @property
    def spreads(self) -> bool:
        """Whether times differ from day to day."""
        return self.spread is not None or self.sampled

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
        """The stops at which vehicles start, end or load again."""
        ends = (end for each in self.vehicles for end in (each.start, each.end, *each.reload))
        return frozenset(end for end in ends if end is not None)

    @cached_property
    def shipped(self) -> frozenset[int]:
        """The stops of all shipments."""
        return frozenset(i for each in self.shipments for i in (each.pickup, each.delivery))

    @cached_property
    def clients(self) -> tuple[int, ...]:
        """The stops that vehicles visit: all but the depots."""
        return tuple(stop for stop in range(self.n) if stop not in self.depots)

    @cached_property
    def originals(self) -> tuple[int, ...]:
        """Of what stop each stop is a copy; itself, but for copies."""
        return (*range(self.n - len(self.copies)), *self.copies)

    @cached_property
    def required(self) -> frozenset[int]:
        """The stops to visit without a prize, which those of shipments have at the pick-up."""
        pickups = {each.delivery: each.pickup for each in self.shipments}
        free = (s for s in self.clients if self.visits[pickups.get(s, s)].prize is None)
        return frozenset(free)

    @property
    def maximum(self) -> int | None:
        """The objective that is the longest route, if there is one."""
        return self.over.index("max") if "max" in self.over else None

    @cached_property
    def limited(self) -> int | None:
        """The number of the costs that `longest` limits, and by which routes are compared.

        They are the clock, or those of the objective that is a maximum, or if routes are to be
        equally long, those of the first objective.
        """
        if self.clock is not None:
            return self.clock
        if self.maximum is not None:
            return self.layers[self.maximum]
        return 0 if "imbalance" in self.over else None

    @cached_property
    def swept(self) -> int | None:
        """The number of the costs on which the search limits routes, if it limits them."""
        if self.maximum is not None:
            return self.layers[self.maximum]
        return self.limited if "imbalance" in self.over else None

    @cached_property
    def sums(self) -> tuple[int, ...]:
        """The numbers of the costs that objectives sum, in the order of the objectives."""
        pairs = zip(self.layers, self.over, strict=True)
        return tuple(dict.fromkeys(layer for layer, over in pairs if over == "sum"))

    @cached_property
    def windows(self) -> tuple[tuple[Span, ...], ...]:
        """The windows of each stop, in one of which a vehicle must reach it, with the slack.

        A vehicle that reaches the stop before the begin of a window waits. A window that is shorter
        than the slack ends before it begins.
        """
        if not self.slack:
            return tuple(visit.windows for visit in self.visits)
        slack = self.slack
        return tuple(
            tuple((opens, closes - slack) for opens, closes in visit.windows)
            for visit in self.visits
        )

    @cached_property
    def begin(self) -> float:
        """The begin of the first shift: weighted arrivals count from then."""
        return min(vehicle.shift[0] for vehicle in self.vehicles)

    @cached_property
    def of_begins(self) -> tuple[Over | Measure, ...]:
        """The objectives that depend on when each visit begins, not only on late ones."""
        names = [name for name, each in MEASURES.items() if each.of_begins]
        names += ["changes"] if self.tolerance is not None else []
        return tuple(over for over in self.over if over in names)

    def percent(self, objective: int) -> int | None:
        """Return on how many days of a hundred a length is not exceeded; None for one day."""
        return self.percents[objective] if objective < len(self.percents) else None

    @cached_property
    def of_days(self) -> bool:
        """Whether an objective depends on how times spread from day to day."""
        return "on_time" in self.over or any(self.percents)

    @cached_property
    def promises(self) -> frozenset[int]:
        """The stops of a plan that is driven or was promised."""
        return frozenset(i for i, each in enumerate(self.visits) if each.promised_to is not None)

    @cached_property
    def promised_until(self) -> tuple[float, ...]:
        """When each visit begins at the latest so that it is not later than promised."""
        if self.tolerance is None:
            return (inf,) * self.n
        return tuple(visit.promised_by + self.tolerance for visit in self.visits)

    @cached_property
    def holds(self) -> tuple[float, ...]:
        """When each visit begins at the latest so that its vehicle may leave later than it must."""
        if "changes" not in self.over:
            return tuple(visit.due for visit in self.visits)
        pairs = zip(self.visits, self.promised_until, strict=True)
        return tuple(min(visit.due, until) for visit, until in pairs)

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """All windows, releases, due times and shifts that bound any time."""
        visits = self.visits
        windows = (window for each in self.windows for window in each)
        released = ((visit.release, inf) for visit in visits)
        due = ((visit.wanted, visit.due) for visit in visits)
        spans = (*windows, *released, *due, *(vehicle.way for vehicle in self.vehicles))
        return tuple(span for span in spans if span != ALWAYS)

    @cached_property
    def reloads(self) -> bool:
        """Whether some vehicles may load again on their way."""
        return any(vehicle.reload for vehicle in self.vehicles)

    @cached_property
    def takes(self) -> bool:
        """Whether some stops put something on board that stays there."""
        return any(any(visit.pickup) for visit in self.visits)

    @cached_property
    def priced(self) -> bool:
        """Whether the first length of some route is not just that of its first costs."""
        return any((each.per_distance, each.per_time) != (1.0, 0.0) for each in self.vehicles)

    def service(self, vehicle: int, stop: int) -> float:
        """Return how long a type of vehicles takes to visit a stop."""
        return self.visits[stop].service_by(vehicle) * self.vehicles[vehicle].service_factor

    def speed(self, vehicle: int, layer: int) -> float:
        """Return what a type of vehicles divides a cost of its legs by: 1 unless it is the time."""
        return self.vehicles[vehicle].speed_factor if layer == self.clock else 1.0

    def pace(self, vehicle: int) -> Pace:
        """Return how a type of vehicles drives and serves."""
        services = tuple(self.service(vehicle, stop) for stop in range(self.n))
        each = self.vehicles[vehicle]
        return Pace(each.speed_factor, services, each.profile)

    def most_legs(self, vehicle: int) -> tuple[float, float]:
        """Return the most of both costs of a route's legs, by a type of vehicles."""
        each = self.vehicles[vehicle]
        time, distance = each.max_driving, each.max_distance
        return (time, distance) if self.clock == 0 else (distance, time)

    @cached_property
    def capped(self) -> tuple[int, ...]:
        """The numbers of the costs of legs that some type of vehicles bounds by themselves."""
        most = np.min([self.most_legs(each) for each in range(len(self.vehicles))], axis=0)
        return tuple(np.flatnonzero(np.isfinite(most)).tolist())

    def servers(self, stop: int) -> frozenset[int]:
        """Return the types of vehicles that may visit a stop: by its skills, and if it names some.

        For a stop of a shipment these are the types that may visit both of its stops, and for one
        that rides with others those that may visit all.
        """
        return self._servers[stop]

    @cached_property
    def _servers(self) -> tuple[frozenset[int], ...]:
        alone = [self._servers_alone(visit) for visit in self.visits]
        for each in self.shipments:
            both = alone[each.pickup] & alone[each.delivery]
            alone[each.pickup] = alone[each.delivery] = both
        for mates in self.groups.mates.values():
            shared = frozenset.intersection(*(alone[stop] for stop in mates))
            for stop in mates:
                alone[stop] = shared
        return tuple(alone)

    def _servers_alone(self, visit: Visit) -> frozenset[int]:
        types = range(len(self.vehicles))
        named = [each for each in visit.vehicles if each in types] if visit.vehicles else types
        needed = set(visit.skills)
        return frozenset(each for each in named if needed <= set(self.vehicles[each].skills))

    @cached_property
    def has_longest(self) -> bool:
        """Whether the length of some route is bounded."""
        return any(vehicle.longest < inf for vehicle in self.vehicles)

    @property
    def has_bounds(self) -> bool:
        """Whether anything bounds a time or the length of a route."""
        return bool(self.spans or self.capped) or self.has_longest


def _check_objectives(rules: Rules) -> None:
    """Raise a refusal unless the objectives fit each other, and the data what they measure."""
    first, *others = rules.over
    if first not in ("sum", "max"):
        raise invalid("objectives/0/measure", "first-measure")
    for index, over in enumerate(others, start=1):
        part = f"objectives/{index}"
        if over == "max" and "max" in rules.over[:index]:
            before = f"/objectives/{rules.over.index('max')}"
            raise invalid(f"{part}/over", "second-max", other=before)
        if over == "sum" or over == "max":
            continue
        if over in rules.over[:index]:
            before = f"/objectives/{rules.over.index(over)}"
            raise invalid(f"{part}/measure", "same-measure", other=before, given=over)
        if first == "max":
            raise invalid(f"{part}/measure", "needs-sum")
        _check_measured(rules, over, f"{part}/measure")
    if first == "max" and len(others) > 1:
        raise invalid("objectives/0/over", "max-of-three")


def _check_measured(rules: Rules, measure: Measure, part: str) -> None:
    """Raise a refusal unless the data have what a measure is of."""
    row = MEASURES[measure]
    lacking = row.lacking
    if lacking and not row.given(rules.visits, rules.vehicles):
        raise invalid(part, lacking, measure=measure)
    if row.unit == "clock" and not lacking and rules.clock is None:
        raise invalid(part, "untimed")
    if measure == "on_time" and not rules.spreads:
        raise invalid(part, "measure-without-spread")
    for index, vehicle in enumerate(rules.vehicles):
        if vehicle.breaks and measure in (*rules.of_begins, "on_time"):
            where = f"vehicles/{index}/breaks"
            raise invalid(where, "breaks-of-measure", measure=measure, other=f"/{part}")
