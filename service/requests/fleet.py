"""Requests of `POST /fleet`: their fields, and their parser."""

from collections.abc import Mapping, Sequence
from typing import Annotated

from pydantic import Field
from pydantic_core import to_json

from service.errors import invalid
from service.fleet.rules import (
    Rules,
    VehicleType,
)
from service.objectives import OBJECTIVES
from service.requests.fields import (
    GEOMETRY,
    Geometry,
    Items,
    OneForBoth,
    SearchFields,
    SomeItems,
)
from service.requests.fleet_fields import (
    Clock,
    ClockItem,
    FleetObjectiveItem,
    FleetStopItem,
    ShipmentItem,
    VehicleItem,
)
from service.requests.limits import Limits, check_amounts, check_limit, lower_defaults
from service.requests.stop_fields import (
    check_unique,
    read_objectives,
    read_sources,
    read_stops,
)
from service.requests.stops import Labels, Source, Stop, Stops, locations_of
from service.requests.task import UnmeasuredFleet, VehicleName, types_by_id
from service.requests.validation import parse_json, show, too_many_cities

_MOST_VEHICLE_TYPES = 100


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
    clock: Clock | None = Field(
        default=None,
        description="the name of the objective that is time; or, where the second objective is a"
        " measure, the source of times that are no objective. All times are in its unit; the length"
        " of a route in it includes service and waiting",
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
        types = types_by_id(names)
        first, second = self.objectives
        rules = Rules(
            visits=tuple(item.visit(f"stops/{i}", types) for i, item in enumerate(self.stops)),
            vehicles=vehicles,
            shipments=tuple(
                item.shipment(f"shipments/{i}", ids) for i, item in enumerate(self.shipments)
            ),
            over=(first.of_plan or first.over, second.of_plan or second.over),
            clock=self._clock(),
        )
        stops = Stops(locations_of(labels.stops), self._sources(labels.stops))
        return UnmeasuredFleet(rules, names, stops)

    def _vehicles(
        self, ids: Mapping[str, int]
    ) -> tuple[tuple[VehicleType, ...], tuple[VehicleName, ...]]:
        """Return the types of vehicles and their names: the first shifts first, in their order."""
        shifts = [
            (number, VehicleName(item.id, number if len(item.shifts) > 1 else None), vehicle)
            for i, item in enumerate(self.vehicles)
            for number, vehicle in enumerate(item.vehicle_types(f"vehicles/{i}", ids))
        ]
        if len(shifts) > _MOST_VEHICLE_TYPES:
            demand = f"must have at most {_MOST_VEHICLE_TYPES} shifts in all, got {len(shifts)}"
            raise invalid("vehicles", demand)
        shifts.sort(key=lambda each: each[0])
        return tuple(each[2] for each in shifts), tuple(each[1] for each in shifts)

    def _sources(self, stops: Sequence[Stop]) -> list[Source]:
        """Return the sources of two costs: of both objectives, or of one and the clock.

        If only one has costs, the second are the same.
        """
        costs = [item for item in self.objectives if item.of_plan is None]
        sources = read_sources(costs, stops)
        for index, item in enumerate(self.objectives):
            if item.of_plan is not None and {*item.sources, "over"} & item.model_fields_set:
                raise invalid(
                    f"objectives/{index}", "must have either a measure, or costs and over"
                )
        if isinstance(self.clock, ClockItem):
            self.clock.objective("clock")
            sources.append(self.clock.source("clock", stops))
        return [*sources, sources[0]][:OBJECTIVES]

    def _clock(self) -> int | None:
        """Return the number of the costs that are time."""
        names = [item.name for item in self.objectives if item.of_plan is None]
        if self.clock is None:
            return None
        if isinstance(self.clock, ClockItem):
            if len(names) == OBJECTIVES:
                demand = "must be the name of an objective where both objectives have costs"
                raise invalid("clock", demand)
            return 1
        if self.clock not in names:
            demand = f"must be {' or '.join(map(show, names))}, the name of an objective with costs"
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
