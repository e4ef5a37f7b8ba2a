"""Requests of `POST /fleet`: their fields, their checks, and what they mean for a plan."""

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field
from pydantic_core import to_json

from service.errors import invalid
from service.fleet.fleet import Rules, Shipment, VehicleType
from service.front import PlanOptions
from service.instance import OBJECTIVES
from service.requests.fleets.fields import (
    FleetObjectiveItem,
    FleetStopItem,
    ShipmentItem,
    VehicleItem,
)
from service.requests.fleets.subject import UnmeasuredFleet
from service.requests.limits import Limits, check_limit, check_size, defaults
from service.requests.schemas import (
    GEOMETRY,
    Geometry,
    NonNegativeInteger,
    PositiveInteger,
    PositiveNumber,
    Text,
)
from service.requests.stop_fields import find_index, read_objectives, read_stops
from service.requests.stops import Labels, Stops, locations_of
from service.requests.validation import parse_json, show, too_many_cities

_MOST_VEHICLE_TYPES = 100


class FleetRequest(BaseModel):
    """Stops, vehicles and two objectives, and the options of their front of plans."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    stops: Annotated[list[FleetStopItem], Field(min_length=1, fail_fast=True)] = Field(
        description="by ids that come back with every plan"
    )
    vehicles: Annotated[
        list[VehicleItem], Field(min_length=1, max_length=_MOST_VEHICLE_TYPES, fail_fast=True)
    ] = Field(description="the types of vehicles")
    objectives: Annotated[
        list[FleetObjectiveItem],
        Field(min_length=OBJECTIVES, max_length=OBJECTIVES, fail_fast=True),
    ] = Field(description="both, each with the costs between the stops")
    shipments: Annotated[list[ShipmentItem], Field(fail_fast=True)] = Field(
        default_factory=list, description="pairs of stops that one vehicle visits, in order"
    )
    clock: Text | None = Field(
        default=None,
        description="the name of the objective that is time; in its unit are windows, shifts,"
        " service and longest, and a route's length in it is its time with service and waiting",
    )
    time_limit: float = Field(
        default=1.0,
        ge=0,
        allow_inf_nan=False,
        description="seconds of all planning, at most; at 0 the plans are the network's alone",
    )
    size: PositiveInteger = Field(default=100, description="the most plans to return")
    reference_point: list[PositiveNumber] = Field(
        default_factory=list,
        min_length=OBJECTIVES,
        max_length=OBJECTIVES,
        description="of the hypervolume; by default lengths above those of all sensible plans",
    )
    geometry: Geometry = Field(default="straight", description=GEOMETRY)
    seed: NonNegativeInteger = Field(default=0, description="of everything random in the search")

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
        items = enumerate(self.objectives)
        sources = [item.source(f"objectives/{m}", labels.stops) for m, item in items]
        rules = Rules(
            visits=tuple(item.visit() for item in self.stops),
            vehicles=tuple(_vehicle(item, i, ids) for i, item in enumerate(self.vehicles)),
            shipments=tuple(_shipment(item, i, ids) for i, item in enumerate(self.shipments)),
            over=(self.objectives[0].over, self.objectives[1].over),
            clock=self._clock(),
        )
        names = _unique([item.id for item in self.vehicles])
        return UnmeasuredFleet(rules, names, Stops(locations_of(labels.stops), sources))

    def options(self) -> PlanOptions:
        """Return the options for the planner."""
        return PlanOptions(
            angles=np.empty(0),
            size=self.size,
            time_limit=self.time_limit,
            reference_point=np.array(self.reference_point) if self.reference_point else None,
            seed=self.seed,
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
    given = request.model_fields_set
    for name, limit in (("size", limits.size), ("time_limit", limits.seconds)):
        if name in given:
            check_limit(name, limit, getattr(request, name))
    n, id_bytes = len(request.stops), request.id_bytes
    if "size" in given:
        check_size(request.size, n, id_bytes, limits)
    default = defaults(limits, n, id_bytes)
    lowered = {name: default[name] for name in ("size", "time_limit")}
    return request.model_copy(update={k: v for k, v in lowered.items() if k not in given})


def _vehicle(item: VehicleItem, index: int, ids: Mapping[str, int]) -> VehicleType:
    start, end = (
        None if reference is None else _find(reference, ids, f"vehicles/{index}/{name}")
        for name, reference in (("start", item.start), ("end", item.end))
    )
    return item.vehicle_type(start, end)


def _shipment(item: ShipmentItem, index: int, ids: Mapping[str, int]) -> Shipment:
    pickup, delivery = (
        _find(reference, ids, f"shipments/{index}/{name}")
        for name, reference in (("pickup", item.pickup), ("delivery", item.delivery))
    )
    return Shipment(pickup, delivery)


def _find(reference: int | str, ids: Mapping[str, int], part: str) -> int:
    index = find_index(reference, ids, part)
    if index >= len(ids):
        raise invalid(part, f"must be a stop, 0 to {len(ids) - 1}, got {index}")
    return index


def _unique(names: Sequence[str]) -> tuple[str, ...]:
    first: dict[str, int] = {}
    for index, name in enumerate(names):
        if (other := first.setdefault(name, index)) != index:
            demand = f"must not be that of vehicles/{other}, got {show(name)} twice"
            raise invalid(f"vehicles/{index}/id", demand)
    return tuple(names)
