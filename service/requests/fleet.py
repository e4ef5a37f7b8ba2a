"""Requests of `POST /fleet`: their fields, and their parser."""

from collections.abc import Mapping, Sequence
from typing import Annotated

from pydantic import Field
from pydantic_core import to_json

from service.errors import invalid
from service.errors.faults import show
from service.fleet.fleet import LAYERS
from service.fleet.groups import Groups
from service.fleet.rules import Leave, Rules
from service.fleet.vehicles import VehicleType
from service.objectives import Objective
from service.requests.day_fields import check_in_seconds
from service.requests.fields import (
    GEOMETRY,
    Geometry,
    Items,
    OneEach,
    SearchFields,
    SomeItems,
    Time,
    at_most,
    empty_list,
    optional,
)
from service.requests.fleet_fields import (
    Clock,
    ClockItem,
    FleetObjectiveItem,
    FleetStopItem,
    ShipmentItem,
    TimesItem,
    VehicleItem,
)
from service.requests.group_fields import ApartItem, BeforeItem, References
from service.requests.limits import Limits, check_limit, objective_at, within_limits
from service.requests.profile_fields import (
    Profile,
    check_profiles,
    check_road_profiles,
)
from service.requests.promises import PromisedItem, promised_plan
from service.requests.stop_fields import (
    check_unique,
    find_indexes,
    read_objectives,
    read_stops,
)
from service.requests.stops import Labels, Source, Stop, Stops, locations_of
from service.requests.task import UnmeasuredFleet, VehicleName, types_by_id
from service.requests.validation import parse_json, too_many_cities

_MOST_VEHICLE_TYPES = 100
_SOME_GROUPS = at_most(50)


class FleetRequest(SearchFields):
    """Stops, vehicles and two to four objectives, and the options of their front of plans."""

    stops: SomeItems[FleetStopItem] = Field(description="by ids that come back with every plan")
    vehicles: Annotated[
        list[VehicleItem], Field(min_length=1, max_length=_MOST_VEHICLE_TYPES, fail_fast=True)
    ] = Field(description="the types of vehicles")
    objectives: OneEach[FleetObjectiveItem] = Field(
        description="two to four: costs between the stops, of two kinds at most, or other measures"
        " of plans"
    )
    shipments: Items[ShipmentItem] = empty_list("pairs of stops that one vehicle visits, in order")
    together: Annotated[list[References], _SOME_GROUPS] = empty_list(
        "groups of stops, by index or id: one vehicle visits all of a group on one route, or none"
        " of it if all may be left out"
    )
    apart: Annotated[list[ApartItem], _SOME_GROUPS] = empty_list(
        "stops that must not be on one route"
    )
    before: Annotated[list[BeforeItem], _SOME_GROUPS] = empty_list(
        "stops that come before others, on one route or whoever drives"
    )
    clock: Clock | None = optional(
        "the name of the objective that is time; or, where the costs of all objectives are the"
        " same, the source of times that are not an objective. All times are in its unit; the"
        " length of a route in it includes service and waiting"
    )
    slack: Time = Field(
        default=0.0,
        description="how long before a window closes a vehicle must reach the stop, in the clock's"
        " unit; there it waits until the window opens. So delays up to this make nobody late",
    )
    leave: Leave = Field(
        default="late",
        description="whether a vehicle leaves as late as it can without being done later, or as"
        " early as its shift and its load allow",
    )
    promised: PromisedItem | None = optional(
        "a plan that is driven or was promised: the search starts from it, and the measure"
        " `changes` counts what is not kept of it"
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)

    @property
    def labels(self) -> Labels:
        """The names of stops and objectives."""
        return Labels(read_stops(self.stops), read_objectives(self.objectives))

    @property
    def id_bytes(self) -> int:
        """The bytes of all ids in one plan of the answer, at most."""
        stops = [len(to_json(stop.id)) for stop in self.stops]
        routes = min(
            sum(vehicle.count * max(1, len(vehicle.shifts)) for vehicle in self.vehicles),
            len(stops),
        )
        if any(vehicle.reload for vehicle in self.vehicles):
            routes *= 2  # a vehicle loads again once for each visit at most
        of_route = max(len(to_json(vehicle.id)) for vehicle in self.vehicles) + 2 * max(stops)
        return sum(stops) + routes * of_route

    def subject(self) -> UnmeasuredFleet:
        """Return the fleet, whose costs are still to be measured.

        Raises:
            Refusal: An id is unknown, or the rules contradict each other.
        """
        labels = self.labels
        ids = {stop.id: index for index, stop in enumerate(labels.stops)}
        check_unique([item.id for item in self.vehicles], "vehicles")
        vehicles, names = self._vehicles(ids)
        plan = self.promised and promised_plan(self.promised, vehicles, names, ids)
        if plan:
            vehicles, names = plan.types.vehicles, plan.names
        types = types_by_id(names)
        visits = tuple(item.visit(f"stops/{i}", types) for i, item in enumerate(self.stops))
        costs, layers = self._layers()
        self._check_spread()
        self._check_day()
        profiles = [item.profile for item in self.vehicles]
        check_profiles(profiles, self._costs)
        sampled = None
        if self._times:
            part, times = self._times
            sampled = times.sampled(part, len(ids), times.spread)
        rules = Rules(
            visits=plan.visits(visits, self.slack) if plan else visits,
            vehicles=vehicles,
            shipments=tuple(
                item.shipment(f"shipments/{i}", ids) for i, item in enumerate(self.shipments)
            ),
            over=tuple(item.of_plan or item.over for item in self.objectives),
            layers=layers,
            clock=self._clock(costs, layers),
            slack=self.slack,
            tolerance=self._tolerance,
            leave=self.leave,
            groups=self._groups(ids),
            spread=self._times and self._times[1].spread,
            sampled=sampled is not None,
            percents=self._percents,
        )
        kinds = tuple(dict.fromkeys(profiles))
        sources = self._sources(costs, labels.stops, kinds)
        spreads = (sampled,) if sampled else ()
        stops = Stops(locations_of(labels.stops), sources, spreads=spreads)
        driven = plan.routes if plan else ()
        clock = self._named_clock
        return UnmeasuredFleet(rules, names, stops, driven, clock=clock, profiles=kinds)

    @property
    def _costs(self) -> dict[str, TimesItem]:
        """The items that are sources of costs, by their part of the request."""
        objectives = enumerate(self.objectives)
        found: dict[str, TimesItem] = {
            objective_at(m): item for m, item in objectives if item.of_plan is None
        }
        return {**found, "clock": self.clock} if isinstance(self.clock, ClockItem) else found

    def check_road_profiles(self, known: Sequence[str]) -> None:
        """Raise a refusal of a profile that the operator's routing engine does not know."""
        check_road_profiles([i.profile for i in self.vehicles], self._costs.values(), known)

    @property
    def _times(self) -> tuple[str, TimesItem] | None:
        """The item that has the clock's times, after its part of the request; None for none."""
        if isinstance(self.clock, ClockItem):
            return "clock", self.clock
        return next((pair for pair in self._costs.items() if pair[1].name == self.clock), None)

    def _check_spread(self) -> None:
        """Raise a refusal of costs that spread, but are not the clock's or change over the day."""
        names = [item.name for item in self.objectives]
        named = names.index(self.clock) if self.clock in names else None
        for index, item in enumerate(self.objectives):
            if item.spread is not None and (item.of_plan is not None or index != named):
                raise invalid(f"objectives/{index}/spread", "spread-of-clock")
            if item.days and (named is None or not self._same_costs(named, index)):
                raise invalid(f"objectives/{index}/days", "spread-of-clock")
        changes = any(item.changes for item in self._costs.values())
        if changes and self._times and self._times[1].days:
            raise invalid(f"{self._times[0]}/days", "spread-over-the-day")

    @property
    def _percents(self) -> tuple[int | None, ...]:
        """The percentile that each objective is of; nothing if none is."""
        percents = tuple(item.percentile for item in self.objectives)
        return percents if any(percents) else ()

    @property
    def _tolerance(self) -> float | None:
        """How much later than promised a visit may begin; None for any time."""
        tolerance = None if self.promised is None else self.promised.tolerance
        if tolerance is not None and self.clock is None:
            raise invalid("promised/tolerance", "untimed")
        return tolerance

    def _check_day(self) -> None:
        """Raise a refusal where costs change over the day without a clock in seconds."""
        own = [self.clock] if isinstance(self.clock, ClockItem) else []
        if not any(item.changes for item in (*self.objectives, *own)):
            return
        if self.clock is None:
            raise invalid("clock", "no-clock-of-day")
        named = self._named_clock
        if named is not None:
            names = [item.name for item in self.objectives]
            check_in_seconds(named, "clock" if own else f"objectives/{names.index(named.name)}")
        for index, each in enumerate(self.before):
            if each.vehicles == "any":
                raise invalid(f"before/{index}/vehicles", "waits-over-the-day")
        by_pair = any(item.breakpoints for item in self._costs.values())
        for index, vehicle in enumerate(self.vehicles):
            if by_pair and vehicle.speed_factor < 1:
                came = vehicle.speed_factor
                raise invalid(f"vehicles/{index}/speed_factor", "slower-by-breakpoints", came=came)

    def _groups(self, ids: Mapping[str, int]) -> Groups:
        """Return the groups of stops."""

        def found(references: Sequence[int | str], part: str) -> tuple[int, ...]:
            return find_indexes(references, ids, part)

        return Groups(
            together=tuple(found(each, f"together/{i}") for i, each in enumerate(self.together)),
            apart=tuple(
                (found(each.stops, f"apart/{i}/stops"), found(each.others, f"apart/{i}/others"))
                for i, each in enumerate(self.apart)
            ),
            before=tuple(
                (found(each.first, f"before/{i}/first"), found(each.then, f"before/{i}/then"))
                for i, each in enumerate(self.before)
            ),
            gaps=tuple(each.least_gap(f"before/{i}") for i, each in enumerate(self.before)),
        )

    @property
    def _named_clock(self) -> Objective | None:
        """The name and unit of the times, if there is a clock."""
        if isinstance(self.clock, ClockItem):
            return self.clock.objective("clock")
        return next((each for each in self.labels.objectives if each.name == self.clock), None)

    def _vehicles(
        self, ids: Mapping[str, int]
    ) -> tuple[tuple[VehicleType, ...], tuple[VehicleName, ...]]:
        """Return the types of vehicles and their names: the first shifts first, in their order."""
        kinds = list(dict.fromkeys(item.profile for item in self.vehicles))
        shifts = [
            (number, VehicleName(item.id, number if len(item.shifts) > 1 else None), vehicle)
            for i, item in enumerate(self.vehicles)
            for number, vehicle in enumerate(
                item.vehicle_types(f"vehicles/{i}", ids, kinds.index(item.profile))
            )
        ]
        if len(shifts) > _MOST_VEHICLE_TYPES:
            most, came = _MOST_VEHICLE_TYPES, len(shifts)
            raise invalid("vehicles", "too-many-shifts", limit=most, came=came)
        shifts.sort(key=lambda each: each[0])
        return tuple(each[2] for each in shifts), tuple(each[1] for each in shifts)

    def _layers(self) -> tuple[list[int], tuple[int, ...]]:
        """Return the objectives that bring costs, and which of these costs each objective is of.

        Where more objectives have costs, some have the same. Of a measure they do not matter.
        """
        # Objectives that share costs also share the clock, so only those that must do, or that ask
        # for percentiles of its times, have its days, or stand beside times of their own.
        costly = sum(item.of_plan is None for item in self.objectives)
        sampled = any(item.days for item in self.objectives)
        shared = costly > LAYERS or bool(self._percents) or sampled
        shared = shared or isinstance(self.clock, ClockItem)
        costs: list[int] = []
        layers: list[int] = []
        for index, item in enumerate(self.objectives):
            part = f"objectives/{index}"
            if item.of_plan is not None:
                if item.sources or item.changes or "over" in item.model_fields_set:
                    raise invalid(part, "measure-and-costs")
                layers.append(0)
                continue
            same = (number for number, each in enumerate(costs) if self._same_costs(each, index))
            layers.append(next(same, len(costs)) if shared else len(costs))
            if layers[-1] == len(costs):
                costs.append(index)
            if len(costs) > LAYERS:
                raise invalid(part, "third-costs")
        return costs, tuple(layers)

    def _same_costs(self, first: int, second: int) -> bool:
        """Return whether two objectives have the same costs between the stops."""
        a, b = (self.objectives[index] for index in (first, second))
        names = TimesItem.model_fields.keys() - {"name", "unit", "spread"}
        return all(getattr(a, name) == getattr(b, name) for name in names)

    def _sources(
        self, costs: Sequence[int], stops: Sequence[Stop], profiles: Sequence[Profile]
    ) -> list[Source]:
        """Return the sources of two costs by each profile: of objectives, or of one and the clock.

        If there is only one, the second are the same.
        """
        items = ((part, self._costs[part]) for part in self._parts(costs))
        sources = [item.sources_by(part, stops, profiles) for part, item in items]
        pairs = zip(*[*sources, *sources[:1]][:LAYERS], strict=True)
        return [source for pair in pairs for source in pair]

    def _parts(self, costs: Sequence[int]) -> list[str]:
        """Return the parts of the request that have the costs: objectives, and maybe the clock."""
        own = ["clock"] if isinstance(self.clock, ClockItem) else []
        return [*map(objective_at, costs), *own]

    def part_of_source(self, number: int) -> str:
        """Return the part of the request that has a source of the stops, by its number."""
        parts = self._parts(self._layers()[0])
        return parts[number % len(parts)]  # each profile has sources of all parts

    def _clock(self, costs: Sequence[int], layers: Sequence[int]) -> int | None:
        """Return the number of the costs that are time."""
        if self.clock is None:
            return None
        if isinstance(self.clock, ClockItem):
            if len(costs) == LAYERS:
                raise invalid("clock", "clock-with-costs")
            return 1
        items = zip(self.objectives, layers, strict=True)
        names = {item.name: layer for item, layer in items if item.of_plan is None}
        if self.clock not in names:
            known = " or ".join(map(show, names))
            raise invalid("clock", "no-clock", names=known, came=self.clock)
        return names[self.clock]


def parse_fleet_request(body: bytes, limits: Limits) -> FleetRequest:
    """Return the request in a JSON body, with defaults that are over a limit lowered to it.

    Raises:
        Refusal: The body is not JSON, misses the schema or is over a limit.
    """
    request = parse_json(FleetRequest, body)
    if len(request.stops) > limits.fleet_stops:
        raise too_many_cities("stops", limits.fleet_stops, len(request.stops))
    check_limit("shipments", limits.fleet_stops, len(request.shipments))
    return within_limits(request, len(request.stops), limits, request.id_bytes)
