"""The fields of stops, shipments, vehicles and objectives in requests of `POST /fleet`."""

from collections.abc import Mapping
from math import inf
from typing import Annotated

from pydantic import Field

from service.errors import invalid
from service.fleet.measures.table import Measure, joined_texts
from service.fleet.rules import Over
from service.fleet.vehicles import ALWAYS, Shipment, Span, VehicleType, Visit
from service.requests.day_fields import SampledObjectiveItem
from service.requests.fields import (
    IS_LIST,
    AsInteger,
    Branch,
    Cost,
    Pair,
    PositiveInteger,
    PositiveNumber,
    PositiveTime,
    StrictModel,
    Text,
    Time,
    at_most,
    empty_list,
    optional,
    shared_values,
    unless_given,
)
from service.requests.profile_fields import ProfileCostsItem
from service.requests.spread_fields import Percentile, SpreadOfTimes
from service.requests.stop_fields import NamedStop, StopReference, find_index, find_indexes
from service.requests.task import types_of

_MOST_LOAD = 10**9
_MOST_COUNT = 10**6
Load = Annotated[int, Field(ge=0, le=_MOST_LOAD), AsInteger]
_MOST_DIMENSIONS = 8
Loads = Annotated[list[Load], at_most(_MOST_DIMENSIONS)]
Skills = Annotated[list[Text], at_most(50)]
SpeedFactor = Annotated[float, Field(ge=0.01, le=100, allow_inf_nan=False)]
ServiceFactor = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
# A pair in JSON, and a list so that OpenAPI has its length.
TimeSpan = Pair[Time]
Windows = Annotated[list[TimeSpan], at_most(20)]
Due = Annotated[Time | TimeSpan, IS_LIST]


class ServiceItem(StrictModel):
    """How long the visit of a stop takes by a type of vehicles."""

    vehicle: Text = Field(description="the id of the type")
    service: Time = Field(description="how long the visit takes, in the clock's unit")


class FleetStopItem(NamedStop):
    """A stop, and its demands on the vehicle that visits it."""

    demand: Loads = empty_list(
        "whole numbers, one for each dimension of the vehicle's capacity: what it delivers, or what"
        " it takes on where the stop is the pick-up of a shipment"
    )
    pickup: Loads = empty_list(
        "whole numbers, as of `demand`: what it takes on there, after what it delivers, and brings"
        " to its end"
    )
    service: Time = Field(default=0.0, description="how long a visit takes, in the clock's unit")
    services: Annotated[list[ServiceItem], at_most(100)] = empty_list(
        "how long a visit takes by some types of vehicles, in place of `service`"
    )
    window: TimeSpan | None = optional("when a visit may begin, from and to")
    windows: Windows = empty_list(
        "when a visit may begin, from and to: in one of up to 20, by ascending time"
    )
    due: Due | None = optional(
        "when the visit should begin at the latest, after which the plan has lateness; or a pair:"
        " from when on it should, before which the plan has earliness, and until when"
    )
    release: Time = Field(
        default=0.0,
        description="a vehicle that brings something here leaves its start, or the stop where it"
        " loads again, no earlier",
    )
    skills: Skills = empty_list("the skills that its vehicle must have, all of them")
    vehicle: Text | None = optional("the id of the type of vehicles that must visit it")
    urgency: Cost = Field(
        default=1.0,
        description="what a unit of time until the visit begins counts in the measure"
        " weighted_arrival",
    )
    prize: Cost | None = optional(
        "added to the first length if the stop is left out; a stop without a prize is"
        " always visited"
    )

    def visit(self, part: str, types: Mapping[str, tuple[int, ...]]) -> Visit:
        """Return the stop, whose part of the request is `part`, as a visit of a vehicle.

        `types` are the types of vehicles by their id: one for each shift.

        Raises:
            Refusal: No vehicle has that id, or windows are not in order.
        """
        able = () if self.vehicle is None else types_of(self.vehicle, types, part)
        wanted, due = self.due if isinstance(self.due, list) else (0.0, self.due)
        own = {
            "windows": tuple(spans_of(self.window, self.windows, f"{part}/window")),
            "due": inf if due is None else due,
            "vehicles": able,
            "wanted": wanted,
            "services": self._services(part, types),
        }
        return Visit(**{**shared_values(self, Visit), **own})

    def _services(self, part: str, types: Mapping[str, tuple[int, ...]]) -> tuple[float, ...]:
        """Return how long the visit takes by each type of vehicles; nothing if all are alike."""
        own: dict[int, float] = {}
        for index, each in enumerate(self.services):
            able = types_of(each.vehicle, types, f"{part}/services/{index}")
            own |= dict.fromkeys(able, each.service)
        count = sum(map(len, types.values()))
        return tuple(own.get(kind, self.service) for kind in range(count)) if own else ()


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


class BreakItem(StrictModel):
    """A break that a driver takes who is on the way then."""

    window: TimeSpan = Field(description="when it may begin, from and to")
    length: Time = Field(description="how long it takes")


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
    capacity: Loads = empty_list("the most that one holds, in up to 8 dimensions")
    shift: TimeSpan | None = optional("when one may leave, and must be back")
    shifts: Annotated[list[TimeSpan], at_most(31)] = empty_list(
        "up to 31 shifts, by ascending time: each vehicle has a route in each"
    )
    max_overtime: Time = Field(
        default=0.0, description="how much later than its shift a route may end"
    )
    breaks: Annotated[list[BreakItem], at_most(10)] = empty_list(
        "up to 10, by ascending time. Each is taken between two visits, before the departure or"
        " after the end; not while the vehicle drives"
    )
    skills: Skills = empty_list("what it is able to do")
    max_stops: PositiveInteger | None = optional("the most stops of a route")
    min_stops: PositiveInteger | None = optional("the least stops of a route: else none leaves")
    reload: Annotated[list[StopReference], at_most(20)] = empty_list(
        "the stops, by index or id, at which one may load again on its way"
    )
    max_trips: PositiveInteger | None = optional(
        "the most trips of a route, each from one loading to the next; null for any number"
    )
    initial_load: Loads = empty_list(
        "the load on board at the start; it is unloaded at the first stop for loading again, or at"
        " the end"
    )
    longest: PositiveTime | None = optional(
        "the limit on each route: on its time if there is a clock, else on its length in"
        " the objective whose `over` is max"
    )
    shortest: Time = Field(
        default=0.0, description="the least time or length of a route, measured as `longest` is"
    )
    max_distance: PositiveNumber | None = optional(
        "the most that a route's legs cost in the objective that is not time, such as metres"
    )
    max_driving: PositiveTime | None = optional(
        "the most time that a route drives, in the clock's unit: without service and waiting"
    )
    fixed: Cost = Field(default=0.0, description="added to the first length if one is used")
    per_distance: Cost = Field(
        default=1.0,
        description="what each unit of the first objective's costs adds to the first length, such"
        " as the price of a metre",
    )
    per_time: Cost = Field(
        default=0.0,
        description="what each unit of a route's time, with service and waiting, adds to the first"
        " length, such as the price of a second",
    )
    speed_factor: SpeedFactor = Field(
        default=1.0,
        description="how much faster one drives than the clock's costs say: they are divided by it",
    )
    service_factor: ServiceFactor = Field(
        default=1.0, description="by what the service of each stop that one visits is multiplied"
    )

    profile: Text | None = optional(
        "what kind of vehicle it is: it drives by the matrix of this name in the `matrices` of an"
        " objective, and by road as the operator's routing engine knows such vehicles, as car,"
        " truck or bicycle; null where all drive alike, by road as the operator has set"
    )

    def vehicle_types(self, part: str, ids: Mapping[str, int], profile: int) -> list[VehicleType]:
        """Return the type of vehicles, whose part of the request is `part`: once for each shift.

        `profile` is the number of its profile.

        Raises:
            Refusal: A stop that it names does not exist, or shifts are not in order.
        """
        start, end = (
            None if stop is None else find_index(stop, ids, f"{part}/{name}", len(ids))
            for name, stop in (("start", self.start), ("end", self.end))
        )
        own = {
            "start": start,
            "end": end,
            "reload": find_indexes(self.reload, ids, f"{part}/reload"),
            "profile": profile,
            "breaks": tuple((*each.window, each.length) for each in self.breaks),
        }
        return [
            VehicleType(**{**shared_values(self, VehicleType), **own, "shift": shift})
            for shift in spans_of(self.shift, self.shifts, f"{part}/shift")
        ]


class TimesItem(SampledObjectiveItem, SpreadOfTimes, ProfileCostsItem):
    """A source of costs by profile, which may spread from day to day if they are times."""


class ClockItem(TimesItem):
    """The source of travel times that are not an objective, maybe over the day.

    It has exactly one of matrix, matrices, coordinates, from, slices, breakpoints and days.
    """

    name: Text = Field(default="time", description="of the times, which are not an objective")


Clock = Annotated[Text | ClockItem, Branch(lambda value: not isinstance(value, str))]


class FleetObjectiveItem(TimesItem):
    """An objective by its name: costs with their source, or another measure of plans.

    It has exactly one of matrix, matrices, coordinates, from, slices, breakpoints, days and
    measure.
    """

    of_plan: Measure | None = Field(
        default=None,
        alias="measure",
        description=f"in place of a source of costs, not for the first objective: {joined_texts()}",
    )
    over: Over = unless_given(
        "sum",
        "of costs: whether the length of a plan is the sum over its routes, as by"
        " default, or the longest route; max for one objective at most",
    )
    percentile: Percentile | None = optional(
        "of the clock's times, if they have a `spread` or `days`: the length of a plan is what so"
        " many days of a hundred do not exceed, such as 90; by default it is that of a day as"
        " planned"
    )


def spans_of(one: list[float] | None, several: list[list[float]], part: str) -> list[Span]:
    """Return the windows or shifts, whether one or several were given; always, without any.

    Raises:
        Refusal: Both were given, or they overlap or are not in order.
    """
    if one is not None and several:
        raise invalid(part, "also-given", member=f"{part.rpartition('/')[2]}s")
    last = -inf
    for index, (begin, end) in enumerate(several):
        if end < begin or begin <= last:
            raise invalid(f"{part}s/{index}", "not-after", begin=begin, end=end)
        last = end
    spans = several or ([] if one is None else [one])
    return [(begin, end) for begin, end in spans] or [ALWAYS]
