"""The rules of a fleet: what its stops and vehicles ask for, and what a plan is measured by."""

from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from service.errors import invalid
from service.fleet.groups import NO_GROUPS, Groups, check_groups
from service.fleet.rounding import is_over
from service.fleet.vehicles import ALWAYS, Shipment, Span, VehicleType, Visit

Array = NDArray[np.float64]
Over = Literal["sum", "max"]
Measure = Literal[
    "vehicles",
    "unassigned",
    "overtime",
    "lateness",
    "imbalance",
    "load_distance",
    "earliness",
    "weighted_arrival",
]
_OF_BEGINS = ("earliness", "weighted_arrival")  # measures of when each visit begins
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
    "window",
    "shift",
    "longest",
    "break",
    "before",
    "together",
    "min_stops",
    "shortest",
]


class Pace(NamedTuple):
    """How a type of vehicles drives and serves.

    Attributes:
        speed: What the times of legs are divided by.
        services: How long each visit takes.
    """

    speed: float
    services: tuple[float, ...]


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
        leave: Whether a vehicle leaves as late as makes nothing later, or as early as it may.
        groups: The groups of stops that share a vehicle, or must not, or have an order.

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
    leave: Leave = "late"
    groups: Groups = NO_GROUPS

    def __post_init__(self) -> None:
        if len(self.layers) != len(self.over):
            raise ValueError(f"there are {len(self.over)} objectives, got layers {self.layers}")
        _check_objectives(self)
        for name, given in (("slack", self.slack > 0), ("leave", self.leave != "late")):
            if given and self.clock is None:
                raise invalid(name, "untimed")
        for index, vehicle in enumerate(self.vehicles):
            _check_vehicle(self, vehicle, f"vehicles/{index}")
        for index, visit in enumerate(self.visits):
            _check_visit(self, visit, index)
        _check_shipments(self)
        check_groups(self.groups, self.depots, self.shipped)

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

    @property
    def weighs_begins(self) -> bool:
        """Whether an objective depends on when each visit begins, not only on late ones."""
        return any(over in _OF_BEGINS for over in self.over)

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
        return Pace(self.vehicles[vehicle].speed_factor, services)

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
        named = visit.vehicles or range(len(self.vehicles))
        needed = set(visit.skills)
        return frozenset(each for each in named if needed <= set(self.vehicles[each].skills))

    @cached_property
    def has_longest(self) -> bool:
        """Whether the length of some route is bounded."""
        return any(vehicle.longest < inf for vehicle in self.vehicles)

    @property
    def has_bounds(self) -> bool:
        """Whether anything bounds a time or the length of a route."""
        return bool(self.spans) or self.has_longest


def _check_vehicle(rules: Rules, vehicle: VehicleType, part: str) -> None:
    if len(vehicle.capacity) != rules.dimensions:
        values = {"numbers": rules.dimensions, "other": "/vehicles/0"}
        raise invalid(f"{part}/capacity", "not-as-first", **values, came=len(vehicle.capacity))
    _check_span(rules, vehicle.shift, f"{part}/shift")
    if vehicle.max_overtime and vehicle.shift[1] == inf:
        raise invalid(f"{part}/max_overtime", "endless-shift")
    _check_initial_load(rules, vehicle, part)
    _check_trips(rules, vehicle, part)
    _check_breaks(rules, vehicle, part)
    _check_prices(rules, vehicle, part)
    for name, given in (("longest", vehicle.longest != inf), ("shortest", vehicle.shortest > 0)):
        if rules.limited is None and given:
            raise invalid(f"{part}/{name}", "unlimited")
    if vehicle.shortest > vehicle.longest:
        raise invalid(f"{part}/shortest", "over-longest", limit=vehicle.longest)
    if vehicle.max_stops is not None and vehicle.min_stops > vehicle.max_stops:
        raise invalid(f"{part}/min_stops", "over-max-stops", limit=vehicle.max_stops)


def _check_prices(rules: Rules, vehicle: VehicleType, part: str) -> None:
    """Raise a refusal of prices and factors that count in nothing."""
    prices = {
        "fixed": vehicle.fixed > 0,
        "per_distance": vehicle.per_distance != 1,
        "per_time": vehicle.per_time > 0,
    }
    for name, given in prices.items():
        if given and rules.over[0] == "max":
            raise invalid(f"{part}/{name}", "unsummed")
    timed = {
        "per_time": vehicle.per_time > 0,
        "speed_factor": vehicle.speed_factor != 1,
        "service_factor": vehicle.service_factor != 1,
    }
    for name, given in timed.items():
        if given and rules.clock is None:
            raise invalid(f"{part}/{name}", "untimed")


def _check_initial_load(rules: Rules, vehicle: VehicleType, part: str) -> None:
    load = vehicle.initial_load
    if load and len(load) != rules.dimensions:
        numbers, came = rules.dimensions, len(load)
        raise invalid(f"{part}/initial_load", "not-as-capacity", numbers=numbers, came=came)
    for dimension, (loaded, most) in enumerate(zip(load, vehicle.capacity, strict=False)):
        if loaded > most:
            where = f"{part}/initial_load/{dimension}"
            raise invalid(where, "over-capacity", limit=most, came=loaded)


def _check_breaks(rules: Rules, vehicle: VehicleType, part: str) -> None:
    free = 0.0
    for index, (opens, closes, length) in enumerate(vehicle.breaks):
        where = f"{part}/breaks/{index}/window"
        if rules.clock is None:
            raise invalid(where, "untimed")
        if closes < opens or is_over(free, opens):
            raise invalid(where, "break-not-after", begin=opens, end=closes)
        free = closes + length


def _check_trips(rules: Rules, vehicle: VehicleType, part: str) -> None:
    if vehicle.max_trips is not None and not vehicle.reload:
        raise invalid(f"{part}/max_trips", "no-reload")
    if vehicle.reload and vehicle.max_stops is not None:
        raise invalid(f"{part}/max_stops", "also-given", member="reload")
    if rules.shipments:
        for name, given in (("reload", vehicle.reload), ("max_stops", vehicle.max_stops)):
            if given:
                raise invalid(f"{part}/{name}", "also-given", member="shipments")


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
    needed = {
        "unassigned": ("no-prizes", any(visit.prize is not None for visit in rules.visits)),
        "overtime": ("no-overtime", any(vehicle.max_overtime for vehicle in rules.vehicles)),
        "lateness": ("no-due", any(visit.due < inf for visit in rules.visits)),
        "earliness": ("no-due-from", any(visit.wanted for visit in rules.visits)),
        "load_distance": ("no-loads", rules.dimensions > 0),
    }
    code, is_given = needed.get(measure, ("", True))
    if not is_given:
        raise invalid(part, code, measure=measure)
    if measure == "weighted_arrival" and rules.clock is None:
        raise invalid(part, "untimed")
    for index, vehicle in enumerate(rules.vehicles):
        if vehicle.breaks and measure in _OF_BEGINS:
            where = f"vehicles/{index}/breaks"
            raise invalid(where, "breaks-of-measure", measure=measure, other=f"/{part}")


def _check_visit(rules: Rules, visit: Visit, index: int) -> None:
    part = f"stops/{index}"
    if index in rules.depots:
        _check_depot(visit, part)
    for name, timed in (
        ("service", visit.service),
        ("services", visit.services),
        ("due", visit.due < inf or visit.wanted > 0),
        ("release", visit.release),
    ):
        if timed and rules.clock is None:
            raise invalid(f"{part}/{name}", "untimed")
    if visit.wanted > visit.due:
        raise invalid(f"{part}/due", "ends-early", begin=visit.wanted, end=visit.due)
    for number, window in enumerate(visit.windows):
        alone = len(visit.windows) == 1
        _check_span(rules, window, f"{part}/window" if alone else f"{part}/windows/{number}")
    if visit.demand and len(visit.demand) != rules.dimensions:
        numbers, came = rules.dimensions, len(visit.demand)
        raise invalid(f"{part}/demand", "not-as-capacities", numbers=numbers, came=came)
    if visit.prize is not None and rules.over[0] == "max":
        raise invalid(f"{part}/prize", "unsummed")


def _check_depot(visit: Visit, part: str) -> None:
    members = (
        ("window", visit.windows != (ALWAYS,)),
        ("demand", any(visit.demand)),
        ("service", visit.service),
        ("services", visit.services),
        ("prize", visit.prize is not None),
        ("due", visit.due < inf or visit.wanted > 0),
        ("release", visit.release),
        ("urgency", visit.urgency != 1),
        ("skills", visit.skills),
        ("vehicle", visit.vehicles),
    )
    given = [name for name, is_given in members if is_given]
    if not given:
        return
    first, *others = given
    if first == "window":
        code = "window-and-more-of-depot" if others else "window-of-depot"
    else:
        code = "several-of-depot" if others else "of-depot"
    raise invalid(f"{part}/{first}", code, members=" or ".join(others) or None)


def _check_span(rules: Rules, span: Span, part: str) -> None:
    if span[0] > span[1]:
        raise invalid(part, "ends-early", begin=span[0], end=span[1])
    if rules.clock is None and span != ALWAYS:
        raise invalid(part, "untimed")


def _check_shipments(rules: Rules) -> None:
    parts: dict[int, str] = {}
    for index, shipment in enumerate(rules.shipments):
        for name, stop in (("pickup", shipment.pickup), ("delivery", shipment.delivery)):
            part = f"shipments/{index}/{name}"
            if stop in rules.depots:
                raise invalid(part, "shipped-to-depot")
            if parts.setdefault(stop, part) != part:
                raise invalid(part, "in-two-shipments", other=f"/{parts[stop]}")
            _check_shipped(rules.visits[stop], stop)
        delivery = rules.visits[shipment.delivery]
        if any(delivery.demand) or delivery.prize is not None:
            raise invalid(f"shipments/{index}/delivery", "delivery-asks")


def _check_shipped(visit: Visit, stop: int) -> None:
    """Raise a refusal where a stop of a shipment asks for what only other stops can."""
    if len(visit.windows) > 1:
        raise invalid(f"stops/{stop}/windows", "windows-of-shipment")
    if visit.release:
        raise invalid(f"stops/{stop}/release", "release-of-shipment")
