"""Requests of `POST /fleet`: their fields, and their parser."""

from collections.abc import Mapping
from math import inf
from typing import Annotated

from pydantic import Field
from pydantic_core import to_json

from service.errors import invalid
from service.fleet.rules import ALWAYS, Over, Rules, Shipment, Span, VehicleType, Visit
from service.requests.fields import (
    GEOMETRY,
    AsInteger,
    Cost,
    Geometry,
    Items,
    OneForBoth,
    Pair,
    PositiveNumber,
    SearchFields,
    SomeItems,
    StrictModel,
    Text,
    optional,
)
from service.requests.limits import Limits, check_amounts, check_limit, lower_defaults
from service.requests.stop_fields import (
    ObjectiveItem,
    StopItem,
    StopReference,
    check_unique,
    find_index,
    read_objectives,
    read_sources,
    read_stops,
)
from service.requests.stops import Labels, Stops, locations_of
from service.requests.task import UnmeasuredFleet
from service.requests.validation import parse_json, show, too_many_cities

_MOST_VEHICLE_TYPES = 100
_MOST_LOAD = 10**9
_MOST_DIMENSIONS = 8
_MOST_COUNT = 10**6
Load = Annotated[int, Field(ge=0, le=_MOST_LOAD), AsInteger]
Loads = Annotated[list[Load], Field(max_length=_MOST_DIMENSIONS, fail_fast=True)]
# A pair in JSON, and a list so that OpenAPI has its length.
TimeSpan = Pair[Cost]


class FleetStopItem(StopItem):
    """A stop, and its demands on the vehicle that visits it."""

    demand: Loads = Field(
        default_factory=list,
        description="whole numbers, one for each dimension of the vehicle's capacity: what it"
        " delivers, or what it takes on where the stop is the pick-up of a shipment",
    )
    service: Cost = Field(default=0.0, description="how long a visit takes, in the clock's unit")
    window: TimeSpan | None = optional("when a visit may begin, from and to")
    prize: Cost | None = optional(
        "added to the first length if the stop is left out; a stop without a prize is"
        " always visited"
    )

    def visit(self) -> Visit:
        """Return the stop as a visit of a vehicle."""
        return Visit(
            demand=tuple(self.demand),
            service=self.service,
            window=_span(self.window),
            prize=self.prize,
        )


class ShipmentItem(StrictModel):
    """Two stops that one vehicle visits: the pick-up, and later the delivery."""

    pickup: StopReference = Field(
        description="by index or id; its demand and prize count for both stops"
    )
    delivery: StopReference = Field(description="by index or id")

    def shipment(self, part: str, ids: Mapping[str, int]) -> Shipment:
        """Return the shipment, whose part of the request is `part`, as shipments/0.

        Raises:
            Refusal: One of both is not a stop.
        """
        pickup = find_index(self.pickup, ids, f"{part}/pickup", len(ids))
        return Shipment(pickup, find_index(self.delivery, ids, f"{part}/delivery", len(ids)))


class VehicleItem(StrictModel):
    """A type of vehicle, and how many of it there are."""

    id: Text = Field(description="comes back with every route; no two types share one")
    count: Annotated[int, Field(ge=1, le=_MOST_COUNT), AsInteger] = Field(
        default=1, description="how many there are"
    )
    start: StopReference | None = optional(
        "the stop at which they start, by index or id; null: each at its first visit"
    )
    end: StopReference | None = optional(
        "the stop at which they end, by index or id; null: each at its last visit"
    )
    capacity: Loads = Field(
        default_factory=list, description="the most that one holds, in up to 8 dimensions"
    )
    shift: TimeSpan | None = optional("when one may leave, and must be back")
    longest: PositiveNumber | None = optional(
        "the limit on each route: on its time if there is a clock, else on its length in"
        " the objective whose `over` is max"
    )
    fixed: Cost = Field(default=0.0, description="added to the first length if one is used")

    def vehicle_type(self, part: str, ids: Mapping[str, int]) -> VehicleType:
        """Return the type of vehicles, whose part of the request is `part`, as vehicles/0.

        Raises:
            Refusal: Its start or its end is not a stop.
        """
        start, end = (
            None if stop is None else find_index(stop, ids, f"{part}/{name}", len(ids))
            for name, stop in (("start", self.start), ("end", self.end))
        )
        return VehicleType(
            start=start,
            end=end,
            count=self.count,
            capacity=tuple(self.capacity),
            shift=_span(self.shift),
            longest=inf if self.longest is None else self.longest,
            fixed=self.fixed,
        )


class FleetObjectiveItem(ObjectiveItem):
    """An objective by its name, the source of its costs, and how routes make a plan's length."""

    over: Over = Field(
        default="sum",
        description="whether the length of a plan is the sum over its routes or the longest route;"
        " max for one objective at most",
    )


def _span(bounds: list[float] | None) -> Span:
    return ALWAYS if bounds is None else (bounds[0], bounds[1])


class FleetRequest(SearchFields):
    """Stops, vehicles and two objectives, and the options of their front of plans."""

    stops: SomeItems[FleetStopItem] = Field(description="by ids that come back with every plan")
    vehicles: Annotated[
        list[VehicleItem], Field(min_length=1, max_length=_MOST_VEHICLE_TYPES, fail_fast=True)
    ] = Field(description="the types of vehicles")
    objectives: OneForBoth[FleetObjectiveItem] = Field(
        description="both, each with the costs between the stops"
    )
    shipments: Items[ShipmentItem] = Field(
        default_factory=list, description="pairs of stops that one vehicle visits, in order"
    )
    clock: Text | None = Field(
        default=None,
        description="the name of the objective that is time. Windows, shifts, service and longest"
        " are in its unit; the length of a route in it includes service and waiting",
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
        routes = min(sum(vehicle.count for vehicle in self.vehicles), len(stops))
        of_route = max(len(to_json(vehicle.id)) for vehicle in self.vehicles) + 2 * max(stops)
        return sum(stops) + routes * of_route

    def subject(self) -> UnmeasuredFleet:
        """Return the fleet, whose costs are still to be measured.

        Raises:
            Refusal: An id is unknown, or the rules contradict each other.
        """
        labels = self.labels
        ids = {stop.id: index for index, stop in enumerate(labels.stops)}
        sources = read_sources(self.objectives, labels.stops)
        stops = Stops(locations_of(labels.stops), sources)
        rules = Rules(
            visits=tuple(item.visit() for item in self.stops),
            vehicles=tuple(
                item.vehicle_type(f"vehicles/{i}", ids) for i, item in enumerate(self.vehicles)
            ),
            shipments=tuple(
                item.shipment(f"shipments/{i}", ids) for i, item in enumerate(self.shipments)
            ),
            over=(self.objectives[0].over, self.objectives[1].over),
            clock=self._clock(),
        )
        names = tuple(item.id for item in self.vehicles)
        check_unique(names, "vehicles")
        return UnmeasuredFleet(
            rules,
            names,
            stops,
        )

    def _clock(self) -> int | None:
        names = [item.name for item in self.objectives]
        if self.clock is None:
            return None
        if self.clock not in names:
            demand = f"must be {show(names[0])} or {show(names[1])}, an objective's name"
            raise invalid("clock", f"{demand}, got {show(self.clock)}")
        return names.index(self.clock)


def parse_fleet_request(body: bytes, limits: Limits) -> FleetRequest:
    """Return the request in a JSON body, with defaults that are over a limit lowered to it.

    Raises:
        Refusal: The body is not JSON, misses the schema or is over a limit.
    """
    request = parse_json(FleetRequest, body)
    if len(request.stops) > limits.fleet_stops:
        raise too_many_cities("stops", limits.fleet_stops, len(request.stops))
    check_limit("shipments", limits.fleet_stops, len(request.shipments))
    n, id_bytes = len(request.stops), request.id_bytes
    check_amounts(request, n, limits, id_bytes)
    return lower_defaults(request, n, limits, id_bytes)
